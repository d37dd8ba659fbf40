//! A board, and what is the same on all boards.
//!
//! ```text
//! UART interrupt ─► on_byte, received ─► foreground ─push─► Steps ─► on_time ─► pins
//!                                            ▲                │
//!                                            └─ how many were made
//! ```
//!
//! Each board is one file with clocks, pins, UART, timer and, in its lines with `//:`, the memory
//! map. The target chooses one of the files here. Another board is a copy of one of them, named by
//! its path in the environment: `BOARD=my_board.rs`. It has
//!
//! | function | does |
//! | --- | --- |
//! | `start()` | pins, timer, UART, interrupts |
//! | `send(byte) -> bool` | sends a byte, if the transmitter is free |
//! | `write(levels: u8)` | the motors' pins; called by the step interrupt |
//! | `switch(outputs: u8)` | up to four other outputs: spindle, current |
//! | `inputs(simulated: u8) -> u8` | up to five switches, 1 for closed |
//! | `wait(us: u32, section)` | calls `on_time` so many microseconds after the last time, or at once where that has passed; from now on where the wait before was cut short |
//! | `LONGEST_US` | the longest wait that `wait` takes: longer ones are made of several |
//! | `stop()` | ends the wait |
//! | `baud(bits_per_s: u32)` | the UART goes on at this rate; `start` sets 9600 |
//! | `is_sent() -> bool` | the last stop bit of what was sent is out: a half-duplex line may be let go |
//! | `drive(duty: u8)` | the PWM of a DC motor, where the board has one |
//! | `counts(simulated: u16) -> u16` | the counter of its encoder |
//!
//! On ARM it also has its part of the vector table, `__INTERRUPTS`. Its interrupts have one
//! priority. They call `on_time` when a wait is over and `heard` when a byte has come. A firmware
//! has `on_time`, which calls `wait` or `stop`, and `on_byte`:
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
mod nvic;
mod panic;
mod registers;
mod shared;
mod steps;

pub use chosen::{baud, counts, drive, inputs, is_sent, send, start, stop, switch, wait, write};
pub use critical_section::{CriticalSection, with as uninterrupted};
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

// Safety: the firmware defines them so.
unsafe extern "Rust" {
    safe fn on_time(section: CriticalSection<'_>);
    safe fn on_byte(byte: u8, section: CriticalSection<'_>);
}

/// What an interrupt's handler may work within.
///
/// # Safety
/// To be called by handlers of interrupts only, which have one priority: none comes within another.
unsafe fn section() -> CriticalSection<'static> {
    // Safety: so nothing else runs until the handler has ended.
    unsafe { CriticalSection::new() }
}

/// Whether a DC motor and its encoder are at the pins. Without them `drive` and `counts` have no
/// effect, and the firmware simulates them.
pub const HAS_MOTOR: bool = cfg!(feature = "motor");

/// Bytes of the line. A host has a few of them on the way at a time.
static HEARD: Shared<Queue<u8, 32>> = Shared::new(Queue::new());

/// A byte has come: of the UART's interrupt.
fn heard(byte: u8) {
    // Safety: boards call this in the UART's interrupt.
    let section = unsafe { section() };
    on_byte(byte, section);
    // Without room it is lost, and its echo with it.
    HEARD.within(section, |heard| heard.enqueue(byte).ok());
}

/// The oldest byte that has come and was not taken yet.
pub fn received() -> Option<u8> {
    HEARD.with(|heard| heard.dequeue())
}

/// Whether a byte has come that was not taken yet.
pub fn has_heard() -> bool {
    HEARD.with(|heard| !heard.is_empty())
}

/// Sleeps until a byte has come or something else has happened.
pub fn sleep(nothing: impl Fn(CriticalSection<'_>) -> bool) {
    // Interrupts are let in after each time.
    while critical_section::with(|section| {
        let sleeps = HEARD.within(section, |heard| heard.is_empty()) && nothing(section);
        if sleeps {
            wfi();
        }
        sleeps
    }) {}
}
