//! The system timer of an ESP32-C3. It counts at 16 MHz and compares its counter of 52 bits with
//! the end of the wait.
//!
//! Source: ESP32-C3 Technical Reference Manual, system timer.

use crate::{
    CriticalSection, Shared,
    registers::{read, set},
};

const TIMER: usize = 0x6002_3000;
const CONTROL: usize = TIMER;
const READ_OUT: usize = TIMER + 0x04;
const TARGET_HIGH: usize = TIMER + 0x1c;
const TARGET_LOW: usize = TIMER + 0x20;
const TARGET_MODE: usize = TIMER + 0x34;
const VALUE_HIGH: usize = TIMER + 0x40;
const VALUE_LOW: usize = TIMER + 0x44;
const TAKE_TARGET: usize = TIMER + 0x50;
const INTERRUPT_ENABLE: usize = TIMER + 0x64;
const INTERRUPT_RAW: usize = TIMER + 0x68;
const INTERRUPT_CLEAR: usize = TIMER + 0x6c;
const INTERRUPT: usize = TIMER + 0x70;
/// Bits of `CONTROL`: the registers have a clock, the counter runs, the comparison runs.
const HAS_CLOCK: u32 = 1 << 31;
const COUNTS: u32 = 1 << 30;
const COMPARES: u32 = 1 << 24;
/// Bits of `READ_OUT`: copy the counter, and the copy is complete.
const COPY: u32 = 1 << 30;
const IS_COPIED: u32 = 1 << 29;
/// Number of the source of interrupts.
pub const SOURCE: usize = 37;
/// The counter of time counts clocks.
pub const CLOCKS_PER_US: u32 = 16;
/// The timer accepts every wait.
pub const LONGEST_US: u32 = u32::MAX;
/// The shortest wait, in clocks: the time that setting it takes.
const LEAST: u64 = 16;

/// The end of the last wait.
static LAST: Shared<u64> = Shared::new(0);

/// Starts the counter.
pub fn start() {
    set(CONTROL, HAS_CLOCK | COUNTS);
    set(TARGET_MODE, 0); // one wait, by counter 0
    LAST.with(|last| *last = now());
}

fn now() -> u64 {
    critical_section::with(|_| {
        set(READ_OUT, COPY);
        while read(READ_OUT) & IS_COPIED == 0 {}
        u64::from(read(VALUE_HIGH)) << 32 | u64::from(read(VALUE_LOW))
    })
}

/// The counter of time, which wraps: [`CLOCKS_PER_US`] a microsecond.
pub fn clock() -> u32 {
    now() as u32
}

/// Calls `on_time` this many microseconds after the end of the previous wait, or at once if that
/// time has passed.
pub fn wait(us: u32, section: CriticalSection<'_>) {
    LAST.within(section, |last| {
        let mut now = self::now();
        // If the previous wait was cut short, its end is later than now. Then this wait counts from
        // now.
        let clocks = u64::from(us).wrapping_mul(CLOCKS_PER_US.into());
        let mut end = now.min(*last).wrapping_add(clocks);
        loop {
            end = end.max(now.wrapping_add(LEAST));
            set(CONTROL, HAS_CLOCK | COUNTS);
            set(INTERRUPT_CLEAR, 1);
            set(TARGET_HIGH, (end >> 32) as u32);
            set(TARGET_LOW, end as u32);
            set(TAKE_TARGET, 1);
            set(CONTROL, HAS_CLOCK | COUNTS | COMPARES);
            // A time that has passed in between might never be reached.
            now = self::now();
            if now < end || read(INTERRUPT_RAW) & 1 != 0 {
                break;
            }
        }
        *last = end;
        set(INTERRUPT_ENABLE, 1);
    });
}

/// Cancels the wait.
pub fn stop() {
    set(INTERRUPT_ENABLE, 0);
    set(CONTROL, HAS_CLOCK | COUNTS);
    set(INTERRUPT_CLEAR, 1);
}

/// The end of a wait. An interrupt that was cancelled may still come.
pub fn on_interrupt() {
    if read(INTERRUPT) & 1 != 0 {
        stop();
        // Safety: this is an interrupt's handler.
        crate::on_time(unsafe { crate::section() });
    }
}
