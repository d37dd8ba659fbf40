//! The line to the drivers of the motors, UART5 of an STM32F446 at PC12. It only sends.
//!
//! The file of the board has `chip`, the registers of its chip.

use super::chip::{USART_HZ, start_uart5};
use crate::registers::{read, set};

const STATUS: usize = 0x4000_5000;
const DATA: usize = 0x4000_5004;
const BAUD: usize = 0x4000_5008;
const CONTROL: usize = 0x4000_500c;
const IS_FREE: u32 = 1 << 7;
/// On, it sends.
const ON: u32 = 1 << 13 | 1 << 3;
const BITS_PER_S: u32 = 115_200;

/// Sends a byte, if the transmitter is free. The line begins with the first call.
pub fn send_to_drivers(byte: u8) -> bool {
    if read(CONTROL) == 0 {
        start_uart5();
        // Its clock is that of USART2.
        set(BAUD, USART_HZ / BITS_PER_S);
        set(CONTROL, ON);
    }
    let is_free = read(STATUS) & IS_FREE != 0;
    if is_free {
        set(DATA, byte.into());
    }
    is_free
}
