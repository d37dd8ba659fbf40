//! Measures the kernels of `counts` on a board, and prints a table to its link.
//!
//! The program waits for a byte, so that no line is lost before a host listens. For each byte it
//! measures every kernel once:
//!
//! ```text
//! husillo cycles 1
//! counter DWT
//! mhz 84.00
//! line_2_axes 22.06
//! ...
//! end
//! ```
//!
//! A figure is cycles per event, with the loop around the event. `over`: the kernel took longer
//! than the counter can count.
#![no_std]
#![no_main]

#[cfg_attr(target_arch = "arm", path = "counter/cortex_m.rs")]
#[cfg_attr(target_arch = "riscv32", path = "counter/riscv.rs")]
mod counter;

use core::fmt::{self, Write};

use board::CriticalSection;
use counter::Counter;
use kernels::Count;

/// The rate of a UART. USB has none.
const BITS_PER_S: u32 = 115_200;
/// The time over which the clock of the processor is measured.
const CLOCK_US: u32 = 10_000;
/// A clock that has not advanced that far after this many readings stands.
const READINGS: u32 = 10_000_000;
/// No group of kernels is selected.
const IS_WHOLE: bool = cfg!(not(any(
    feature = "methods",
    feature = "text",
    feature = "events",
    feature = "line"
)));

/// No wait is ever set.
#[unsafe(no_mangle)]
fn on_time(_: CriticalSection<'_>) {}

/// The foreground takes every byte.
#[unsafe(no_mangle)]
fn on_byte(_: u8, _: CriticalSection<'_>) {}

/// The link, as a text.
struct Link;

impl Write for Link {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        for byte in text.bytes() {
            while !board::send(byte) {}
        }
        Ok(())
    }
}

#[board::entry]
fn main() -> ! {
    board::start();
    board::baud(BITS_PER_S);
    let counter = Counter::start();
    loop {
        board::sleep(|_| true);
        while board::received().is_some() {}
        // The link takes every text.
        table(counter).unwrap_or_default();
    }
}

/// Prints a whole table.
fn table(counter: Counter) -> fmt::Result {
    let mut link = Link;
    write!(link, "husillo cycles 1\r\ncounter {}\r\n", counter.name())?;
    let hundredths = cycles_per_us(counter).unwrap_or(0);
    write!(link, "mhz {}.{:02}\r\n", hundredths / 100, hundredths % 100)?;
    if cfg!(feature = "methods") || IS_WHOLE {
        print(counter, kernels::methods)?;
    }
    if cfg!(feature = "text") || IS_WHOLE {
        print(counter, kernels::commands)?;
    }
    if cfg!(feature = "events") || IS_WHOLE {
        print(counter, kernels::events)?;
    }
    if cfg!(feature = "line") || IS_WHOLE {
        print(counter, kernels::line)?;
    }
    write!(link, "end\r\n")
}

/// Measures kernels, and prints a line `kernel cycles` for each one.
fn print(counter: Counter, all: fn(Count<'_>)) -> fmt::Result {
    // The cycles of the measurement itself.
    let frame = measured(counter, &mut || ()).unwrap_or(0);
    let mut status = Ok(());
    all(&mut |name, events, work| {
        let line = match measured(counter, work) {
            Some(cycles) => {
                let (cycles, events) = (u64::from(cycles.saturating_sub(frame)), u64::from(events));
                let hundredths = (cycles * 100 + events / 2) / events.max(1);
                write!(
                    Link,
                    "{name} {}.{:02}\r\n",
                    hundredths / 100,
                    hundredths % 100
                )
            }
            None => write!(Link, "{name} over\r\n"),
        };
        status = status.and(line);
    });
    status
}

/// The cycles of `work`, without interrupts. `None`: the counter has wrapped.
#[inline(never)]
fn measured(counter: Counter, work: &mut dyn FnMut()) -> Option<u32> {
    board::uninterrupted(|_| {
        let before = counter.begin();
        work();
        counter.since(before)
    })
}

/// The clock of the processor by the board's counter of time, in hundredths of MHz. `None`: one of
/// them stands.
fn cycles_per_us(counter: Counter) -> Option<u32> {
    let clocks = CLOCK_US * board::CLOCKS_PER_US;
    let cycles = board::uninterrupted(|_| {
        let (begin, before) = (board::clock(), counter.begin());
        (0..READINGS)
            .any(|_| board::clock().wrapping_sub(begin) >= clocks)
            .then(|| counter.since(before))
    })??;
    Some(cycles / (CLOCK_US / 100))
}
