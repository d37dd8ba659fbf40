//! The interrupts of an ESP32-C3: a matrix leads each source to one of 31 interrupts of the
//! processor, which has its own controller and always jumps into a table.
//!
//! The timer gets number 7 and the USB number 11, the standard numbers of a timer and of an
//! external source, so that `riscv-rt` finds their handlers.
//!
//! Source: ESP32-C3 Technical Reference Manual, interrupt controller and interrupt matrix.

use core::arch::global_asm;

use riscv::interrupt::Interrupt;
use riscv::register::mtvec::{self, Mtvec};

use super::{link, timer};
use crate::registers::set;

const MATRIX: usize = 0x600c_2000;
const ENABLE: usize = MATRIX + 0x104;
const TYPE: usize = MATRIX + 0x108;
const PRIORITY: usize = MATRIX + 0x114;
const THRESHOLD: usize = MATRIX + 0x194;
/// The mode of the table, the only one that this processor has.
const VECTORED: usize = 1;
/// The sources, each with its interrupt of the processor.
const USED: [(usize, Interrupt); 2] = [
    (timer::SOURCE, Interrupt::MachineTimer),
    (link::SOURCE, Interrupt::MachineExternal),
];

// The entry of an exception and of 31 interrupts, which all begin alike.
global_asm!(
    ".section .trap.vector, \"ax\"",
    ".option push",
    ".option norvc",
    ".balign 256",
    ".global trap_table",
    "trap_table:",
    ".rept 32",
    "j _start_trap",
    ".endr",
    ".option pop",
);

unsafe extern "C" {
    static trap_table: [u32; 32];
}

/// Connects the sources, and enables interrupts.
pub fn start() {
    set(TYPE, 0); // levels
    set(THRESHOLD, 1);
    for (source, interrupt) in USED {
        let number = interrupt as usize;
        set(MATRIX + 4 * source, number as u32);
        set(PRIORITY + 4 * number, 1);
    }
    set(ENABLE, USED.iter().fold(0, |all, used| all | 1 << used.1 as u32));
    // Safety: the table is aligned, and the handlers are defined below.
    unsafe {
        mtvec::write(Mtvec::from_bits((&raw const trap_table).addr() | VECTORED));
        riscv::interrupt::enable();
    }
}

#[riscv_rt::core_interrupt(Interrupt::MachineTimer)]
fn on_timer() {
    timer::on_interrupt();
}

#[riscv_rt::core_interrupt(Interrupt::MachineExternal)]
fn on_link() {
    link::on_interrupt();
}
