//! The simulated RISC-V board (`virt`, RV32IMAC). It counts its own instructions, exactly under
//! `-icount`.

use riscv::register::minstret;

/// There is nothing to start.
pub fn start() {}

/// Instructions that `work` executes, at most 2^32, the frame around it included.
#[inline(never)]
pub fn instructions(work: &mut dyn FnMut()) -> u64 {
    let before = minstret::read();
    work();
    let after = minstret::read();
    after.wrapping_sub(before) as u64
}
