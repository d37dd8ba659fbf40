//! The lines of a firmware at pins of several ports, for the boards with an STM32 or an ESP32-C3.
//!
//! The file of the board has `table`, the pins of each line; `chip`, the registers of its chip;
//! `timer`; and `link`.

use super::chip::{drive_low, is_low, pull_up, set_port, start_chip};
use super::table::{INPUTS, MOTORS, OUTPUTS, PWM};
use super::{link, timer};
use crate::Pins;

/// A pin: its port, 0 for A, and its number.
#[derive(Clone, Copy)]
pub struct Pin(pub usize, pub u32);

/// It has no 18 free pins.
#[cfg(feature = "wide")]
compile_error!("this board has 8 pins for motors: leave out the feature `wide`");

/// Starts the chip, the pins and the link.
pub fn start() {
    start_chip();
    timer::start();
    let outputs = MOTORS.iter().chain(&OUTPUTS).chain([&PWM]);
    outputs.for_each(|pin| drive_low(*pin));
    INPUTS.iter().for_each(|pin| pull_up(*pin));
    link::start();
}

/// Sets pins: bit 0 of the levels is that of the first one. Those of a port change together.
#[inline(always)]
fn set_pins(pins: &[Pin], levels: u8) {
    for port in 0..3 {
        let of_port = || (0..8).zip(pins).filter(move |(_, pin)| pin.0 == port);
        let all: u32 = of_port().fold(0, |all, (_, pin)| all | 1 << pin.1);
        let high = of_port().fold(0, |high, (bit, pin)| {
            high | u32::from(levels >> bit & 1) << pin.1
        });
        if all != 0 {
            set_port(port, high, all & !high);
        }
    }
}

/// Sets the motors' pins.
#[inline]
pub fn write(levels: Pins) {
    set_pins(&MOTORS, levels);
}

/// Sets the other outputs.
pub fn switch(outputs: u8) {
    set_pins(&OUTPUTS, outputs);
}

/// This board has no counter for an encoder.
pub fn counts(simulated: u16) -> u16 {
    simulated
}

/// Reads the switches; a closed one is 1.
pub fn inputs(simulated: u8) -> u8 {
    if cfg!(not(feature = "switches")) {
        return simulated;
    }
    INPUTS
        .iter()
        .rev()
        .fold(0, |closed, pin| closed << 1 | u8::from(is_low(*pin)))
}
