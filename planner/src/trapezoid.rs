//! Trapezoidal speed profile: constant acceleration, constant rate, constant deceleration.

use crate::rates::{Rates, RatesError, gain, square_of};
use crate::wide::{FRACTION_BITS, divide, quotient, root, share};

/// Ticks before each event of a move that accelerates, cruises and decelerates at constant
/// acceleration.
///
/// ```text
/// rate          top
///          ______________
///         /              \
///        /                \
/// start /                  \ end
///       |up| level       |down|
/// ```
///
/// The events are those of the true trapezoid, one at every whole step of its path. On a ramp, let
/// T = f v / a be the time since standstill (f ticks per second, rate v, acceleration a). The n-th
/// event is then at `T^2 = T0^2 + n 2 f^2 / a`. The square is kept in integers, together with its
/// root T (rounded down) and the remainder. The interval is the difference of two roots. So the
/// first event is as exact as the thousandth, and there is no drift.
///
/// - The number of events is always the requested one, and [`len`](ExactSizeIterator::len) is
///   exact.
/// - Each interval is within 1 tick of the true one, and within 2 ticks where two parts of the
///   profile meet. No sum of intervals is off by more than 2 ticks plus 1 for each such place.
///   `2 f^2 / a` has 32 fraction bits: less than 1 tick^2 in the square after 2^32 events.
/// - Between the same rates, slowing down gives the intervals of speeding up in reverse order, tick
///   for tick.
/// - The top rate may change in the move, and the move may be held and resumed. It still slows down
///   in time for its end.
///
/// Range: ramps of fewer than 2^30 ticks from standstill to the fastest rate (33 s at 32 MHz).
/// Size: 64 bytes.
///
/// # Cost
/// One event on a ramp, loop included: 66 instructions on Cortex-M4F and 143 on Cortex-M0 (mean
/// over a move of 2000 events at 1 MHz and 100 000 steps/s^2). At 32 MHz and 4000 steps/s^2, where
/// intervals change by thousands of ticks, it is 78 and 248. At the top rate it is 38 and 37. The
/// start of a part takes two more divisions by shift and subtract and up to four square roots.
///
/// # Examples
/// ```
/// use husillo_planner::{Rates, Trapezoid};
///
/// let rates = Rates {
///     timer_hz: 1_000_000,
///     start_rate_hz: 0,
///     top_rate_hz: 200,
///     end_rate_hz: 0,
///     acceleration_hz_per_s: 5000,
/// };
/// let intervals: Vec<u32> = Trapezoid::new(&rates, 10)?.collect();
/// assert_eq!(intervals, [20000, 8284, 6357, 5359, 5000, 5000, 5359, 6357, 8284, 20000]);
/// # Ok::<(), husillo_planner::RatesError>(())
/// ```
///
/// # Source
/// D. Austin, "Generate stepper-motor speed profiles in real time", EE Times 2004, eq. 6 (exact
/// timing, before the approximation). The root with remainder by integer Newton steps is our own.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Trapezoid {
    timer_hz: u32,
    acceleration_hz_per_s: u32,
    top_rate_hz: u32,
    end_rate_hz: u32,
    /// 2 f^2 / a in ticks^2: the whole part is below 2^60, and 32 fraction bits follow.
    gain: u64,
    gain_fraction: u32,
    /// Events up to the end of the move, or to the stop of a hold.
    remaining: u32,
    /// Events after that stop.
    beyond: u32,
    /// Events left until the next part of the profile is chosen.
    run: u32,
    pace: Pace,
    is_holding: bool,
}

/// How the next events are timed.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
enum Pace {
    Up(Point),
    Down(Point),
    /// At the top rate: ticks of one event, 32 fraction bits, and the carried fraction of a tick.
    Level {
        ticks: u32,
        fraction: u32,
        owed: u32,
    },
}

/// A point of a ramp: `time^2 + residue + fraction / 2^32` is its square.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
struct Point {
    /// Ticks since standstill, rounded down; below 2^30.
    time: u32,
    /// At most 2 `time`.
    residue: u32,
    fraction: u32,
    /// Last interval, used as the guess for the next one.
    last: u32,
}

