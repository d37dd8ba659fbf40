//! Counts the instructions of kernels of other crates and of husillo. Run by
//! `firmware/check counts --peers`.
#![no_std]
#![no_main]

#[path = "../../../../firmware/proofs/counts/src/report.rs"]
mod report;

#[cfg_attr(target_arch = "arm", cortex_m_rt::entry)]
#[cfg_attr(target_arch = "riscv32", riscv_rt::entry)]
fn main() -> ! {
    report::report(kernels::all)
}
