//! UART0 of a Raspberry Pi Pico 2: GP0 sends, GP1 receives. A Debug Probe of Raspberry Pi has this
//! port on USB.

use super::{IO_BANK, PADS};
use crate::{
    nvic,
    registers::{read, set},
};

const UART: usize = 0x4007_0000;
const UART_FLAGS: usize = UART + 0x18;
const UART_WHOLE: usize = UART + 0x24;
const UART_FRACTION: usize = UART + 0x28;
const UART_LINE: usize = UART + 0x2c;
const UART_CONTROL: usize = UART + 0x30;
const UART_INTERRUPTS: usize = UART + 0x38;
/// The clock of the processor and of the UART.
const CORE_HZ: u32 = 150_000_000;
/// The function of a pin that the UART drives.
const BY_UART: u32 = 2;
/// Number of the interrupt.
pub const INTERRUPT: usize = 33;

/// Starts the UART, whose clock runs.
pub fn start() {
    for pin in 0..2 {
        // An input with a pull-up, which is not isolated.
        set(PADS + 4 + 4 * pin, 1 << 6 | 1 << 4 | 1 << 3);
        set(IO_BANK + 8 * pin + 4, BY_UART);
    }
    baud(9600);
    set(UART_CONTROL, 1 << 9 | 1 << 8 | 1); // both directions
    set(UART_INTERRUPTS, 1 << 4); // a byte received
    nvic::unmask(INTERRUPT as u16);
}

/// Sends a byte, if the transmitter is free.
pub fn send(byte: u8) -> bool {
    let is_free = read(UART_FLAGS) >> 5 & 1 == 0;
    if is_free {
        set(UART, byte.into());
    }
    is_free
}

/// Sets the rate of the UART.
pub fn baud(bits_per_s: u32) {
    // In 64ths: 4 clocks per bit, because the UART takes 16 samples.
    let divisor = CORE_HZ.wrapping_mul(4) / bits_per_s.max(1);
    set(UART_WHOLE, divisor >> 6);
    set(UART_FRACTION, divisor & 0x3f);
    set(UART_LINE, 0b11 << 5); // 8 bits; this takes the rate into use
}

/// Whether the last stop bit has been sent.
pub fn is_sent() -> bool {
    read(UART_FLAGS) >> 3 & 1 == 0
}

/// Takes the received bytes.
pub extern "C" fn on_interrupt() {
    while read(UART_FLAGS) >> 4 & 1 == 0 {
        crate::heard(read(UART) as u8);
    }
}
