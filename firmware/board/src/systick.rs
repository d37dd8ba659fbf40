//! Time and the step interrupt of a Cortex-M3 or M4, in cycles of the processor.
//!
//! SysTick counts down once to the end of a wait. The cycle counter of the debug unit never stops,
//! so the time that an interrupt takes does not add up over successive waits. QEMU does not have
//! this counter. There each wait begins when it is set, and no lease of a motion ends.
//!
//! The file of the board has `CORE_MHZ`, the clock of its processor.

use super::CORE_MHZ;
use crate::{
    CriticalSection, Shared,
    registers::{read, set},
};
use cortex_m_rt::exception;

// Armv7-M Architecture Reference Manual, B3.2.4, B3.3, C1.6.5 and C1.8.
const DEBUG_CONTROL: usize = 0xe000_edfc;
const HAS_TRACE: u32 = 1 << 24;
const CYCLES_CONTROL: usize = 0xe000_1000;
const CYCLES: usize = 0xe000_1004;
const CONTROL: usize = 0xe000_e010;
const RELOAD: usize = 0xe000_e014;
const VALUE: usize = 0xe000_e018;
const PENDING: usize = 0xe000_ed04;
/// Counts cycles of the processor, with its interrupt.
const RUNS: u32 = 0b111;
const UNPEND: u32 = 1 << 25;
/// The counter of time counts cycles.
pub const CLOCKS_PER_US: u32 = CORE_MHZ;
/// The longest wait: SysTick has 24 bits.
pub const LONGEST_US: u32 = 0xff_ffff / CLOCKS_PER_US;
/// The shortest wait, in clocks.
const LEAST: u32 = 8;

/// The end of the last wait.
static LAST: Shared<u32> = Shared::new(0);

/// Starts the counter of time.
pub fn start() {
    set(DEBUG_CONTROL, read(DEBUG_CONTROL) | HAS_TRACE);
    set(CYCLES_CONTROL, read(CYCLES_CONTROL) | 1);
}

/// The counter of time, which wraps: [`CLOCKS_PER_US`] a microsecond.
pub fn clock() -> u32 {
    read(CYCLES)
}

/// Calls `on_time` this many microseconds after the end of the previous wait, or at once if that
/// time has passed.
#[inline]
pub fn wait(us: u32, section: CriticalSection<'_>) {
    LAST.within(section, |last| {
        let now = clock();
        // At most 2^24, see `LONGEST_US`.
        let clocks = us.wrapping_mul(CLOCKS_PER_US);
        let left = last.wrapping_add(clocks).wrapping_sub(now);
        // If the time has passed, the difference wraps. If it passed long ago, the difference may
        // have any value, but seldom one within the wait.
        let left = if left.wrapping_sub(1) < clocks {
            left
        } else if last.wrapping_sub(now) < 1 << 31 {
            // The previous wait was cut short, so this one counts from now.
            clocks
        } else {
            LEAST
        };
        *last = now.wrapping_add(left);
        set(CONTROL, 0);
        set(RELOAD, left.max(LEAST));
        set(VALUE, 0);
        set(CONTROL, RUNS);
    });
}

/// Cancels the wait.
pub fn stop() {
    set(CONTROL, 0);
    set(PENDING, UNPEND);
}

#[exception]
fn SysTick() {
    // It would begin again.
    set(CONTROL, 0);
    // Safety: this is an interrupt's handler.
    crate::on_time(unsafe { crate::section() });
}