impl Trapezoid {
    /// Creates the profile of a move of `events` events.
    ///
    /// # Errors
    /// See [`RatesError`]. An end rate too high to be reached is not an error.
    pub fn new(rates: &Rates, events: u32) -> Result<Trapezoid, RatesError> {
        rates.check()?;
        let gain = gain(rates.timer_hz, rates.acceleration_hz_per_s);
        let square = |rate| square_of(rates.timer_hz, rates.acceleration_hz_per_s, rate);
        let start = square(rates.start_rate_hz);
        // gain < 2^92, events < 2^32: fits.
        let highest = square(rates.end_rate_hz).wrapping_add(gain.wrapping_mul(events.into()));
        if start > highest {
            return Err(RatesError::TooShort);
        }
        Ok(Trapezoid {
            timer_hz: rates.timer_hz,
            acceleration_hz_per_s: rates.acceleration_hz_per_s,
            top_rate_hz: rates.top_rate_hz,
            end_rate_hz: rates.end_rate_hz,
            gain: gain.wrapping_shr(FRACTION_BITS) as u64,
            gain_fraction: gain as u32,
            remaining: events,
            beyond: 0,
            run: 0,
            pace: Pace::Up(Point::new(start)),
            is_holding: false,
        })
    }

    /// Events still to come in the whole move. [`len`](ExactSizeIterator::len) counts only those
    /// before the next stop.
    pub const fn remaining(&self) -> u32 {
        // The sum is at most the number of events given to `new`.
        self.remaining.wrapping_add(self.beyond)
    }

    /// The present rate in Hz, rounded down: too low by at most 1 Hz plus the change of rate in one
    /// tick.
    pub fn rate_hz(&self) -> u32 {
        let (Pace::Up(point) | Pace::Down(point)) = self.pace else {
            return self.top_rate_hz;
        };
        // time a < 2^62.
        u64::from(point.time)
            .wrapping_mul(self.acceleration_hz_per_s.into())
            .checked_div(self.timer_hz.into())
            .unwrap_or(0) as u32
    }

    /// Changes the top rate from the next event on (feed override). The rate changes at the
    /// acceleration of the move. The move still ends at or below its end rate.
    ///
    /// # Errors
    /// [`RatesError::Zero`] and [`RatesError::RampTooLong`]; the profile then stays unchanged.
    pub fn set_top_rate(&mut self, top_rate_hz: u32) -> Result<(), RatesError> {
        let rates = Rates {
            timer_hz: self.timer_hz,
            start_rate_hz: 0,
            top_rate_hz,
            end_rate_hz: 0,
            acceleration_hz_per_s: self.acceleration_hz_per_s,
        };
        rates.check()?;
        self.look_again();
        self.top_rate_hz = top_rate_hz;
        Ok(())
    }

    /// Slows down to standstill from the next event on. Returns the number of events to the stop.
    /// The iterator ends at the stop, and the rest of the move is
    /// [`remaining`](Trapezoid::remaining). Returns `None` and changes nothing where the move ends
    /// before a stop is possible; hold the next move then.
    pub fn hold(&mut self) -> Option<u32> {
        if self.is_holding {
            return Some(self.remaining);
        }
        if self.remaining == 0 {
            return None;
        }
        let gain = self.gain();
        let square = self.square();
        // Rounded up; below 2^92 + 2^94.
        let brake = quotient(square.wrapping_add(gain).wrapping_sub(1), gain);
        let stop = u32::try_from(brake)
            .ok()
            .filter(|stop| *stop <= self.remaining)?;
        self.look_again();
        self.beyond = self.remaining.wrapping_sub(stop);
        self.remaining = stop;
        self.is_holding = true;
        Some(stop)
    }

    /// Ends a hold, before or after its stop. The move continues from its present rate.
    pub fn resume(&mut self) {
        if self.is_holding {
            self.look_again();
            self.remaining = self.remaining();
            self.beyond = 0;
            self.is_holding = false;
        }
    }

    /// Changes the number of events to come, from the next event on: another goal in the same
    /// direction. The rate continues from the present one, and a hold ends. Returns `false` where
    /// the events are too few to slow down to the end rate; the profile then stays unchanged.
    pub fn set_remaining(&mut self, events: u32) -> bool {
        let square = self.square();
        // gain < 2^92, events < 2^32, a square < 2^92: fits.
        let highest = self
            .square_of(self.end_rate_hz)
            .wrapping_add(self.gain().wrapping_mul(events.into()));
        if square > highest {
            return false;
        }
        self.look_again();
        self.remaining = events;
        self.beyond = 0;
        self.is_holding = false;
        true
    }

