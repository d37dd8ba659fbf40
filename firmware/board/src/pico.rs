//! The Raspberry Pi Pico: an RP2040 at 125 MHz with two Cortex-M0+, of which one is used. Its link
//! is USB: a serial port of the class CDC-ACM, `/dev/ttyACM0` at the host.
//!
//! ```sh
//! BOARD=src/pico.rs cargo build --release -p micromill --features board/rp2040 \
//!     --target thumbv6m-none-eabi
//! ```
//!
//! `rp2040-hal` starts the clocks and runs the USB. It may panic. Then everything stops. QEMU does
//! not have this chip: `firmware/check simulated` simulates it.
//: MEMORY
//: {
//:   BOOT2 : ORIGIN = 0x10000000, LENGTH = 256
//:   FLASH : ORIGIN = 0x10000100, LENGTH = 2M - 8K - 256
//:   RAM   : ORIGIN = 0x20000000, LENGTH = 256K
//: }
//: SECTIONS
//: {
//:   .boot2 ORIGIN(BOOT2) : { KEEP(*(.boot2)); } > BOOT2
//: } INSERT BEFORE .text;

#[cfg(feature = "flash")]
mod pico_flash;

mod rp2;
mod usb_serial;

#[cfg(feature = "flash")]
pub use pico_flash::{SECTOR_BYTES, UNIT_BYTES, flash_erase, flash_read, flash_write};
#[cfg(feature = "wide")]
pub use rp2::jumpers;
pub use rp2::{CLOCKS_PER_US, LONGEST_US, clock, counts, drive, inputs, stop, switch, wait, write};
pub use usb_serial::{baud, is_sent, send};

use crate::nvic::{Vector, vectors};
use rp2040_hal::clocks::{ClocksManager, init_clocks_and_plls};
use rp2040_hal::usb::UsbBus;
use rp2040_hal::{Watchdog, pac};
use usb_device::class_prelude::UsbBusAllocator;

const CRYSTAL_HZ: u32 = 12_000_000;
// Addresses of the peripherals, and offsets of their registers (RP2040 datasheet, chapter 2).
const IO_BANK: usize = 0x4001_4000;
const PADS: usize = 0x4001_c000;
const PWM: usize = 0x4005_0000;
const TIMER: usize = 0x4005_4000;
const NOW_US: usize = 0x28;
const INTR: usize = 0x34;
const INTE: usize = 0x38;
const SIO: usize = 0xd000_0000;
const GPIO_IN: usize = 0x04;
const OUT_SET: usize = 0x14;
const OUT_CLR: usize = 0x18;
const OE_SET: usize = 0x24;
/// Number of the interrupt.
const USB: usize = 5;

/// The second stage of the boot loader, which the chip runs before the program.
#[used]
#[unsafe(link_section = ".boot2")]
static BOOT2: [u8; 256] = rp2040_boot2::BOOT_LOADER_W25Q080;

/// Starts pins, timer, USB and interrupts.
pub fn start() {
    usb_serial::start();
    rp2::start();
}

/// Starts clocks and peripherals. `None`: the clocks do not start, so there is no link.
fn bus() -> Option<&'static UsbBusAllocator<UsbBus>> {
    // Safety: `start` is called once, and nothing else owns the peripherals.
    let mut chip = unsafe { pac::Peripherals::steal() };
    let mut watchdog = Watchdog::new(chip.WATCHDOG);
    let ClocksManager { usb_clock, .. } = init_clocks_and_plls(
        CRYSTAL_HZ,
        chip.XOSC,
        chip.CLOCKS,
        chip.PLL_SYS,
        chip.PLL_USB,
        &mut chip.RESETS,
        &mut watchdog,
    )
    .ok()?;
    // The timer's microseconds.
    watchdog.enable_tick_generation((CRYSTAL_HZ / 1_000_000) as u8);
    chip.RESETS.reset().modify(|_, resets| {
        resets.io_bank0().clear_bit();
        resets.pads_bank0().clear_bit();
        resets.pwm().clear_bit();
        resets.timer().clear_bit()
    });
    while !chip.RESETS.reset_done().read().timer().bit() {}
    let bus = UsbBus::new(
        chip.USBCTRL_REGS,
        chip.USBCTRL_DPRAM,
        usb_clock,
        true,
        &mut chip.RESETS,
    );
    let allocator = cortex_m::singleton!(: UsbBusAllocator<UsbBus> = UsbBusAllocator::new(bus))?;
    Some(allocator)
}

/// The chip's interrupts by their numbers.
#[unsafe(link_section = ".vector_table.interrupts")]
#[unsafe(no_mangle)]
static __INTERRUPTS: [Vector; 32] = vectors([
    (0, rp2::on_timer_interrupt),
    (USB, usb_serial::on_interrupt),
]);
