//! Runs kernels on a board and prints their counts.

#[cfg_attr(target_arch = "arm", path = "board/cortex_m.rs")]
#[cfg_attr(target_arch = "riscv32", path = "board/riscv.rs")]
mod board;

use kernels::Count;
use semihosting::{println, process};

/// Prints a line `kernel instructions` for each kernel: the instructions per event, loop included.
pub fn report(all: fn(Count<'_>)) -> ! {
    board::start();
    // The overhead of the measurement.
    let frame = board::instructions(&mut || ());
    all(&mut |name, events, work| {
        let instructions = board::instructions(work).saturating_sub(frame);
        let events = u64::from(events);
        let hundredths = (instructions * 100 + events / 2) / events;
        println!("{name} {}.{:02}", hundredths / 100, hundredths % 100);
    });
    process::exit(0)
}

/// Ends QEMU at once, so that a fault does not hang until the runner's timeout.
#[cfg(target_arch = "arm")]
#[cortex_m_rt::exception]
unsafe fn HardFault(frame: &cortex_m_rt::ExceptionFrame) -> ! {
    println!("HardFault at {:#x}", frame.pc());
    process::exit(98)
}
