//! Jerk-limited motion.

use crate::phases::{Bend, Course, Phases};
use crate::rates::{Rates, RatesError};
use crate::wide::{divide, quotient};

/// Ticks before each event of a move with limited jerk: seven phases, the acceleration changes at a
/// constant jerk.
///
/// ```text
/// rate              ______________
///               _-`                `-_
///             /                        \
///          _-`                          `-_
/// phase    1   2   3      4       5   6   7
/// jerk     +   0   -      0       -   0   +
/// ```
///
/// The phases last whole ticks. Rate, acceleration and path are therefore integers at every tick,
/// in units in which the jerk is 1. The events are those of this path, each at the nearest tick. A
/// short move has no room for the cruise or for the constant acceleration; these phases are then
/// absent.
///
/// - The number of events is always the requested one, and [`len`](ExactSizeIterator::len) is
///   exact. The last event falls on the end of phase 7.
/// - Every event is within 0.6 ticks of the profile and every interval within 1.2 ticks; there is
///   no drift.
/// - The profile keeps the limits: rates, acceleration and jerk never exceed the requested ones.
///   Start and end rate are met within the change of rate in one tick. With equal start and end
///   rates the profile is a mirror image, to a tick.
/// - The top rate may change in the move, and the move may be held and resumed. A new profile then
///   begins from the present rate and acceleration, within the same jerk.
///
/// Range: that of [`Trapezoid`](crate::Trapezoid). In addition, the ramp from no acceleration to
/// the greatest takes fewer than 2^28 ticks; timers go up to 2^28 Hz and rates up to a quarter of
/// the timer's frequency. Where 6 f^3 / jerk exceeds 2^60 (a jerk below 170 000 steps/s^3 at 32
/// MHz) the profile counts in units of 2, 4, 8, ... ticks, and all bounds above are in these units.
/// Size: 128 bytes, because the limits are kept for a hold and a change of rate; an event touches
/// 64 bytes.
///
/// # Cost
/// One event, loop included, mean over a move of 2000 events at 1 MHz: 112 instructions on
/// Cortex-M4F and 426 on Cortex-M0. At 32 MHz with intervals of thousands of ticks: 133 and 509. A
/// Cortex-M0 does 64-bit products and divisions in software. The first events after standstill, and
/// those in which phases meet, take some additional Newton steps. Where the move is too short for
/// the top rate, set-up, hold and resume find the peak by bisection with two square roots per step:
/// at most 52 000 instructions on Cortex-M4F and 181 000 on Cortex-M0.
///
/// # Examples
/// ```
/// use husillo_planner::{Rates, SCurve};
///
/// let rates = Rates {
///     timer_hz: 1_000_000,
///     start_rate_hz: 0,
///     top_rate_hz: 200,
///     end_rate_hz: 0,
///     acceleration_hz_per_s: 5000,
/// };
/// let intervals: Vec<u32> = SCurve::new(&rates, 500_000, 12)?.collect();
/// let half = [24791, 8346, 6384, 5426, 5053, 5001];
/// assert_eq!(intervals[..6], half);
/// assert_eq!(intervals[6..], [5000, 5053, 5426, 6384, 8346, 24790]);
/// # Ok::<(), husillo_planner::RatesError>(())
/// ```
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct SCurve {
    /// Path to the next event after `step` was added, in sixths of the unit in which the jerk is 1.
    to_go: i64,
    /// Path between two events.
    step: i64,
    /// Path per tick: six times the rate.
    slope: i64,
    /// Excess of the slope over its mean at the end of the last interval. The next mean is expected
    /// to exceed the slope by the same amount.
    lead: i64,
    /// Three times the acceleration.
    bend: i32,
    /// -1, 0 or 1.
    jerk: i32,
    /// Ticks left in this phase.
    left: u32,
    /// Last interval in profile ticks.
    last: u32,
    /// Shift that brings 1.5 `step` below 2^31.
    scale: u8,
    /// A profile tick is 2^`tick_bits` timer ticks.
    tick_bits: u8,
    /// Index of the present phase: 0 removes a present acceleration, 1 to 7 are the seven phases, 8
    /// is beyond the end.
    phase: u8,
    is_holding: bool,
    remaining: u32,
    /// Events that follow after the stop of a hold.
    beyond: u32,
    phases: Phases,
    limits: Limits,
}

/// The limits from which new phases are made.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
struct Limits {
    timer_hz: u32,
    jerk_hz_per_s2: u32,
    most_jerk: u32,
    top_w: u64,
    end_w: u64,
}

