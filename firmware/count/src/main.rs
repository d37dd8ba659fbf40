//! Prints what one turn of each kernel costs in executed instructions, loop included: `kernel instructions`.
//!
//! Each kernel runs N and 2N times and the difference is divided by N, so that setting up costs nothing. Run by `check`.
#![no_std]
#![no_main]

mod board;
mod kernels;

use semihosting::{print, println, process};

#[cortex_m_rt::entry]
fn main() -> ! {
    board::start();
    kernels::all(&mut report);
    process::exit(0)
}

/// Runs `work` and prints its cost for one turn to the hundredth.
fn report(name: &str, turns: u32, work: &mut dyn FnMut(u32)) {
    let once = board::instructions(turns, work);
    let twice = board::instructions(2 * turns, work);
    let hundredths = ((twice - once) * 100 + u64::from(turns / 2)) / u64::from(turns);
    print!("{name} ");
    println!("{}.{:02}", hundredths / 100, hundredths % 100);
}

/// A fault ends QEMU at once instead of hanging until the runner's timeout.
#[cortex_m_rt::exception]
unsafe fn HardFault(frame: &cortex_m_rt::ExceptionFrame) -> ! {
    println!("HardFault at {:#x}", frame.pc());
    process::exit(98)
}
