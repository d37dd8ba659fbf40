//! Counts a line of text to its commands. `firmware/check counts` runs this program.
#![no_std]
#![no_main]

mod report;

#[cfg_attr(target_arch = "arm", cortex_m_rt::entry)]
#[cfg_attr(target_arch = "riscv32", riscv_rt::entry)]
fn main() -> ! {
    report::report(kernels::commands)
}
