//! The simulated RISC-V board (`virt`, RV32IMAC): it counts its instructions itself, exactly so under `-icount`.

use riscv::register::minstret;

/// There is nothing to start.
pub fn start() {}

/// Instructions that `work` executes, the frame around it included. Up to 2^32.
#[inline(never)]
pub fn instructions(work: &mut dyn FnMut()) -> u64 {
    let before = minstret::read();
    work();
    let after = minstret::read();
    after.wrapping_sub(before) as u64
}
