//! A Blue Pill: an STM32F103C8 at 72 MHz, a Cortex-M3 with 64 kB of flash and 20 kB of RAM. Its
//! link is USB, a serial port of the class CDC-ACM, `/dev/ttyACM0` at the host.
//!
//! ```sh
//! BOARD=src/blue_pill.rs cargo build --release -p micromill --target thumbv7m-none-eabi \
//!     --features board/usbd,board/switches
//! probe-rs download --chip STM32F103C8 target/thumbv7m-none-eabi/release/micromill
//! ```
//!
//! Without the feature `usbd` the link is USART2: PA2 sends, PA3 receives. `stm32-usbd` may panic.
//! Then everything stops.
//: MEMORY
//: {
//:   FLASH : ORIGIN = 0x08000000, LENGTH = 62K
//:   RAM   : ORIGIN = 0x20000000, LENGTH = 20K
//: }

mod lines;
mod pill;
mod stm32f1;
#[cfg(feature = "flash")]
mod stm32f1_flash;
mod systick;
mod tim3;
#[cfg(not(feature = "usb"))]
mod usart2;
#[cfg(feature = "usb")]
mod usb_serial;

pub use lines::{counts, inputs, start, switch, write};
pub use link::{baud, is_sent, send};
#[cfg(feature = "flash")]
pub use stm32f1_flash::{SECTOR_BYTES, UNIT_BYTES, flash_erase, flash_read, flash_write};
pub use systick::{CLOCKS_PER_US, LONGEST_US, clock, stop, wait};
pub use tim3::drive;

use crate::nvic::{Vector, vectors};
use pill as table;
use stm32f1 as chip;
use systick as timer;
#[cfg(not(feature = "usb"))]
use usart2 as link;
#[cfg(feature = "usb")]
use usb_serial as link;
#[cfg(feature = "usb")]
use {stm32_usbd::UsbPeripheral, usb_device::class_prelude::UsbBusAllocator};

/// The clock of the processor.
const CORE_MHZ: u32 = 72;

#[cfg(feature = "usb")]
type UsbBus = stm32_usbd::UsbBus<Usbd>;

/// The USB of the chip.
#[cfg(feature = "usb")]
pub struct Usbd;

// Safety: these are the addresses and the size of the USB of an STM32F103 (RM0008, chapter 23).
#[cfg(feature = "usb")]
unsafe impl UsbPeripheral for Usbd {
    const REGISTERS: *const () = 0x4000_5c00 as *const ();
    const DP_PULL_UP_FEATURE: bool = false;
    const EP_MEMORY: *const () = 0x4000_6000 as *const ();
    const EP_MEMORY_SIZE: usize = 512;
    const EP_MEMORY_ACCESS: stm32_usbd::MemoryAccess = stm32_usbd::MemoryAccess::Word16x1;

    fn enable() {
        stm32f1::start_usb();
    }

    fn startup_delay() {
        // More than 1 us.
        cortex_m::asm::delay(CORE_MHZ);
    }
}

/// Number of the interrupt of received packets.
#[cfg(feature = "usb")]
const USB: usize = 20;

/// Starts the USB.
#[cfg(feature = "usb")]
fn bus() -> Option<&'static UsbBusAllocator<UsbBus>> {
    let bus = cortex_m::singleton!(: UsbBusAllocator<UsbBus> = UsbBus::new(Usbd))?;
    Some(bus)
}

/// The chip's interrupts by their numbers.
#[unsafe(link_section = ".vector_table.interrupts")]
#[unsafe(no_mangle)]
static __INTERRUPTS: [Vector; 60] = vectors([(link::INTERRUPT, link::on_interrupt)]);
