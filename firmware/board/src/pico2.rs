//! The Raspberry Pi Pico 2: an RP2350 at 150 MHz with two Cortex-M33, of which one is used. Its
//! pins are those of a Pico. Its link is UART0: GP0 sends, GP1 receives. A Debug Probe of Raspberry
//! Pi has this port on USB.
//!
//! ```sh
//! BOARD=src/pico2.rs cargo build --release -p grbl --features board/switches \
//!     --target thumbv8m.main-none-eabihf
//! ```
//!
//! There is no USB: `rp235x-hal` 0.4 needs another `riscv-rt` than the other boards. QEMU does not
//! have this chip, so the firmware is built, but not run.
//: MEMORY
//: {
//:   FLASH : ORIGIN = 0x10000000, LENGTH = 4M - 8K
//:   RAM   : ORIGIN = 0x20000000, LENGTH = 512K
//: }
//: SECTIONS
//: {
//:   .start_block : ALIGN(4)
//:   {
//:     KEEP(*(.start_block));
//:   } > FLASH
//: } INSERT AFTER .vector_table;
//: _stext = ADDR(.start_block) + SIZEOF(.start_block);

#[cfg(feature = "flash")]
mod pico2_flash;
mod rp2;

#[cfg(feature = "flash")]
pub use pico2_flash::{SECTOR_BYTES, UNIT_BYTES, flash_erase, flash_read, flash_write};
pub use rp2::{CLOCKS_PER_US, LONGEST_US, clock, counts, drive, inputs, stop, switch, wait, write};

use crate::{
    nvic::{self, Vector, vectors},
    registers::{read, set},
};

// Addresses of the peripherals, and offsets of their registers (RP2350 datasheet, chapters 3, 8, 9
// and 12).
const CLOCKS: usize = 0x4001_0000;
const REF_CONTROL: usize = CLOCKS + 0x30;
const REF_SELECTED: usize = CLOCKS + 0x38;
const SYS_CONTROL: usize = CLOCKS + 0x3c;
const SYS_SELECTED: usize = CLOCKS + 0x44;
const PERI_CONTROL: usize = CLOCKS + 0x48;
const RESETS: usize = 0x4002_0000;
const RESET_DONE: usize = RESETS + 0x08;
const IO_BANK: usize = 0x4002_8000;
const PADS: usize = 0x4003_8000;
const CRYSTAL: usize = 0x4004_8000;
const CRYSTAL_STATUS: usize = CRYSTAL + 0x04;
const CRYSTAL_STARTUP: usize = CRYSTAL + 0x0c;
const PLL: usize = 0x4005_0000;
const PLL_POWER: usize = PLL + 0x04;
const PLL_FACTOR: usize = PLL + 0x08;
const PLL_DIVIDERS: usize = PLL + 0x0c;
const UART: usize = 0x4007_0000;
const UART_FLAGS: usize = UART + 0x18;
const UART_WHOLE: usize = UART + 0x24;
const UART_FRACTION: usize = UART + 0x28;
const UART_LINE: usize = UART + 0x2c;
const UART_CONTROL: usize = UART + 0x30;
const UART_INTERRUPTS: usize = UART + 0x38;
const PWM: usize = 0x400a_8000;
const TIMER: usize = 0x400b_0000;
const NOW_US: usize = 0x28;
const INTR: usize = 0x3c;
const INTE: usize = 0x40;
const TICKS_OF_TIMER: usize = 0x4010_8018;
const SIO: usize = 0xd000_0000;
const GPIO_IN: usize = 0x04;
const OUT_SET: usize = 0x18;
const OUT_CLR: usize = 0x20;
const OE_SET: usize = 0x38;
/// Bits of `RESETS`: pins, pads, PLL, PWM, timer, UART.
const USED: u32 = 1 << 6 | 1 << 9 | 1 << 14 | 1 << 16 | 1 << 23 | 1 << 26;
/// The function of a pin that the UART drives.
const BY_UART: u32 = 2;
const CRYSTAL_MHZ: u32 = 12;
const CORE_HZ: u32 = 150_000_000;
/// Number of the interrupt.
const UART_0: usize = 33;

/// Tells the boot loader that this is a program for a Cortex-M33 (RP2350 datasheet, 5.9.5.1).
#[used]
#[unsafe(link_section = ".start_block")]
static IMAGE: [u32; 5] = [
    0xffff_ded3,
    0x1021_0142,
    0x0000_01ff,
    0x0000_0000,
    0xab12_3579,
];

#[cfg(feature = "wide")]
compile_error!("the link takes the pins of the jumpers: leave out the feature `wide`");

/// Starts clocks, pins, timer, UART and interrupts.
pub fn start() {
    start_clocks();
    rp2::start();
    for pin in 0..2 {
        // An input with a pull-up, which is not isolated.
        set(PADS + 4 + 4 * pin, 1 << 6 | 1 << 4 | 1 << 3);
        set(IO_BANK + 8 * pin + 4, BY_UART);
    }
    baud(9600);
    set(UART_CONTROL, 1 << 9 | 1 << 8 | 1); // both directions
    set(UART_INTERRUPTS, 1 << 4); // a byte received
    nvic::unmask(UART_0 as u16);
}

/// Runs the processor and the UART at 150 MHz from the crystal, and the timer at 1 MHz.
fn start_clocks() {
    // 1 ms for the start, in units of 256 clocks.
    set(CRYSTAL_STARTUP, CRYSTAL_MHZ * 1000 / 256);
    set(CRYSTAL, 0xfab << 12 | 0xaa0);
    while read(CRYSTAL_STATUS) >> 31 == 0 {}
    // The processor runs from the reference while the PLL starts.
    set(REF_CONTROL, 2);
    while read(REF_SELECTED) >> 2 & 1 == 0 {}
    set(SYS_CONTROL, 0);
    while read(SYS_SELECTED) & 1 == 0 {}
    set(RESETS, read(RESETS) | 1 << 14);
    set(RESETS, read(RESETS) & !USED);
    while read(RESET_DONE) & USED != USED {}
    // 12 MHz times 125, divided by 5 and by 2.
    set(PLL, 1);
    set(PLL_FACTOR, 125);
    set(PLL_POWER, 1 << 3 | 1 << 2); // on, without its dividers
    while read(PLL) >> 31 == 0 {}
    set(PLL_DIVIDERS, 5 << 16 | 2 << 12);
    set(PLL_POWER, 1 << 2);
    set(SYS_CONTROL, 1);
    while read(SYS_SELECTED) >> 1 & 1 == 0 {}
    set(PERI_CONTROL, 1 << 11);
    set(TICKS_OF_TIMER + 4, CRYSTAL_MHZ);
    set(TICKS_OF_TIMER, 1);
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

/// The chip's interrupts by their numbers.
#[unsafe(link_section = ".vector_table.interrupts")]
#[unsafe(no_mangle)]
static __INTERRUPTS: [Vector; 52] =
    vectors([(0, rp2::on_timer_interrupt), (UART_0, on_uart_interrupt)]);

extern "C" fn on_uart_interrupt() {
    while read(UART_FLAGS) >> 4 & 1 == 0 {
        crate::heard(read(UART) as u8);
    }
}
