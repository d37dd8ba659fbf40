//! The trapezoid by its cheap recurrence.

use core::iter::FusedIterator;

use crate::rates::{Rates, RatesError, gain, square_of};
use crate::wide::{FRACTION_BITS, divide, quotient, root};

/// Ticks before each event of a trapezoid by the recurrence `c -= 2 c / (4 n + 1)`: one short
/// division an event.
///
/// For who has no cycles to spare and no changes on the way; [`Trapezoid`](crate::Trapezoid) is
/// exact at two to three times the cost.
///
/// - As many events as asked for, always.
/// - The recurrence is wrong in the first events: started with the true first interval it would run 48 % slow for ever, so
///   its start is scaled (by 0.676 from standstill) and all that follows is right in the limit. That scaled start would make the first
///   interval a third too short; the true one is given instead. **Errors of the intervals from standstill**: the first none, the second -2.1 %,
///   the third -0.7 %, the tenth -0.1 %; from a start rate less. To that comes 1 tick an interval.
/// - Slowing down is the recurrence backwards: the same intervals to the same errors.
/// - The top rate is exceeded by rounding, and by the error of that event where the first three reach it; the acceleration by 5 % in
///   the second event and by up to 25 % in the one event where two parts meet.
///
/// Range: as [`Trapezoid`](crate::Trapezoid), and ramps of fewer than 2^29 events. Size: 64 bytes
/// at most. Cost of an event on a ramp, loop included: 27 instructions on Cortex-M4F, 62 on
/// Cortex-M0 (at 1 MHz and 100 000 steps/s^2; 138 at 32 MHz and 4000 steps/s^2: its division in
/// software takes longer the longer the quotient).
///
/// ```
/// use husillo_planner::{Rates, Recurrence};
///
/// let rates = Rates {
///     timer_hz: 1_000_000,
///     start_rate_hz: 0,
///     top_rate_hz: 200,
///     end_rate_hz: 0,
///     acceleration_hz_per_s: 5000,
/// };
/// let intervals: Vec<u32> = Recurrence::new(&rates, 10)?.collect();
/// assert_eq!(intervals, [20000, 8112, 6309, 5339, 5000, 5000, 5338, 6309, 8111, 20000]);
/// # Ok::<(), husillo_planner::RatesError>(())
/// ```
///
/// Source: D. Austin, "Generate stepper-motor speed profiles in real time", EE Times 2004, eq. 13
/// and 15; Atmel AVR446. The first interval is neither's.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Recurrence {
    part: Part,
    /// Events left in this part.
    run: u32,
    /// The interval in ticks, below 2^30.
    interval: u32,
    /// What the last division left over: `rest / divisor` is the fraction of a tick that the
    /// interval has too much on the way up, too little on the way down.
    rest: u32,
    /// 4 n + 1 of the next division.
    divisor: u32,
    /// Events of the parts, the true first and last interval, and how the way down begins.
    up: u32,
    level: u32,
    down: u32,
    first: u32,
    last: u32,
    interval_down: u32,
    rest_down: u32,
    divisor_down: u32,
    /// Ticks at the top rate and their fraction.
    period: (u32, u32),
    owed: u32,
}

#[derive(Clone, Copy, PartialEq, Eq, Debug)]
enum Part {
    Start,
    Up,
    Level,
    Down,
}

impl Recurrence {
    /// The profile of a move of so many events. Start and end rates above the top rate are taken as
    /// the top rate.
    ///
    /// # Errors
    /// See [`RatesError`].
    pub fn new(rates: &Rates, events: u32) -> Result<Recurrence, RatesError> {
        rates.check()?;
        let gain = gain(rates.timer_hz, rates.acceleration_hz_per_s);
        let square = |rate| square_of(rates.timer_hz, rates.acceleration_hz_per_s, rate);
        let top = square(rates.top_rate_hz);
        let start = square(rates.start_rate_hz).min(top);
        let end = square(rates.end_rate_hz).min(top);
        // gain < 2^92, events < 2^32: fits.
        if start > end.wrapping_add(gain.wrapping_mul(events.into())) {
            return Err(RatesError::TooShort);
        }
        // So many that the mean rate of the last one is at most the top rate.
        let reach = |from: u128| {
            // Half an event less the rounding of n; three eighths of gain < 2^92.
            let nearly_half = gain.wrapping_mul(3).wrapping_shr(3);
            quotient(top.wrapping_sub(from).wrapping_add(nearly_half), gain)
        };
        // Where both ramps meet: the mean squares of the two middle events differ by one gain at
        // most.
        let ahead = if end >= start {
            u64::from(events).saturating_add(quotient(end.wrapping_sub(start), gain))
        } else {
            u64::from(events).saturating_sub(quotient(
                start.wrapping_sub(end).wrapping_add(gain).wrapping_sub(1),
                gain,
            ))
        };
        let meeting = ahead.saturating_add(1) >> 1;
        let up = reach(start).min(meeting).min(events.into()) as u32;
        let down = reach(end).min(events.wrapping_sub(up).into()) as u32;
        let level = events.wrapping_sub(up).wrapping_sub(down);
        let ends = |from: u128| root(from.wrapping_add(gain)).wrapping_sub(root(from));
        let (first, last) = (ends(start), ends(end));
        // 4 n of an event of a ramp, to the nearest: an eighth of an event off at most. The
        // divisors stay below 2^31.
        let index = |from: u128, count: u32| {
            let sum = quotient(from.wrapping_shl(2).wrapping_add(gain >> 1), gain)
                .saturating_add(u64::from(count).wrapping_mul(4));
            u32::try_from(sum)
                .ok()
                .filter(|sum| *sum < (1 << 31) - 8)
                .ok_or(RatesError::RampTooLong)
        };
        index(start, up)?;
        let divisor_up = index(start, 0)?.wrapping_add(5);
        let (ticks_up, fraction_up) = scaled_start(index(start, 0)?, gain);
        let interval_up = ticks_up.wrapping_add(u32::from(fraction_up != 0));
        let divisor_down = index(end, down)?.saturating_sub(5).max(1);
        let (interval_down, fraction_down) =
            scaled_start(index(end, down)?.saturating_sub(4), gain);
        let period = u64::from(rates.timer_hz)
            .wrapping_shl(32)
            .checked_div(rates.top_rate_hz.into())
            .unwrap_or(0);
        Ok(Recurrence {
            part: Part::Start,
            run: 0,
            interval: interval_up,
            // The interval is rounded up: what it has too much is 2^32 less its fraction.
            rest: part_of(divisor_up, fraction_up.wrapping_neg()),
            divisor: divisor_up,
            up,
            level,
            down,
            first,
            last,
            interval_down,
            rest_down: part_of(divisor_down, fraction_down),
            divisor_down,
            period: ((period >> 32) as u32, period as u32),
            owed: 1 << 31,
        })
    }