    /// Whether a hold has reached its stop.
    pub const fn is_held(&self) -> bool {
        self.is_holding && self.remaining == 0
    }

    /// Makes the next event choose its part of the profile.
    fn look_again(&mut self) {
        if let Pace::Level { .. } = self.pace {
            self.pace = Pace::Up(Point::new(self.square()));
        }
        self.run = 0;
    }

    fn gain(&self) -> u128 {
        u128::from(self.gain).wrapping_shl(FRACTION_BITS) | u128::from(self.gain_fraction)
    }

    /// The square of the present time since standstill.
    fn square(&self) -> u128 {
        match self.pace {
            Pace::Up(point) | Pace::Down(point) => point.square(),
            Pace::Level { .. } => self.square_of(self.top_rate_hz),
        }
    }

    fn square_of(&self, rate_hz: u32) -> u128 {
        square_of(self.timer_hz, self.acceleration_hz_per_s, rate_hz)
    }

    /// The next event in the present part of the profile.
    #[inline]
    fn step(&mut self) -> u32 {
        // `next` and `begin` guarantee that both are at least 1.
        self.run = self.run.wrapping_sub(1);
        self.remaining = self.remaining.wrapping_sub(1);
        match &mut self.pace {
            Pace::Up(point) => point.rise(self.gain, self.gain_fraction),
            Pace::Down(point) => point.fall(self.gain, self.gain_fraction),
            Pace::Level {
                ticks,
                fraction,
                owed,
            } => {
                let (sum, carry) = owed.overflowing_add(*fraction);
                *owed = sum;
                ticks.saturating_add(carry.into())
            }
        }
    }

    /// Chooses the part of the profile for the next event, or makes the one event in which two
    /// parts meet.
    ///
    /// Invariant: square <= end + remaining gain, so the end rate can be met.
    #[inline(never)]
    fn turn(&mut self) -> Option<u32> {
        let after = self.remaining.checked_sub(1)?;
        let gain = self.gain();
        let square = self.square();
        let top = self.square_of(self.top_rate_hz);
        let end = if self.is_holding {
            0
        } else {
            self.square_of(self.end_rate_hz)
        };
        // The highest square after this event from which the end rate can be met.
        let line = end.wrapping_add(gain.wrapping_mul(after.into()));
        let next = top.min(line);
        if square > top {
            let count = self.capped(quotient(square.wrapping_sub(top), gain));
            if count != 0 {
                return Some(self.begin(Pace::Down(Point::falling(square, gain)), count));
            }
            return Some(if top <= line {
                self.sink(square, top, gain)
            } else {
                self.cross(square, next, square, gain)
            });
        }
        // Events not needed for slowing down: remaining - ceil((square - end) / gain).
        let spare = match square.checked_sub(end) {
            Some(above) => u64::from(self.remaining)
                .saturating_sub(quotient(above.wrapping_add(gain).saturating_sub(1), gain)),
            None => quotient(end.wrapping_sub(square), gain).saturating_add(self.remaining.into()),
        };
        let up = self.capped(quotient(top.wrapping_sub(square), gain).min(spare >> 1));
        if up != 0 {
            return Some(self.begin(Pace::Up(Point::rising(square, gain)), up));
        }
        if square == top && spare != 0 {
            let period = self.top_period();
            let level = Pace::Level {
                ticks: period.wrapping_shr(32) as u32,
                fraction: period as u32,
                owed: 1 << 31,
            };
            return Some(self.begin(level, self.capped(spare)));
        }
        if square == line.wrapping_add(gain) {
            return Some(self.begin(Pace::Down(Point::falling(square, gain)), self.remaining));
        }
        Some(self.cross(square, next, top, gain))
    }

    fn capped(&self, count: u64) -> u32 {
        count.min(self.remaining.into()) as u32
    }

    fn begin(&mut self, pace: Pace, run: u32) -> u32 {
        self.pace = pace;
        self.run = run;
        self.step()
    }

