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
    core_counters::{
        SYSTICK_CONTROL, SYSTICK_LAST, SYSTICK_RELOAD, SYSTICK_VALUE, cycles, start_cycles,
    },
    registers::set,
};
use cortex_m_rt::exception;

// Armv7-M Architecture Reference Manual, B3.2.4.
const PENDING: usize = 0xe000_ed04;
/// Counts cycles of the processor, with its interrupt.
const RUNS: u32 = 0b111;
const UNPEND: u32 = 1 << 25;
/// The counter of time counts cycles.
pub const CLOCKS_PER_US: u32 = CORE_MHZ;
/// The longest wait: SysTick has 24 bits.
pub const LONGEST_US: u32 = SYSTICK_LAST / CLOCKS_PER_US;
/// The shortest wait, in clocks.
const LEAST: u32 = 8;

/// The end of the last wait.
static LAST: Shared<u32> = Shared::new(0);

/// Starts the counter of time.
pub fn start() {
    start_cycles();
}

/// The counter of time, which wraps: [`CLOCKS_PER_US`] a microsecond.
pub fn clock() -> u32 {
    cycles()
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
        set(SYSTICK_CONTROL, 0);
        set(SYSTICK_RELOAD, left.max(LEAST));
        set(SYSTICK_VALUE, 0);
        set(SYSTICK_CONTROL, RUNS);
    });
}

/// Cancels the wait.
pub fn stop() {
    set(SYSTICK_CONTROL, 0);
    set(PENDING, UNPEND);
}

#[exception]
fn SysTick() {
    // It would begin again, and after a short wait it has done so already.
    stop();
    // Safety: this is an interrupt's handler.
    crate::on_time(unsafe { crate::section() });
}