    fn remaining(&self) -> u32 {
        // Their sum is at most what `new` was given.
        let later = match self.part {
            Part::Start => self.up.wrapping_add(self.level).wrapping_add(self.down),
            Part::Up => self.level.wrapping_add(self.down),
            Part::Level => self.down,
            Part::Down => 0,
        };
        self.run.wrapping_add(later)
    }

    /// The first event of the next part that has one.
    #[inline(never)]
    fn turn(&mut self) -> Option<u32> {
        if self.part == Part::Start {
            self.part = Part::Up;
            if let Some(run) = self.up.checked_sub(1) {
                self.run = run;
                return Some(self.first);
            }
        }
        if self.part == Part::Up {
            self.part = Part::Level;
            self.run = self.level;
            if self.run != 0 {
                return self.next();
            }
        }
        if self.part == Part::Level {
            self.part = Part::Down;
            self.run = self.down;
            if let Some(run) = self.run.checked_sub(1) {
                self.run = run;
                self.interval = self.interval_down;
                self.divisor = self.divisor_down;
                self.rest = self.rest_down;
                return Some(if run == 0 { self.last } else { self.interval });
            }
        }
        None
    }

    /// 2 c / (4 n + 1), with the remainder of the division before.
    #[inline]
    fn change(&mut self) -> u32 {
        // c < 2^30, rest < divisor < 2^31.
        let double = self.interval.wrapping_mul(2).wrapping_add(self.rest);
        let change = double.checked_div(self.divisor).unwrap_or(0);
        self.rest = double.wrapping_sub(change.wrapping_mul(self.divisor));
        change
    }
}

impl Iterator for Recurrence {
    type Item = u32;

    #[inline]
    fn next(&mut self) -> Option<u32> {
        if self.run == 0 {
            return self.turn();
        }
        self.run = self.run.wrapping_sub(1);
        match self.part {
            Part::Start | Part::Up => {
                self.interval = self.interval.wrapping_sub(self.change());
                self.divisor = self.divisor.wrapping_add(4);
                Some(self.interval)
            }
            Part::Level => {
                let (owed, carry) = self.owed.overflowing_add(self.period.1);
                self.owed = owed;
                Some(self.period.0.saturating_add(carry.into()))
            }
            Part::Down => {
                self.interval = self.interval.wrapping_add(self.change());
                self.divisor = self.divisor.wrapping_sub(4);
                Some(if self.run == 0 {
                    self.last
                } else {
                    self.interval
                })
            }
        }
    }

    fn size_hint(&self) -> (usize, Option<usize>) {
        let len = self.remaining() as usize;
        (len, Some(len))
    }
}

impl ExactSizeIterator for Recurrence {}
impl FusedIterator for Recurrence {}

/// The interval with which the recurrence is right in the limit when it starts with event n: ticks
/// and their fraction.
///
/// Its solution is proportional to Gamma(n + 3/4) / Gamma(n + 5/4), the true interval in the limit
/// to w^(-1/2), w = n + 1/2: that is g / (2 T) at the middle of the event, times 1 - 1 / (64 w^2 +
/// 6.7), to 0.02 % from standstill (0.676 of the true first interval) and better from any other
/// rate.
fn scaled_start(four_n: u32, gain: u128) -> (u32, u32) {
    // The square in the middle of the event: g (4 n + 2) / 4; the product is below 2^124.
    let quarters = four_n.wrapping_add(2);
    let middle = gain.wrapping_mul(quarters.into()) >> 2;
    // As many bits of root as 32 hold, at most 16 below a tick.
    let spare = (middle.leading_zeros().saturating_sub(128 - 96) >> 1).min(16);
    let twice = spare.wrapping_mul(2);
    let root = (middle.wrapping_shr(FRACTION_BITS.wrapping_sub(twice)) as u64).isqrt();
    // gain < 2^92. The quotient is the interval, below 2^30, with 33 fraction bits.
    let exact = divide(gain.wrapping_shl(spare), root.min(u32::MAX.into()) as u32);
    let interval = exact.wrapping_shr(1).min(1 << 62) as u64;
    // 16 times 2 w.
    let w = u64::from(quarters).min(1 << 20).wrapping_mul(8);
    let excess = interval
        .checked_div(w.wrapping_mul(w).wrapping_add(107))
        .unwrap_or(0)
        .saturating_mul(16);
    let interval = interval.saturating_sub(excess);
    ((interval >> 32) as u32, interval as u32)
}

/// `value` times `fraction` / 2^32, rounded down.
fn part_of(value: u32, fraction: u32) -> u32 {
    (u64::from(value).wrapping_mul(fraction.into()) >> 32) as u32
}
