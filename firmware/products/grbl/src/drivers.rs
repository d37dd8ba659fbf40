//! Settings of TMC2209 drivers, which share one UART. The pins MS1 and MS2 of a chip are its
//! address: 0 for X, 1 for Y, 2 for Z.
//!
//! The chips are only written to. With the supply of the motors they lose what was written.
//!
//! Source: data sheet of the TMC2209, chapters 4, 5 and 11.

use husillo_controllers::{GrblDriver, GrblMemory};
use tmc2209::reg::{CHOPCONF, GCONF, IHOLD_IRUN, SGTHRS, TCOOLTHRS, TPOWERDOWN, WritableRegister};
use tmc2209::{WriteRequest, rms_current_to_vsense_cs};

/// The sense resistors of the usual modules, in ohms.
const SENSE_OHMS: f32 = 0.11;
/// StallGuard is active at speeds above that of this `TCOOLTHRS`, which is every speed.
const EVERY_SPEED: u32 = 0xf_ffff;
/// The registers at power-on, apart from what is set here.
const CHOPPER: u32 = 0x1000_0053;

/// Sends the settings of all axes. It takes some 15 ms.
pub fn write(memory: &GrblMemory) {
    for axis in 0..3 {
        if let Some(driver) = memory.driver(axis) {
            write_driver(axis, &driver);
        }
    }
}

fn write_driver(address: u8, driver: &GrblDriver) {
    let current = f32::from(driver.milliamperes);
    let (is_sensitive, scale) = rms_current_to_vsense_cs(SENSE_OHMS, current);
    let mut general = GCONF(0);
    general.set_en_spread_cycle(!driver.is_silent);
    general.set_pdn_disable(true); // the pin is the UART's
    general.set_mstep_reg_select(true); // MS1 and MS2 are the address
    general.set_multistep_filt(true);
    send(address, general);
    let mut currents = IHOLD_IRUN(0);
    currents.set_irun(scale);
    currents.set_ihold(scale / 2);
    currents.set_ihold_delay(8);
    send(address, currents);
    send(address, TPOWERDOWN(20));
    let mut chopper = CHOPCONF(CHOPPER);
    chopper.set_vsense(is_sensitive);
    // 8 for full steps to 0 for 256 microsteps.
    let resolution = 8_u32.saturating_sub(driver.microsteps.trailing_zeros());
    chopper.0 = chopper.0 & !(0xf << 24) | resolution << 24;
    send(address, chopper);
    // Without StallGuard the pin DIAG shows faults of the driver only.
    let (threshold, speeds) = match driver.stall_threshold {
        Some(threshold) => (threshold, EVERY_SPEED),
        None => (0, 0),
    };
    send(address, TCOOLTHRS(speeds));
    send(address, SGTHRS(threshold.into()));
}

fn send(address: u8, register: impl WritableRegister) {
    for byte in WriteRequest::new(address, register).bytes() {
        while !board::send_to_drivers(*byte) {}
    }
}
