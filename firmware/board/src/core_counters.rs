//! The counters of a Cortex-M core: the cycle counter of its debug unit, and SysTick.
//!
//! A Cortex-M0 has no cycle counter. In QEMU it stays at 0. The Cortex-M0 of an nRF51 has no
//! SysTick either.
//!
//! # Source
//! Armv7-M Architecture Reference Manual, B3.3, C1.6.5 and C1.8.

use crate::registers::{read, set};

const DEBUG_CONTROL: usize = 0xe000_edfc;
const HAS_TRACE: u32 = 1 << 24;
const CYCLES_CONTROL: usize = 0xe000_1000;
const CYCLES: usize = 0xe000_1004;
/// The control of SysTick: bit 0 lets it run, bit 1 enables its interrupt, bit 2 selects cycles of
/// the processor. Bit 16 is whether it has reached 0 since the last reading.
pub const SYSTICK_CONTROL: usize = 0xe000_e010;
/// The value that SysTick takes after 0.
pub const SYSTICK_RELOAD: usize = 0xe000_e014;
/// The value of SysTick, which counts down. A write of any value sets it to 0.
pub const SYSTICK_VALUE: usize = 0xe000_e018;
/// The highest value of SysTick: 24 bits.
pub const SYSTICK_LAST: u32 = 0xff_ffff;

/// Starts the cycle counter. Only a core of Armv7-M or Armv8-M with the main extension has its
/// registers.
pub fn start_cycles() {
    set(DEBUG_CONTROL, read(DEBUG_CONTROL) | HAS_TRACE);
    set(CYCLES_CONTROL, read(CYCLES_CONTROL) | 1);
}

/// The cycles of the processor, modulo 2^32.
pub fn cycles() -> u32 {
    read(CYCLES)
}