    /// Makes the event in which the profile rises from `square`, is cut off at `cap` and falls to
    /// `next`.
    fn cross(&mut self, square: u128, next: u128, cap: u128, gain: u128) -> u32 {
        // The rise and the fall, in units of the square, add up to the gain; all are below 2^93.
        let twice_peak = square.wrapping_add(next).wrapping_add(gain);
        let twice_cap = cap.wrapping_shl(1);
        let around = root(twice_peak.min(twice_cap).wrapping_shl(1));
        let level = match twice_peak.checked_sub(twice_cap) {
            Some(left) => self.level(left, cap, gain),
            None => 0,
        };
        let ticks = around
            .saturating_sub(root(square))
            .saturating_sub(root(next))
            .saturating_add(level);
        self.arrive(next, ticks)
    }

    /// Makes the event in which the profile falls from `square` to `top` and continues there.
    fn sink(&mut self, square: u128, top: u128, gain: u128) -> u32 {
        let left = gain.wrapping_sub(square.wrapping_sub(top));
        let ticks = root(square)
            .saturating_sub(root(top))
            .saturating_add(self.level(left, top, gain));
        self.arrive(top, ticks)
    }

    fn arrive(&mut self, square: u128, ticks: u32) -> u32 {
        self.pace = Pace::Up(Point::new(square));
        self.remaining = self.remaining.wrapping_sub(1);
        ticks
    }

    /// Ticks of the fraction `left / gain` of an event at the rate of `square`.
    fn level(&self, left: u128, square: u128, gain: u128) -> u32 {
        let period = if square == self.square_of(self.top_rate_hz) {
            self.top_period()
        } else {
            // g / 2 T, with 10 more bits where T has few; g is below 2^94.
            let more = if square >> 20 == 0 { 10 } else { 0 };
            let double = root(square.wrapping_shl(2_u32.wrapping_add(2 * more)));
            divide(gain.wrapping_shl(more), double.max(1)).min(u64::MAX.into()) as u64
        };
        // At most 2^32 times 2^64.
        u128::from(share(left, gain))
            .wrapping_mul(period.into())
            .wrapping_shr(64)
            .min(u32::MAX.into()) as u32
    }

    /// Ticks of an event at the top rate, with 32 fraction bits.
    fn top_period(&self) -> u64 {
        u64::from(self.timer_hz)
            .wrapping_shl(32)
            .checked_div(self.top_rate_hz.into())
            .unwrap_or(0)
    }
}

impl Iterator for Trapezoid {
    type Item = u32;

    #[inline]
    fn next(&mut self) -> Option<u32> {
        if self.run == 0 {
            return self.turn();
        }
        Some(self.step())
    }

    fn size_hint(&self) -> (usize, Option<usize>) {
        let len = self.remaining as usize;
        (len, Some(len))
    }
}

impl ExactSizeIterator for Trapezoid {}

impl Point {
    fn new(square: u128) -> Point {
        let time = root(square);
        let whole = square.wrapping_shr(FRACTION_BITS) as u64;
        Point {
            time,
            residue: whole.wrapping_sub(u64::from(time).wrapping_mul(time.into())) as u32,
            fraction: square as u32,
            last: 0,
        }
    }

    fn rising(square: u128, gain: u128) -> Point {
        let mut point = Point::new(square);
        point.last = root(square.wrapping_add(gain)).wrapping_sub(point.time);
        point
    }

    /// `square` has to be at least `gain`.
    fn falling(square: u128, gain: u128) -> Point {
        let mut point = Point::new(square);
        point.last = point.time.wrapping_sub(root(square.wrapping_sub(gain)));
        point
    }

    fn square(&self) -> u128 {
        let time = u64::from(self.time);
        let whole = time.wrapping_mul(time).wrapping_add(self.residue.into());
        u128::from(whole).wrapping_shl(FRACTION_BITS) | u128::from(self.fraction)
    }

    /// Goes on by one event of acceleration and returns its interval. The square after it stays
    /// below 2^60.
    #[inline]
    fn rise(&mut self, gain: u64, gain_fraction: u32) -> u32 {
        let (fraction, carry) = self.fraction.overflowing_add(gain_fraction);
        // The last interval was longer, at most 3 times this one. So time < 2^31, and the sum of
        // both times is below 2^32.
        let time = self.time.wrapping_add(self.last);
        let covered = u64::from(self.last).wrapping_mul(time.wrapping_add(self.time).into());
        let rest = u64::from(self.residue)
            .wrapping_add(gain)
            .wrapping_add(carry.into())
            .wrapping_sub(covered);
        self.fraction = fraction;
        let (time, residue) = settle(time, rest);
        let ticks = time.wrapping_sub(self.time);
        self.last = ticks;
        self.time = time;
        self.residue = residue;
        ticks
    }

