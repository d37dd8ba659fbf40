//! The trapezoid by a cheap recurrence.

use core::iter::FusedIterator;

use crate::rates::{Rates, RatesError, gain, square_of};
use crate::wide::{FRACTION_BITS, divide, quotient, root};

/// Ticks before each event of a trapezoid, by the recurrence `c -= 2 c / (4 n + 1)`: one short
/// division per event.
///
/// For controllers without cycles to spare, and for moves that do not change while they run.
/// [`Trapezoid`](crate::Trapezoid) is exact at two to three times the cost.
///
/// - The number of events is always the requested one.
/// - The recurrence is inaccurate in the first events. Started with the true first interval it
///   would stay 48 % too slow, so its start is scaled (by 0.676 from standstill) and all later
///   intervals converge to the true ones. With that scaled start the first interval would be a
///   third too short, so the true one is used instead. **Errors of the intervals from standstill**:
///   the first has none, the second -2.1 %, the third -0.7 %, the tenth -0.1 %. From a start rate
///   they are smaller. Rounding adds 1 tick per interval.
/// - Slowing down is the same recurrence backwards: the same intervals with the same errors.
/// - The top rate is exceeded by rounding, and by the error of the event where one of the first
///   three events reaches it. The acceleration is exceeded by 5 % in the second event and by up to
///   25 % in the one event where two parts meet.
///
/// Range: that of [`Trapezoid`](crate::Trapezoid), and ramps of fewer than 2^29 events. Size: at
/// most 64 bytes.
///
/// # Cost
/// One event on a ramp, loop included, at 1 MHz and 100 000 steps/s^2: 27 instructions on
/// Cortex-M4F, 62 on Cortex-M0. At 32 MHz and 4000 steps/s^2 a Cortex-M0 takes 138, because its
/// software division takes longer for longer quotients.
///
/// # Examples
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
/// # Source
/// D. Austin, "Generate stepper-motor speed profiles in real time", EE Times 2004, eq. 13 and 15;
/// Atmel AVR446. The treatment of the first interval is our own.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Recurrence {
    part: Part,
    /// Events left in this part.
    run: u32,
    /// The interval in ticks, below 2^30.
    interval: u32,
    /// Remainder of the last division. `rest / divisor` is the fraction of a tick by which the
    /// interval is too long while speeding up, and too short while slowing down.
    rest: u32,
    /// 4 n + 1 of the next division.
    divisor: u32,
    /// Number of events in each part, the true first and last interval, and the start of the
    /// deceleration.
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

/// 4 n of event `count` of a ramp, rounded to nearest: off by at most an eighth of an event. The
/// divisors made of it stay below 2^31.
#[inline]
fn ramp_index(gain: u128, from: u128, count: u32) -> Result<u32, RatesError> {
    let sum = quotient(from.wrapping_shl(2).wrapping_add(gain >> 1), gain)
        .saturating_add(u64::from(count).wrapping_mul(4));
    u32::try_from(sum)
        .ok()
        .filter(|sum| *sum < (1 << 31) - 8)
        .ok_or(RatesError::RampTooLong)
}

impl Recurrence {
    /// Creates the profile of a move of `events` events. Start and end rates above the top rate are
    /// taken as the top rate.
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
        // The number of events for which the mean rate of the last one is at most the top rate.
        let reach = |from: u128| {
            // Half an event minus the rounding of n: three eighths of gain < 2^92.
            let nearly_half = gain.wrapping_mul(3).wrapping_shr(3);
            quotient(top.wrapping_sub(from).wrapping_add(nearly_half), gain)
        };
        // The event where both ramps meet: the mean squares of the two middle events differ by at
        // most one gain.
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
        let (up, level, down) = if events == 1 {
            (1, 0, 0)
        } else {
            (up, level, down)
        };
        let ends = |from: u128| root(from.wrapping_add(gain)).wrapping_sub(root(from));
        let (first, last) = if events == 1 {
            (only(rates, [start, end, top], gain), 0)
        } else {
            (ends(start), ends(end))
        };
        let index = |from: u128, count: u32| ramp_index(gain, from, count);
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
            // The interval is rounded up; the excess is 2^32 minus its fraction.
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
        // The sum is at most the number of events given to `new`.
        let later = match self.part {
            Part::Start => self.up.wrapping_add(self.level).wrapping_add(self.down),
            Part::Up => self.level.wrapping_add(self.down),
            Part::Level => self.down,
            Part::Down => 0,
        };
        self.run.wrapping_add(later)
    }

    /// Makes the first event of the next part that has one.
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

    /// 2 c / (4 n + 1), including the remainder of the division before.
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

/// Ticks of a move of one event: it speeds up, and slows down where it has to.
///
/// The squares are those of the start rate, the end rate and the top rate, in gains of one event;
/// all are below 2^92.
fn only(rates: &Rates, [start, end, top]: [u128; 3], gain: u128) -> u32 {
    let sum = start.wrapping_add(end);
    // With the end rate out of reach it only speeds up.
    let peak = sum.wrapping_add(gain).wrapping_shr(1);
    let peak = peak.min(start.wrapping_add(gain)).min(top);
    let end = end.min(peak);
    let up = root(peak).wrapping_sub(root(start));
    let ramps = up.wrapping_add(root(peak).wrapping_sub(root(end)));
    // The rest of the event at the top rate, in 2^-32: at most a whole event.
    let on_ramps = peak.wrapping_shl(1).wrapping_sub(start).wrapping_sub(end);
    let rest = gain.saturating_sub(on_ramps).wrapping_shl(32);
    let period = u64::from(rates.timer_hz).checked_div(rates.top_rate_hz.into());
    let level = u128::from(quotient(rest, gain)).wrapping_mul(period.unwrap_or(0).into());
    let level = if peak < top {
        0
    } else {
        level.wrapping_shr(32) as u32
    };
    ramps.wrapping_add(level)
}

/// The start interval with which the recurrence converges to the true intervals when it starts with
/// event n: ticks and their fraction.
///
/// The solution of the recurrence is proportional to Gamma(n + 3/4) / Gamma(n + 5/4). The true
/// interval tends to w^(-1/2) with w = n + 1/2. So the start interval is g / (2 T) at the middle of
/// the event, times 1 - 1 / (64 w^2 + 6.7). This holds to 0.02 % from standstill (0.676 of the true
/// first interval) and better from any other rate.
fn scaled_start(four_n: u32, gain: u128) -> (u32, u32) {
    // The square in the middle of the event is g (4 n + 2) / 4; the product is below 2^124.
    let quarters = four_n.wrapping_add(2);
    let middle = gain.wrapping_mul(quarters.into()) >> 2;
    // As many bits of the root as fit in 32, with at most 16 below a tick.
    let spare = (middle.leading_zeros().saturating_sub(128 - 96) >> 1).min(16);
    let twice = spare.wrapping_mul(2);
    let root = (middle.wrapping_shr(FRACTION_BITS.wrapping_sub(twice)) as u64).isqrt();
    // gain < 2^92. The quotient is the interval, below 2^30, with 33 fraction bits.
    let exact = divide(gain.wrapping_shl(spare), root.min(u32::MAX.into()) as u32);
    let interval = exact.wrapping_shr(1).min(1 << 62) as u64;
    // This is 16 times 2 w.
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
