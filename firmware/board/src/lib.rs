//! A board, and the code that all boards share.
//!
//! ```text
//! UART interrupt ─► on_byte, received ─► foreground ─push─► Steps ─► on_time ─► pins
//!                                            ▲                │
//!                                            └─ how many were made
//! ```
//!
//! Each board is one file with clocks, pins, UART and timer. Its lines with `//:` are the memory
//! map. The target selects one of the files in this folder. For another board, copy one of them,
//! and set the environment variable `BOARD` to its path: `BOARD=my_board.rs`. Each file has these
//! functions:
//!
//! | function | does |
//! | --- | --- |
//! | `start()` | starts pins, timer, UART and interrupts |
//! | `send(byte) -> bool` | sends a byte, if the transmitter is free |
//! | `write(levels: Pins)` | sets the motors' pins; called by the step interrupt |
//! | `switch(outputs: u8)` | sets up to four other outputs: spindle, current |
//! | `inputs(simulated: u8) -> u8` | reads up to five switches, 1 for closed; without switches it returns `simulated` |
//! | `wait(us: u32, section)` | calls `on_time` this many microseconds after the end of the previous wait, or at once if that time has passed; if the previous wait was cut short, the time counts from now |
//! | `jumpers() -> u8` | with the feature `wide`: reads three jumpers, 1 for a closed one |
//! | `LONGEST_US` | the longest wait that `wait` accepts; a longer one is split into several |
//! | `stop()` | cancels the wait |
//! | `baud(bits_per_s: u32)` | sets the rate of the UART; `start` sets 9600 |
//! | `is_sent() -> bool` | whether the last stop bit has been sent, so that a half-duplex line may be released |
//! | `drive(duty: u8)` | sets the PWM of a DC motor, if the board has one |
//! | `counts(simulated: u16) -> u16` | reads the counter of its encoder; without one it returns `simulated` |
//! | `send_to_drivers(byte) -> bool` | with the feature `drivers`: sends a byte to the drivers of the motors at 115200 baud, if their UART is free |
//! | `flash_read(at) -> u8`, `flash_erase(at)`, `flash_write(at, unit)` | two sectors of `SECTOR_BYTES`, written in units of `UNIT_BYTES`, for the feature `flash` |
//!
//! On ARM, the file also has its part of the vector table, `__INTERRUPTS`. All interrupts have the
//! same priority. They call `on_time` when a wait is over, and `heard` when a byte has been
//! received. A firmware defines `on_time`, which calls `wait` or `stop`, and `on_byte`:
//!
//! ```ignore
//! #[unsafe(no_mangle)]
//! fn on_time(section: CriticalSection<'_>) { /* a wait is over */ }
//!
//! #[unsafe(no_mangle)]
//! fn on_byte(byte: u8, section: CriticalSection<'_>) { /* what cannot wait for the foreground */ }
//! ```
#![no_std]

include!(concat!(env!("OUT_DIR"), "/chosen.rs"));
#[cfg(target_arch = "arm")]
pub mod core_counters;
#[cfg(feature = "flash")]
mod flash;
#[cfg(target_arch = "arm")]
pub mod nvic;
mod panic;
pub mod registers;
mod shared;
mod steps;

#[cfg(feature = "wide")]
pub use chosen::jumpers;
#[cfg(feature = "drivers")]
pub use chosen::send_to_drivers;
pub use chosen::{
    CLOCKS_PER_US, baud, clock, counts, drive, inputs, is_sent, send, start, stop, switch, wait,
    write,
};
pub use critical_section::{CriticalSection, with as uninterrupted};
#[cfg(feature = "flash")]
pub use flash::Flash;
pub use shared::Shared;
pub use steps::{Step, Steps};

#[cfg(target_arch = "arm")]
pub use cortex_m_rt::entry;
#[cfg(target_arch = "riscv32")]
pub use riscv_rt::entry;

#[cfg(target_arch = "arm")]
use cortex_m::asm::wfi;
#[cfg(target_arch = "riscv32")]
use riscv::asm::wfi;

use heapless::spsc::Queue;

/// Levels of the motors' pins, bit 0 for the first one: 8 pins, or 18 with the feature `wide`.
#[cfg(not(feature = "wide"))]
pub type Pins = u8;
/// Levels of the motors' pins, bit 0 for the first one: 8 pins, or 18 with the feature `wide`.
#[cfg(feature = "wide")]
pub type Pins = u32;

// Safety: every firmware defines both functions with these signatures.
unsafe extern "Rust" {
    safe fn on_time(section: CriticalSection<'_>);
    safe fn on_byte(byte: u8, section: CriticalSection<'_>);
}

/// The critical section of an interrupt handler.
///
/// # Safety
/// Only interrupt handlers may call this. They have the same priority, so none interrupts another.
unsafe fn section() -> CriticalSection<'static> {
    // Safety: the caller is an interrupt handler, so nothing else runs until it ends.
    unsafe { CriticalSection::new() }
}

/// Whether a DC motor and its encoder are at the pins. Without them `drive` and `counts` have no
/// effect, and the firmware simulates them.
pub const HAS_MOTOR: bool = cfg!(feature = "motor");

/// Whether switches are at the pins. Without them `inputs` returns what the firmware simulates.
pub const HAS_SWITCHES: bool = cfg!(feature = "switches");

/// Room for received bytes. Most hosts send only a few of them before they wait for an answer.
const HEARD_BYTES: usize = if cfg!(feature = "buffered") { 256 } else { 32 };

/// Received bytes.
static HEARD: Shared<Queue<u8, HEARD_BYTES>> = Shared::new(Queue::new());

/// Takes a received byte. The UART's interrupt calls this.
fn heard(byte: u8) {
    // Safety: boards call this in the UART's interrupt.
    let section = unsafe { section() };
    on_byte(byte, section);
    // If the queue is full, the byte is lost and not echoed.
    HEARD.within(section, |heard| heard.enqueue(byte).ok());
}

/// Takes the oldest received byte from the queue.
pub fn received() -> Option<u8> {
    HEARD.with(|heard| heard.dequeue())
}

/// Whether the queue holds a received byte.
pub fn has_heard() -> bool {
    HEARD.with(|heard| !heard.is_empty())
}

/// Sleeps until a byte has been received or `nothing` returns `false`.
pub fn sleep(nothing: impl Fn(CriticalSection<'_>) -> bool) {
    // Pending interrupts run at the end of each critical section.
    while critical_section::with(|section| {
        let sleeps = HEARD.within(section, |heard| heard.is_empty()) && nothing(section);
        if sleeps {
            wfi();
        }
        sleeps
    }) {}
}
