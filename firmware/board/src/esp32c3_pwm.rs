//! The PWM of an ESP32-C3, which its manual calls LED PWM: channel 0 with timer 0, 1.9 kHz.
//!
//! Source: ESP32-C3 Technical Reference Manual, LED PWM controller.

use super::chip::give;
use super::table::PWM;
use crate::registers::set;

const LEDC: usize = 0x6001_9000;
const CHANNEL: usize = LEDC;
const RISE: usize = LEDC + 0x04;
const DUTY: usize = LEDC + 0x08;
const FADE: usize = LEDC + 0x0c;
const TIMER: usize = LEDC + 0xa0;
const CLOCK: usize = LEDC + 0xd0;
/// The signal of the channel in the GPIO matrix.
const SIGNAL: u32 = 45;
/// 80 MHz by 163 by 256 levels. The divider is in 256ths.
const DIVIDER: u32 = 163 << 8;
const LEVEL_BITS: u32 = 8;
/// One step of the duty that changes nothing, begun at once.
const NO_FADE: u32 = 1 << 31 | 1 << 30 | 1 << 20 | 1 << 10;

/// Sets the PWM; 255 is always high. It begins with the first call.
pub fn drive(duty: u8) {
    let full = u32::from(duty == u8::MAX);
    set(CLOCK, 1 << 31 | 1); // from the bus, 80 MHz
    set(TIMER, 1 << 25 | DIVIDER << 4 | LEVEL_BITS);
    set(RISE, 0);
    set(DUTY, (u32::from(duty) + full) << 4);
    set(CHANNEL, 1 << 2);
    set(FADE, NO_FADE);
    set(CHANNEL, 1 << 4 | 1 << 2);
    give(PWM, SIGNAL);
}
