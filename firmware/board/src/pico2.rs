//! The Raspberry Pi Pico 2: an RP2350 at 150 MHz with two Cortex-M33, of which one is used. Its
//! pins are those of a Pico. Its link is USB: a serial port of the class CDC-ACM, `/dev/ttyACM0` at
//! the host.
//!
//! ```sh
//! BOARD=src/pico2.rs cargo build --release -p grbl --features board/rp2350,board/switches \
//!     --target thumbv8m.main-none-eabihf
//! ```
//!
//! Without the feature `rp2350` the link is UART0: GP0 sends, GP1 receives. The crates of the USB
//! may panic. Then everything stops. QEMU does not have this chip: `firmware/check simulated`
//! simulates it.
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
#[cfg(not(feature = "usb"))]
mod pico2_uart;
mod rp2;
#[cfg(feature = "usb")]
mod rp2350_usb;
#[cfg(feature = "usb")]
mod usb_serial;

pub use link::{baud, is_sent, send};

#[cfg(feature = "flash")]
pub use pico2_flash::{SECTOR_BYTES, UNIT_BYTES, flash_erase, flash_read, flash_write};
pub use rp2::{CLOCKS_PER_US, LONGEST_US, clock, counts, drive, inputs, stop, switch, wait, write};

use crate::{
    nvic::{Vector, vectors},
    registers::{read, set},
};
#[cfg(not(feature = "usb"))]
use pico2_uart as link;
#[cfg(feature = "usb")]
use usb_serial as link;
#[cfg(feature = "usb")]
use {rp2350_usb::Bus as UsbBus, usb_device::class_prelude::UsbBusAllocator};

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
const PLL_POWER: usize = 0x04;
const PLL_FACTOR: usize = 0x08;
const PLL_DIVIDERS: usize = 0x0c;
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
const CRYSTAL_MHZ: u32 = 12;
/// Number of the interrupt.
#[cfg(feature = "usb")]
const USB: usize = 14;

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

/// Starts clocks, pins, timer, link and interrupts.
pub fn start() {
    start_clocks();
    rp2::start();
    link::start();
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
    start_pll(PLL, 125, 5, 2);
    set(SYS_CONTROL, 1);
    while read(SYS_SELECTED) >> 1 & 1 == 0 {}
    set(PERI_CONTROL, 1 << 11);
    set(TICKS_OF_TIMER + 4, CRYSTAL_MHZ);
    set(TICKS_OF_TIMER, 1);
}

/// Starts a PLL at 12 MHz times a factor and divided twice.
fn start_pll(pll: usize, factor: u32, first: u32, second: u32) {
    set(pll, 1);
    set(pll + PLL_FACTOR, factor);
    set(pll + PLL_POWER, 1 << 3 | 1 << 2); // on, without its dividers
    while read(pll) >> 31 == 0 {}
    set(pll + PLL_DIVIDERS, first << 16 | second << 12);
    set(pll + PLL_POWER, 1 << 2);
}

/// Starts the USB and its clock of 48 MHz.
#[cfg(feature = "usb")]
fn bus() -> Option<&'static UsbBusAllocator<UsbBus>> {
    const PLL_USB: usize = 0x4005_8000;
    const USB_CONTROL: usize = CLOCKS + 0x60;
    const RESET: u32 = 1 << 28 | 1 << 15;
    set(RESETS, read(RESETS) | RESET);
    set(RESETS, read(RESETS) & !RESET);
    while read(RESET_DONE) & RESET != RESET {}
    start_pll(PLL_USB, 100, 5, 5);
    set(USB_CONTROL, 1 << 11);
    let bus = UsbBusAllocator::new(UsbBus::new());
    let bus = cortex_m::singleton!(: UsbBusAllocator<UsbBus> = bus)?;
    Some(bus)
}

/// The chip's interrupts by their numbers.
#[unsafe(link_section = ".vector_table.interrupts")]
#[unsafe(no_mangle)]
static __INTERRUPTS: [Vector; 52] =
    vectors([(0, rp2::on_timer_interrupt), (link::INTERRUPT, link::on_interrupt)]);