    /// Goes on by one event of deceleration and returns its interval. The square has to be at least
    /// the gain.
    #[inline]
    fn fall(&mut self, gain: u64, gain_fraction: u32) -> u32 {
        let (fraction, borrow) = self.fraction.overflowing_sub(gain_fraction);
        // The last interval was shorter, and this one is at most `time`.
        let time = self.time.saturating_sub(self.last);
        let covered = u64::from(self.time.wrapping_sub(time))
            .wrapping_mul(time.wrapping_add(self.time).into());
        let rest = u64::from(self.residue)
            .wrapping_sub(gain)
            .wrapping_sub(borrow.into())
            .wrapping_add(covered);
        self.fraction = fraction;
        let (time, residue) = settle(time, rest);
        let ticks = self.time.wrapping_sub(time);
        self.last = ticks;
        self.time = time;
        self.residue = residue;
        ticks
    }
}

/// The root of `time^2 + rest` and its remainder. `rest` is a two's complement number; the sum is
/// from 0 to below 2^60.
#[inline]
fn settle(time: u32, rest: u64) -> (u32, u32) {
    // A negative rest appears as a huge number. Twice a time is below 2^32.
    let twice = time.wrapping_mul(2);
    if rest <= u64::from(twice) {
        return (time, rest as u32);
    }
    // One Newton step in 32 bits; the square of its error rarely makes it insufficient. Twice a
    // time is the slope of the square.
    if (rest >> 32) as u32 == u32::MAX {
        let error = (rest as u32).wrapping_neg();
        // Rounded up; at most t, because t^2 is at least the error. (t - c)^2 = t^2 - c (2 t - c).
        let change = error.checked_div(twice).unwrap_or(0).wrapping_add(1);
        // The remainder is at most one slope more than the error, so modulo 2^32 no other value
        // looks like a valid remainder.
        let near = time.wrapping_sub(change);
        let left = change
            .wrapping_mul(twice.wrapping_sub(change))
            .wrapping_sub(error);
        if change <= SMALL && left <= near.wrapping_mul(2) {
            return (near, left);
        }
    } else if (rest >> 32) as u32 == 0 {
        let error = rest as u32;
        let change = error.checked_div(twice).unwrap_or(0);
        let near = time.wrapping_add(change);
        let left = error.wrapping_sub(change.wrapping_mul(twice.wrapping_add(change)));
        if change <= SMALL && left <= near.wrapping_mul(2) {
            return (near, left);
        }
    }
    far(time, rest)
}

/// Changes of time up to this have squares below 2^30.
const SMALL: u32 = 0x7fff;

/// The same by Newton steps in 64 bits, for the first events of a ramp and for very slow ones.
#[inline(never)]
fn far(time: u32, rest: u64) -> (u32, u32) {
    let (mut time, mut rest) = (time, rest);
    // A step squares the error, so three steps normally suffice. The root below covers the rest.
    for _ in 0..3 {
        let twice = time.wrapping_mul(2);
        let is_below = rest >> 63 != 0;
        let error = if is_below { rest.wrapping_neg() } else { rest };
        let shift = 32_u32.wrapping_sub(((error >> 32) as u32).leading_zeros());
        let Some(change) =
            (error.wrapping_shr(shift) as u32).checked_div(twice.wrapping_shr(shift))
        else {
            break;
        };
        // (t + c)^2 = t^2 + c (2 t + c), modulo 2^64. Never below 0.
        if is_below {
            let change = change.wrapping_add(1).min(time);
            let both = u64::from(twice).wrapping_sub(change.into());
            rest = rest.wrapping_add(both.wrapping_mul(change.into()));
            time = time.wrapping_sub(change);
        } else {
            let both = u64::from(twice).wrapping_add(change.into());
            rest = rest.wrapping_sub(both.wrapping_mul(change.into()));
            time = time.wrapping_add(change);
        }
        if rest <= u64::from(time).wrapping_mul(2) {
            return (time, rest as u32);
        }
    }
    let square = u64::from(time).wrapping_mul(time.into()).wrapping_add(rest);
    let time = square.isqrt();
    (
        time as u32,
        square.wrapping_sub(time.wrapping_mul(time)) as u32,
    )
}
