//! The link at USART2 of an STM32: PA2 sends, PA3 receives.
//!
//! The file of the board has `chip`, the registers of its chip.

use super::chip::{USART_HZ, start_usart2};
use crate::{
    nvic,
    registers::{read, set},
};

const STATUS: usize = 0x4000_4400;
const DATA: usize = 0x4000_4404;
const BAUD: usize = 0x4000_4408;
const CONTROL: usize = 0x4000_440c;
/// Bits of `STATUS`.
const IS_OVERRUN: u32 = 1 << 3;
const HAS_BYTE: u32 = 1 << 5;
const IS_SENT: u32 = 1 << 6;
const IS_FREE: u32 = 1 << 7;
/// On, both directions, with the interrupt of a received byte.
const ON: u32 = 1 << 13 | 1 << 5 | 1 << 3 | 1 << 2;
/// Number of the interrupt.
pub const INTERRUPT: usize = 38;

/// Starts the link.
pub fn start() {
    start_usart2();
    baud(9600);
    set(CONTROL, ON);
    nvic::unmask(INTERRUPT as u16);
}

/// Sends a byte, if the transmitter is free.
pub fn send(byte: u8) -> bool {
    let is_free = read(STATUS) & IS_FREE != 0;
    if is_free {
        set(DATA, byte.into());
    }
    is_free
}

/// Sets the rate of the link.
pub fn baud(bits_per_s: u32) {
    set(BAUD, USART_HZ / bits_per_s.max(1));
}

/// Whether the last stop bit has been sent.
pub fn is_sent() -> bool {
    read(STATUS) & IS_SENT != 0
}

/// The interrupt of a received byte, or of a lost one. A loss that the status has shown ends when
/// the data register is read, even if no byte waits there.
pub extern "C" fn on_interrupt() {
    loop {
        let status = read(STATUS);
        if status & (HAS_BYTE | IS_OVERRUN) == 0 {
            return;
        }
        let byte = read(DATA) as u8;
        if status & HAS_BYTE != 0 {
            crate::heard(byte);
        }
    }
}