impl Limits {
    /// Twice the rate in units of jerk and profile tick: 2 v f^2 / j, rounded down.
    fn doubled(&self, rate_hz: u32, tick_bits: u8) -> u64 {
        // f <= 2^28: v f^2 < 2^88.
        let f = u128::from(self.timer_hz);
        let product = f
            .wrapping_mul(f)
            .wrapping_mul(rate_hz.into())
            .wrapping_mul(2);
        divide(product, self.jerk_hz_per_s2)
            .wrapping_shr(u32::from(tick_bits).wrapping_mul(2))
            .min(1 << 62) as u64
    }
}

/// The least path of an event in units of jerk and profile tick, and the halvings of the timer that
/// make a profile tick.
#[inline]
fn resolution(timer_hz: u32, jerk_hz_per_s2: u32) -> (u128, u32) {
    // 6 f^3 / j rounded up: below 2^87.
    let f = u128::from(timer_hz);
    let cube = divide(
        f.wrapping_mul(f).wrapping_mul(f).wrapping_mul(6),
        jerk_hz_per_s2,
    );
    // At most 2^60 after this many halvings of f.
    let excess = (128_u32 - 60).saturating_sub(cube.leading_zeros());
    let tick_bits = excess.wrapping_add(2).checked_div(3).unwrap_or(0);
    let least_step = cube.wrapping_shr(tick_bits.wrapping_mul(3)).wrapping_add(1);
    (least_step, tick_bits)
}

impl SCurve {
    /// Creates the profile of a move of `events` events. A start rate above the top rate falls to
    /// it at once.
    ///
    /// # Errors
    /// See [`RatesError`]. An end rate too high to be reached is not an error.
    pub fn new(rates: &Rates, jerk_hz_per_s2: u32, events: u32) -> Result<SCurve, RatesError> {
        rates.check()?;
        if jerk_hz_per_s2 == 0 {
            return Err(RatesError::Zero);
        }
        let fastest = rates
            .start_rate_hz
            .max(rates.top_rate_hz)
            .max(rates.end_rate_hz);
        if rates.timer_hz >> 28 != 0 {
            return Err(RatesError::TimerOutOfRange);
        }
        let (least_step, tick_bits) = resolution(rates.timer_hz, jerk_hz_per_s2);
        if fastest > rates.timer_hz.wrapping_shr(tick_bits.wrapping_add(2)) {
            return Err(RatesError::TimerOutOfRange);
        }
        let tick_bits = tick_bits as u8;
        let most_jerk = u64::from(rates.timer_hz)
            .wrapping_mul(rates.acceleration_hz_per_s.into())
            .checked_div(jerk_hz_per_s2.into())
            .unwrap_or(0)
            .wrapping_shr(tick_bits.into());
        if most_jerk >> 28 != 0 {
            return Err(RatesError::RampTooLong);
        }
        if most_jerk == 0 {
            // The acceleration would be reached within one tick, which exceeds the requested jerk.
            return Err(RatesError::TimerOutOfRange);
        }
        let mut limits = Limits {
            timer_hz: rates.timer_hz,
            jerk_hz_per_s2,
            most_jerk: most_jerk as u32,
            top_w: 0,
            end_w: 0,
        };
        limits.top_w = limits.doubled(rates.top_rate_hz, tick_bits);
        if limits.top_w < 2 {
            // The top rate would be reached within one tick.
            return Err(RatesError::TimerOutOfRange);
        }
        limits.end_w = limits.doubled(rates.end_rate_hz, tick_bits);
        let course = Course {
            w: limits.doubled(rates.start_rate_hz, tick_bits),
            acceleration: 0,
            top_w: limits.top_w,
            end_w: limits.end_w,
            most_jerk: limits.most_jerk,
        };
        let (phases, path) = course
            .phases(least_step.wrapping_mul(events.into()), true)
            .ok_or(RatesError::TooShort)?;
        // The path is longer than requested, by less than the path of a tick, so that it ends with
        // the last event. Rounded up: a last event beyond the end is made at the end. An event
        // before the end would be early by the cube root of the rounding.
        let step = divide(path.wrapping_add(events.into()).saturating_sub(1), events);
        let step = step.max(least_step).min(1 << 61) as i64;
        let half_more = step.wrapping_add(step >> 1);
        let mut profile = SCurve {
            to_go: 0,
            step,
            // w < 2^62 / 3, because the rate is below a quarter of a step per tick.
            slope: course.w.wrapping_mul(3) as i64,
            lead: 0,
            bend: 0,
            jerk: 0,
            left: 0,
            last: 0,
            scale: 33_u32.saturating_sub(half_more.leading_zeros()) as u8,
            tick_bits,
            phase: 0,
            is_holding: false,
            remaining: events,
            beyond: 0,
            phases,
            limits,
        };
        profile.begin(phases);
        Ok(profile)
    }

