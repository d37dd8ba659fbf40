//! The emulated RISC-V board (`virt`, RV32IMAC). It counts its own instructions. Under `-icount`
//! the count is exact.

use riscv::register::minstret;

/// Does nothing: the counter always runs.
pub fn start() {}

/// The instructions that `work` executes, at most 2^32, with the overhead of the measurement.
#[inline(never)]
pub fn instructions(work: &mut dyn FnMut()) -> u64 {
    let before = minstret::read();
    work();
    let after = minstret::read();
    after.wrapping_sub(before) as u64
}
