//! A board with an ESP32-C3 and 4 MB of flash, such as the SuperMini: a RISC-V processor, RV32IMC,
//! at 160 MHz. Its link is the serial port of its USB, `/dev/ttyACM0` at the host.
//!
//! | signal | GPIO | signal | GPIO |
//! | --- | --- | --- | --- |
//! | X step | 0 | X limit | 7 |
//! | Y step | 1 | Y limit | 10 |
//! | Z step | 3 | Z limit | 20 |
//! | X direction | 4 | probe | 6 |
//! | Y direction | 21 | hold (button BOOT) | 9 |
//! | Z direction | 8 | PWM of the spindle | 5 |
//! | motors off | 2 | | |
//!
//! While the chip starts, GPIO21 sends text, and GPIO2, 8 and 9 must be high or open, so these pins
//! are outputs that move nothing, and the button of the board. The USB has GPIO18 and 19, the flash
//! GPIO11 to 17.
//!
//! ```sh
//! ../image grbl esp32c3
//! esptool --chip esp32c3 write-flash 0 grbl.bin
//! ```
//!
//! The boot ROM copies the whole program from the flash into RAM, as it does with the boot loader
//! of ESP-IDF, which is not used. So no cache delays a step. Debian's QEMU does not have this chip:
//! `firmware/check simulated` simulates it.
//!
//! The boot ROM loads `CODE` and `CONSTANTS`. It needs the RAM behind them only until then. From
//! 0x3fcde710 on are the data of its functions.
//: MEMORY
//: {
//:   CONSTANTS : ORIGIN = 0x3fc80000, LENGTH = 16K
//:   CODE      : ORIGIN = 0x40384000, LENGTH = 0x403cae00 - 0x40384000
//:   RAM       : ORIGIN = 0x3fccae00, LENGTH = 0x3fcde700 - 0x3fccae00
//: }
//: REGION_ALIAS("REGION_TEXT", CODE);
//: REGION_ALIAS("REGION_RODATA", CONSTANTS);
//: REGION_ALIAS("REGION_DATA", RAM);
//: REGION_ALIAS("REGION_BSS", RAM);
//: REGION_ALIAS("REGION_HEAP", RAM);
//: REGION_ALIAS("REGION_STACK", RAM);
//: esp_rom_spiflash_erase_sector = 0x40000128;
//: esp_rom_spiflash_write = 0x4000012c;
//: esp_rom_spiflash_read = 0x40000130;
//: esp_rom_spiflash_config_param = 0x40000134;
//: esp_rom_spiflash_unlock = 0x40000140;
//: ets_update_cpu_frequency = 0x40000588;

mod esp32c3_chip;
#[cfg(feature = "flash")]
mod esp32c3_flash;
mod esp32c3_interrupts;
mod esp32c3_pwm;
mod esp32c3_timer;
mod lines;
mod usb_jtag;

#[cfg(feature = "flash")]
pub use esp32c3_flash::{SECTOR_BYTES, UNIT_BYTES, flash_erase, flash_read, flash_write};
pub use esp32c3_pwm::drive;
pub use esp32c3_timer::{CLOCKS_PER_US, LONGEST_US, clock, stop, wait};
pub use lines::{counts, inputs, switch, write};
pub use usb_jtag::{baud, is_sent, send};

use esp32c3_chip as chip;
use esp32c3_timer as timer;
use usb_jtag as link;

/// Starts the chip, the pins, the link and interrupts.
pub fn start() {
    lines::start();
    esp32c3_interrupts::start();
}

/// The pins of the lines.
mod table {
    use super::lines::Pin;

    /// Motors, from bit 0: steps, directions. There is no pin for mist coolant.
    pub const MOTORS: [Pin; 6] = [
        Pin(0, 0),
        Pin(0, 1),
        Pin(0, 3),
        Pin(0, 4),
        Pin(0, 21),
        Pin(0, 8),
    ];
    /// Other outputs: motors off. The spindle has its PWM only, and there is no flood coolant.
    pub const OUTPUTS: [Pin; 1] = [Pin(0, 2)];
    /// Switches to ground: limits of X, Y, Z, probe, hold.
    pub const INPUTS: [Pin; 5] = [Pin(0, 7), Pin(0, 10), Pin(0, 20), Pin(0, 6), Pin(0, 9)];
    /// The PWM of the spindle.
    pub const PWM: Pin = Pin(0, 5);
}
