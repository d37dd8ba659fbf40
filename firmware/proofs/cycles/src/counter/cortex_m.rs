//! The cycles of a Cortex-M: by the cycle counter of its debug unit, or by SysTick, which every
//! Cortex-M0+ of these boards has.

use board::core_counters::{
    SYSTICK_CONTROL, SYSTICK_LAST, SYSTICK_RELOAD, SYSTICK_VALUE, cycles, start_cycles,
};
use board::registers::{read, set};

// Armv7-M Architecture Reference Manual, B3.2.3.
const CPUID: usize = 0xe000_ed00;
/// SysTick counts cycles of the processor, without an interrupt.
const RUNS: u32 = 0b101;
/// SysTick has reached 0 since the last reading of its control.
const HAS_WRAPPED: u32 = 1 << 16;
/// SysTick that is still 0 after this many readings stands.
const READINGS: u32 = 100;

/// A counter of cycles.
#[derive(Clone, Copy)]
pub enum Counter {
    /// 32 bits. A Cortex-M0 does not have it, nor does QEMU.
    Dwt,
    /// 24 bits, downwards.
    SysTick,
    /// Neither: the Cortex-M0 of an nRF51 has no SysTick.
    Nothing,
}

impl Counter {
    /// Starts a counter.
    pub fn start() -> Self {
        // The architecture: 0xc is Armv6-M, 0xf Armv7-M or Armv8-M with the main extension.
        if read(CPUID) >> 16 & 0xf == 0xf {
            start_cycles();
            let begin = cycles();
            if cycles() != begin {
                return Self::Dwt;
            }
        }
        set(SYSTICK_RELOAD, SYSTICK_LAST);
        set(SYSTICK_CONTROL, RUNS);
        if Self::SysTick.begin() == 0 {
            return Self::Nothing;
        }
        Self::SysTick
    }

    /// The name in the table.
    pub fn name(self) -> &'static str {
        match self {
            Self::Dwt => "DWT",
            Self::SysTick => "SysTick",
            Self::Nothing => "nothing",
        }
    }

    /// Begins a measurement.
    #[inline]
    pub fn begin(self) -> u32 {
        match self {
            Self::Dwt => cycles(),
            Self::SysTick => {
                // Any value sets it to 0, and the next cycle to the reload value. Reading the
                // control clears `HAS_WRAPPED`.
                set(SYSTICK_VALUE, 0);
                (0..READINGS).find(|_| read(SYSTICK_VALUE) != 0);
                read(SYSTICK_CONTROL);
                read(SYSTICK_VALUE)
            }
            Self::Nothing => 0,
        }
    }

    /// The cycles since `begin`. `None`: the counter has wrapped.
    #[inline]
    pub fn since(self, begin: u32) -> Option<u32> {
        match self {
            Self::Dwt => Some(cycles().wrapping_sub(begin)),
            Self::SysTick => {
                let value = read(SYSTICK_VALUE);
                (read(SYSTICK_CONTROL) & HAS_WRAPPED == 0).then(|| begin.wrapping_sub(value))
            }
            Self::Nothing => None,
        }
    }
}
