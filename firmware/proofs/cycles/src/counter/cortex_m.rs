//! The cycles of a Cortex-M: by the cycle counter of its debug unit, or by SysTick, which every
//! Cortex-M0+ of these boards has.

use board::registers::{read, set};

// Armv7-M Architecture Reference Manual, B3.2.3, B3.3, C1.6.5 and C1.8.
const CPUID: usize = 0xe000_ed00;
const DEBUG_CONTROL: usize = 0xe000_edfc;
const HAS_TRACE: u32 = 1 << 24;
const CYCLES_CONTROL: usize = 0xe000_1000;
const CYCLES: usize = 0xe000_1004;
const CONTROL: usize = 0xe000_e010;
const RELOAD: usize = 0xe000_e014;
const VALUE: usize = 0xe000_e018;
/// SysTick counts cycles of the processor, without an interrupt.
const RUNS: u32 = 0b101;
/// SysTick has reached 0 since the last reading of `CONTROL`.
const HAS_WRAPPED: u32 = 1 << 16;
const LAST: u32 = 0xff_ffff;
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
            set(DEBUG_CONTROL, read(DEBUG_CONTROL) | HAS_TRACE);
            set(CYCLES_CONTROL, read(CYCLES_CONTROL) | 1);
            let begin = read(CYCLES);
            if read(CYCLES) != begin {
                return Self::Dwt;
            }
        }
        set(RELOAD, LAST);
        set(CONTROL, RUNS);
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
            Self::Dwt => read(CYCLES),
            Self::SysTick => {
                // Any value sets it to 0, and the next cycle to `RELOAD`. This clears the flag.
                set(VALUE, 0);
                (0..READINGS).find(|_| read(VALUE) != 0);
                read(CONTROL);
                read(VALUE)
            }
            Self::Nothing => 0,
        }
    }

    /// The cycles since `begin`. `None`: the counter has wrapped.
    #[inline]
    pub fn since(self, begin: u32) -> Option<u32> {
        match self {
            Self::Dwt => Some(read(CYCLES).wrapping_sub(begin)),
            Self::SysTick => {
                let value = read(VALUE);
                (read(CONTROL) & HAS_WRAPPED == 0).then(|| begin.wrapping_sub(value))
            }
            Self::Nothing => None,
        }
    }
}