    /// Events still to come in the whole move. [`len`](ExactSizeIterator::len) counts only those
    /// before the next stop.
    pub const fn remaining(&self) -> u32 {
        // The sum is at most the number of events given to `new`.
        self.remaining.wrapping_add(self.beyond)
    }

    /// Changes the top rate from the next event on (feed override). The present acceleration
    /// vanishes first, then the rate changes; both within the same jerk. Returns `false` where no
    /// room is left for this before the end; the profile then stays unchanged.
    ///
    /// # Errors
    /// [`RatesError::Zero`] and [`RatesError::TimerOutOfRange`]; the profile then stays unchanged.
    pub fn set_top_rate(&mut self, top_rate_hz: u32) -> Result<bool, RatesError> {
        if top_rate_hz == 0 {
            return Err(RatesError::Zero);
        }
        if top_rate_hz
            > self
                .limits
                .timer_hz
                .wrapping_shr(u32::from(self.tick_bits).wrapping_add(2))
        {
            return Err(RatesError::TimerOutOfRange);
        }
        let before = self.limits.top_w;
        let top_w = self.limits.doubled(top_rate_hz, self.tick_bits);
        if top_w < 2 {
            return Err(RatesError::TimerOutOfRange);
        }
        self.limits.top_w = top_w;
        let is_done = self.is_holding || self.look_again(self.remaining, self.limits.end_w);
        if !is_done {
            self.limits.top_w = before;
        }
        Ok(is_done)
    }

    /// Slows down to standstill from the next event on. Returns the number of events to the stop.
    /// The iterator ends at the stop, and the rest of the move is [`remaining`](SCurve::remaining).
    /// Returns `None` and changes nothing where the move ends before a stop is possible; hold the
    /// next move then.
    pub fn hold(&mut self) -> Option<u32> {
        if self.is_holding {
            return Some(self.remaining);
        }
        if self.remaining == 0 {
            return None;
        }
        let path = self.course(0).shortest()?;
        // Number of events in that path, rounded up; to_go is within the path of one tick.
        let path = path.saturating_add_signed(i128::from(self.to_go).wrapping_neg());
        let step = self.step.unsigned_abs();
        let stop = quotient(
            path.wrapping_add(u128::from(step)).wrapping_sub(1),
            step.into(),
        );
        let stop = u32::try_from(stop)
            .ok()
            .filter(|stop| *stop <= self.remaining)?;
        if stop != 0 && !self.look_again(stop, 0) {
            return None;
        }
        self.beyond = self.remaining.wrapping_sub(stop);
        self.remaining = stop;
        self.is_holding = true;
        Some(stop)
    }

    /// Ends a hold: the move continues from its present rate. Returns `false` where a hold near its
    /// stop at the end of the move leaves no room for new phases. Resume it again when it [is
    /// held](SCurve::is_held).
    pub fn resume(&mut self) -> bool {
        if !self.is_holding {
            return true;
        }
        if self.remaining == 0 {
            self.stand();
        }
        let all = self.remaining();
        if all != 0 && !self.look_again(all, self.limits.end_w) {
            return false;
        }
        self.remaining = all;
        self.beyond = 0;
        self.is_holding = false;
        true
    }

    /// Changes the number of events to come, from the next event on: another goal in the same
    /// direction. The present acceleration vanishes first, within the same jerk, and a hold ends.
    /// Returns `false` where the events are too few for this; the profile then stays unchanged.
    ///
    /// # Cost
    /// That of [`new`](SCurve::new).
    pub fn set_remaining(&mut self, events: u32) -> bool {
        if events == 0 {
            return self.remaining == 0;
        }
        if self.remaining == 0 && (self.is_holding || self.limits.end_w == 0) {
            self.stand();
        }
        if !self.look_again(events, self.limits.end_w) {
            return false;
        }
        self.remaining = events;
        self.beyond = 0;
        self.is_holding = false;
        true
    }

