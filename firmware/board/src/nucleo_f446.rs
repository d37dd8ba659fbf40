//! The Nucleo-F446RE: an STM32F446RE at 168 MHz, a Cortex-M4F. Its link is the port of
//! the ST-LINK on USB, `/dev/ttyACM0` at the host.
//!
//! ```sh
//! BOARD=src/nucleo_f446.rs cargo build --release -p grbl --features board/switches \
//!     --target thumbv7em-none-eabihf
//! probe-rs download --chip STM32F446RETx target/thumbv7em-none-eabihf/release/grbl
//! ```
//!
//! QEMU's `netduinoplus2` has the same processor, timers and UART, but no clocks, pins and flash.
//: MEMORY
//: {
//:   FLASH : ORIGIN = 0x08000000, LENGTH = 512K
//:   RAM   : ORIGIN = 0x20000000, LENGTH = 128K
//: }
//: _stext = ORIGIN(FLASH) + 48K;

mod lines;
mod nucleo;
mod stm32f4;
#[cfg(feature = "flash")]
mod stm32f4_flash;
mod systick;
mod tim3;
#[cfg(feature = "drivers")]
mod uart5;
mod usart2;

pub use lines::{counts, inputs, start, switch, write};
#[cfg(feature = "flash")]
pub use stm32f4_flash::{SECTOR_BYTES, UNIT_BYTES, flash_erase, flash_read, flash_write};
pub use systick::{CLOCKS_PER_US, LONGEST_US, clock, stop, wait};
pub use tim3::drive;
#[cfg(feature = "drivers")]
pub use uart5::send_to_drivers;
pub use usart2::{baud, is_sent, send};

use crate::nvic::{Vector, vectors};
use nucleo as table;
use stm32f4 as chip;
use systick as timer;
use usart2 as link;

/// The clock of the processor.
const CORE_MHZ: u32 = 168;
/// The ST-LINK gives its clock of 8 MHz.
const EXTERNAL_MHZ: u32 = 8;
const HAS_CRYSTAL: bool = false;

/// The chip's interrupts by their numbers.
#[unsafe(link_section = ".vector_table.interrupts")]
#[unsafe(no_mangle)]
static __INTERRUPTS: [Vector; 97] = vectors([(link::INTERRUPT, link::on_interrupt)]);
