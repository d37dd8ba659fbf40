//! A Black Pill: an STM32F411CE at 84 MHz, a Cortex-M4F, with a crystal of 25 MHz. Its link is USB,
//! a serial port of the class CDC-ACM, `/dev/ttyACM0` at the host.
//!
//! ```sh
//! BOARD=src/black_pill.rs cargo build --release -p grbl --target thumbv7em-none-eabihf \
//!     --features board/otg,board/switches
//! probe-rs download --chip STM32F411CEUx target/thumbv7em-none-eabihf/release/grbl
//! ```
//!
//! Without the feature `otg` the link is USART2: PA2 sends, PA3 receives. `synopsys-usb-otg` may
//! panic. Then everything stops.
//: MEMORY
//: {
//:   FLASH : ORIGIN = 0x08000000, LENGTH = 512K
//:   RAM   : ORIGIN = 0x20000000, LENGTH = 128K
//: }
//: _stext = ORIGIN(FLASH) + 48K;

mod lines;
mod pill;
mod stm32f4;
#[cfg(feature = "flash")]
mod stm32f4_flash;
mod systick;
mod tim3;
#[cfg(not(feature = "usb"))]
mod usart2;
#[cfg(feature = "usb")]
mod usb_serial;

pub use lines::{counts, inputs, start, switch, write};
pub use link::{baud, is_sent, send};
#[cfg(feature = "flash")]
pub use stm32f4_flash::{SECTOR_BYTES, UNIT_BYTES, flash_erase, flash_read, flash_write};
pub use systick::{CLOCKS_PER_US, LONGEST_US, clock, stop, wait};
pub use tim3::drive;

use crate::nvic::{Vector, vectors};
use pill as table;
use stm32f4 as chip;
use systick as timer;
#[cfg(not(feature = "usb"))]
use usart2 as link;
#[cfg(feature = "usb")]
use usb_serial as link;
#[cfg(feature = "usb")]
use {synopsys_usb_otg::UsbPeripheral, usb_device::class_prelude::UsbBusAllocator};

/// The clock of the processor.
const CORE_MHZ: u32 = 84;
/// The crystal.
const EXTERNAL_MHZ: u32 = 25;
const HAS_CRYSTAL: bool = true;

#[cfg(feature = "usb")]
type UsbBus = synopsys_usb_otg::UsbBus<Otg>;

/// The USB of the chip.
#[cfg(feature = "usb")]
pub struct Otg;

// Safety: these are the address and the sizes of the OTG FS of an STM32F411 (RM0383, 22.4 and
// 22.16), and the pins are given to it by `start`.
#[cfg(feature = "usb")]
unsafe impl UsbPeripheral for Otg {
    const REGISTERS: *const () = 0x5000_0000 as *const ();
    const HIGH_SPEED: bool = false;
    const FIFO_DEPTH_WORDS: usize = 320;
    const ENDPOINT_COUNT: usize = 4;

    fn enable() {
        stm32f4::start_otg();
    }

    fn ahb_frequency_hz(&self) -> u32 {
        CORE_MHZ * 1_000_000
    }
}

/// Number of the interrupt of the USB OTG FS.
#[cfg(feature = "usb")]
const USB: usize = 67;

/// Starts the USB.
#[cfg(feature = "usb")]
fn bus() -> Option<&'static UsbBusAllocator<UsbBus>> {
    let memory = cortex_m::singleton!(: [u32; 256] = [0; 256])?;
    let bus = cortex_m::singleton!(: UsbBusAllocator<UsbBus> = UsbBus::new(Otg, memory))?;
    Some(bus)
}

/// The chip's interrupts by their numbers.
#[unsafe(link_section = ".vector_table.interrupts")]
#[unsafe(no_mangle)]
static __INTERRUPTS: [Vector; 86] = vectors([(link::INTERRUPT, link::on_interrupt)]);