    /// The present rate in Hz, rounded down.
    pub fn rate_hz(&self) -> u32 {
        // w = 2 v f^2 / j, in profile ticks: w < 2^62, j < 2^32, two tick bits per timer bit.
        let w = u128::from(self.slope.max(0).unsigned_abs()).wrapping_shl(self.tick_bits.into());
        let f = u128::from(self.limits.timer_hz);
        let double = w
            .wrapping_shl(self.tick_bits.into())
            .wrapping_mul(self.limits.jerk_hz_per_s2.into());
        quotient(double, f.wrapping_mul(f).wrapping_mul(6)).min(u32::MAX.into()) as u32
    }

    /// Whether a hold has reached its stop.
    pub const fn is_held(&self) -> bool {
        self.is_holding && self.remaining == 0
    }

    fn course(&self, end_w: u64) -> Course {
        Course {
            w: self.slope.checked_div(3).unwrap_or(0).max(0) as u64,
            acceleration: self.bend.checked_div(3).unwrap_or(0),
            top_w: self.limits.top_w,
            end_w,
            most_jerk: self.limits.most_jerk,
        }
    }

    /// Makes new phases from here to the end of `events` events; returns whether there is room for
    /// them.
    fn look_again(&mut self, events: u32, end_w: u64) -> bool {
        let room = i128::from(self.step)
            .wrapping_mul(events.into())
            .wrapping_add(self.to_go.into());
        let phases = self.course(end_w).phases(room.max(0).unsigned_abs(), false);
        if let Some((phases, _)) = phases {
            self.begin(phases);
        }
        phases.is_some()
    }

    /// Clears the remainder of the rate at the end of a hold.
    fn stand(&mut self) {
        self.slope = 0;
        self.bend = 0;
        self.to_go = 0;
    }

    fn begin(&mut self, phases: Phases) {
        self.phases = phases;
        self.phase = 0;
        self.jerk = self.bend.signum().wrapping_neg();
        self.left = phases.settle;
        // Without a guess the next event is searched.
        self.lead = 0;
        self.last = 0;
    }

    /// Goes on to the next phase; returns `false` at the end.
    fn go_on(&mut self) -> bool {
        let Phases {
            first,
            is_first_down,
            last,
            ..
        } = self.phases;
        let up = if is_first_down { -1 } else { 1 };
        if self.phase == 4 && self.phases.level != 0 {
            // The cruise is split into pieces that fit in 32 bits.
            self.left = self.phases.level.min(1 << 29) as u32;
            self.phases.level = self.phases.level.wrapping_sub(self.left.into());
            return true;
        }
        self.phase = self.phase.saturating_add(1).min(8);
        let parts = |bend: Bend| (bend.jerk, bend.steady);
        (self.jerk, self.left) = match self.phase {
            1 => (up, parts(first).0),
            2 => (0, parts(first).1),
            3 => (-up, parts(first).0),
            4 => (0, 0),
            5 => (-1, parts(last).0),
            6 => (0, parts(last).1),
            7 => (1, parts(last).0),
            _ => (0, 0),
        };
        self.phase != 8
    }

    /// Advances by `ticks` within the present phase; negative numbers go back.
    #[inline]
    fn advance(&mut self, ticks: i32) {
        // |ticks| < 2^30 and |bend| <= 3 2^28 at both ends, so sums fit in 32 bits. The path fits
        // in 63 bits, because slopes are below a quarter of a step.
        let change = self.jerk.wrapping_mul(ticks);
        let mean = i64::from(ticks)
            .wrapping_mul(self.bend.wrapping_add(change).into())
            .wrapping_add(self.slope);
        self.to_go = self.to_go.wrapping_sub(mean.wrapping_mul(ticks.into()));
        let three = change.wrapping_mul(3);
        let steep = self.bend.wrapping_mul(2).wrapping_add(three);
        self.slope = self
            .slope
            .wrapping_add(i64::from(ticks).wrapping_mul(steep.into()));
        self.lead = self.slope.wrapping_sub(mean);
        self.bend = self.bend.wrapping_add(three);
        self.left = self.left.wrapping_sub(ticks as u32);
    }

    /// Whether the event is at this tick: within 9/16 of a tick.
    #[inline]
    fn is_there(&self) -> bool {
        let most = (self.slope >> 1).wrapping_add(self.slope >> 4);
        self.to_go.wrapping_add(most) as u64 <= most.wrapping_mul(2) as u64
    }

