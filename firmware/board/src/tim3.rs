//! The PWM of the spindle, 1.9 kHz, at channel 2 of TIM3, which is the same on all STM32.
//!
//! The file of the board has `chip`: the clock of the timer, and how its pin is given to it.

use super::chip::{TIM3_HZ, give_to_tim3};
use super::table::PWM;
use crate::registers::{read, set};

const TIM3: usize = 0x4000_0400;
const CONTROL: usize = TIM3;
const EVENT: usize = TIM3 + 0x14;
const MODE: usize = TIM3 + 0x18;
const ENABLE: usize = TIM3 + 0x20;
const PRESCALER: usize = TIM3 + 0x28;
const TOP: usize = TIM3 + 0x2c;
const DUTY: usize = TIM3 + 0x38;
const PWM_HZ: u32 = 1900;

/// Sets the duty, 0 to 255. The PWM begins with the first call.
pub fn drive(duty: u8) {
    set(DUTY, duty.into());
    if read(CONTROL) & 1 != 0 {
        return;
    }
    set(PRESCALER, TIM3_HZ / 255 / PWM_HZ);
    set(TOP, 254);
    // High below the duty. A new duty is taken at the next pulse.
    set(MODE, 0b110 << 12 | 1 << 11);
    set(ENABLE, 1 << 4);
    set(EVENT, 1);
    set(CONTROL, 1);
    give_to_tim3(PWM);
}
