//! The cycles of a RISC-V processor.

use riscv::register::mcycle;

/// The counter of cycles, which always runs.
#[derive(Clone, Copy)]
pub struct Counter;

impl Counter {
    /// Takes the counter.
    pub fn start() -> Self {
        Self
    }

    /// The name in the table.
    pub fn name(self) -> &'static str {
        "mcycle"
    }

    /// Begins a measurement.
    #[inline]
    pub fn begin(self) -> u32 {
        mcycle::read() as u32
    }

    /// The cycles since `begin`, below 2^32.
    #[inline]
    pub fn since(self, begin: u32) -> Option<u32> {
        Some((mcycle::read() as u32).wrapping_sub(begin))
    }
}