    /// Finds the event by bracketed Newton steps, phase by phase. `ticks` of its interval have
    /// already passed in this phase.
    #[inline(never)]
    fn seek(&mut self, ticks: u32, guess: u32) -> u32 {
        // Ticks since the last event or since the start of this phase. The event is after `low`
        // and, once `high` is known, at or before `high`.
        let (mut at, mut low, mut high, mut sum) = (ticks, 0_u32, None::<u32>, 0_u32);
        let mut guess = guess;
        // Newton steps are few. Halving 2^30 ticks takes 30 steps, and there are 8 phases and the
        // pieces of the cruise.
        for _ in 0..400 {
            if self.is_there() && at.wrapping_add(sum) != 0 {
                break;
            }
            if self.to_go > 0 {
                low = at;
                if self.left == 0 {
                    if !self.go_on() {
                        // Rounding ends the path slightly before the last event.
                        self.to_go = 0;
                        break;
                    }
                    sum = sum.wrapping_add(at);
                    (at, low, high) = (0, 0, None);
                    continue;
                }
            } else {
                high = Some(at);
            }
            // Both are below 2^30 ticks.
            let last = high.unwrap_or(at.saturating_add(self.left));
            let step = if guess != 0 {
                i64::from(guess)
            } else {
                self.to_go.checked_div(self.slope).unwrap_or(i64::MAX)
            };
            guess = 0;
            let target = i64::from(at).saturating_add(step);
            let target = if high.is_some() {
                if last.wrapping_sub(low) <= 1 {
                    // The event lies between two neighbouring ticks; the second one is taken.
                    self.advance(last.wrapping_sub(at) as i32);
                    at = last;
                    break;
                }
                if target <= i64::from(low) || target >= i64::from(last) {
                    i64::from(low.wrapping_add(last) >> 1)
                } else {
                    target
                }
            } else {
                target.max(i64::from(low).wrapping_add(1)).min(last.into())
            };
            // Forward or back by less than 2^30 ticks.
            let change = self.short_enough(target.wrapping_sub(at.into()));
            self.advance(change);
            at = at.wrapping_add_signed(change);
        }
        let ticks = sum.wrapping_add(at).min(1 << 29);
        let change = self.jerk.wrapping_mul(ticks as i32);
        self.lead = i64::from(ticks).wrapping_mul(self.bend.wrapping_add(change).into());
        sum.wrapping_add(at)
    }

    /// Halves `ticks` until the path in them stays below 4 steps.
    fn short_enough(&self, ticks: i64) -> i32 {
        let mut ticks = ticks as i32;
        while ticks > 1 {
            let mean = i64::from(ticks)
                .wrapping_mul(self.bend.wrapping_add(self.jerk.wrapping_mul(ticks)).into())
                .wrapping_add(self.slope);
            match mean.checked_mul(ticks.into()) {
                Some(path) if path >> 2 <= self.step => break,
                _ => ticks >>= 1,
            }
        }
        ticks
    }
}

impl Iterator for SCurve {
    type Item = u32;

    #[inline]
    fn next(&mut self) -> Option<u32> {
        self.remaining = self.remaining.checked_sub(1)?;
        self.to_go = self.to_go.wrapping_add(self.step);
        let mean = self.slope.wrapping_add(self.lead);
        // Both are below 2^31. If not, the ticks are wrong; the event is then not found here and is
        // searched.
        let divisor = shifted(mean, self.scale);
        let dividend = shifted(self.to_go, self.scale);
        let ticks = dividend
            .wrapping_add(divisor >> 1)
            .checked_div(divisor)
            .unwrap_or(0);
        // A path that grows with the cube of time stays below 4 steps, and fits, if the interval
        // grows by at most half.
        let most = self.last.wrapping_add(self.last >> 1).min(self.left);
        let ticks = if ticks < most {
            self.advance(ticks as i32);
            if self.is_there() {
                ticks
            } else {
                self.seek(ticks, 0)
            }
        } else {
            self.seek(0, ticks)
        };
        self.last = ticks;
        Some(ticks.wrapping_shl(self.tick_bits.into()))
    }

    fn size_hint(&self) -> (usize, Option<usize>) {
        let len = self.remaining as usize;
        (len, Some(len))
    }
}

impl ExactSizeIterator for SCurve {}

/// 32 bits of `value` from bit `low` (below 32) on. The halves are shifted separately, because a
/// shift of 64 bits takes twice as long.
#[inline]
fn shifted(value: i64, low: u8) -> u32 {
    let high = (value >> 32) as u32;
    let up = 31_u32.wrapping_sub(low.into());
    (value as u32).wrapping_shr(low.into()) | high.wrapping_mul(2).wrapping_shl(up)
}
