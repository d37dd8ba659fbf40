//! Jerk-limited motion.

use crate::phases::{Bend, Course, Phases};
use crate::rates::{Rates, RatesError};
use crate::wide::{divide, quotient};

/// Ticks before each event of a move whose acceleration itself changes at a constant jerk: seven
/// phases.
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
/// The phases last whole ticks, so that rate, acceleration and path are integers at every tick (in
/// units in which the jerk is 1); the events are those of this path, each at the nearest tick.
/// Phases that a short move has no room for fall away: the cruise, and the constant acceleration.
///
/// - As many events as asked for, always; [`len`](ExactSizeIterator::len) is right. The last one falls on the end of phase 7.
/// - Every event is within 0.6 ticks of the profile, every interval within 1.2; nothing drifts.
/// - The limits are those of the profile: rates, acceleration and jerk are never above what was asked for, start and end rate
///   within what the acceleration changes in one tick. With equal start and end rates it is a mirror image, to a tick.
/// - The top rate may change on the way and the move may be held and resumed: from the present rate and acceleration a new profile
///   begins, within the same jerk.
///
/// Range: as [`Trapezoid`](crate::Trapezoid); the ramp from no acceleration to the greatest below
/// 2^28 ticks; timers up to 2^28 Hz, rates up to a quarter of the timer's. Where 6 f^3 / jerk
/// exceeds 2^60 (jerk below 170 000 steps/s^3 at 32 MHz) the profile counts in 2, 4, 8.. ticks and
/// so do all bounds above. Size: 128 bytes, because it keeps its limits for a hold and a change of
/// rate; an event touches 64. Cost of an event, loop included: 112 instructions on Cortex-M4F and
/// 426 on Cortex-M0, mean of a move of 2000 events at 1 MHz (133 and 509 at 32 MHz and intervals of
/// thousands of ticks); a Cortex-M0 has 64-bit products and division in software. The first events
/// after standstill, and those in which phases meet, take some Newton steps more; set-up, hold and
/// resume search the peak by halves, with two square roots a half, where the move is too short for
/// the top rate: 52 000 instructions on Cortex-M4F, 181 000 on Cortex-M0 at most.
///
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
/// assert_eq!(intervals, [24791, 8346, 6384, 5426, 5053, 5001, 5000, 5053, 5426, 6384, 8346, 24790]);
/// # Ok::<(), husillo_planner::RatesError>(())
/// ```
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct SCurve {
    /// Path to the next event after `step` was added: in sixths of the unit in which the jerk is 1.
    to_go: i64,
    /// Path from event to event.
    step: i64,
    /// Six times the rate: path a tick.
    slope: i64,
    /// How much the slope was above its mean when the last interval ended: so much will the next
    /// mean be above it.
    lead: i64,
    /// Three times the acceleration.
    bend: i32,
    /// -1, 0 or 1.
    jerk: i32,
    /// Ticks left of this phase.
    left: u32,
    /// The last interval in profile ticks.
    last: u32,
    /// Bits that bring `step` and a half below 2^31.
    scale: u8,
    /// A profile tick is 2 to this timer ticks.
    tick_bits: u8,
    /// Index of the present phase: 0 settles a present acceleration, 1 to 7 are the seven, 8 is
    /// past the end.
    phase: u8,
    is_holding: bool,
    remaining: u32,
    /// Events after the stop of a hold.
    beyond: u32,
    phases: Phases,
    limits: Limits,
}

/// What new phases are made from.
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

impl SCurve {
    /// The profile of a move of so many events.
    ///
    /// # Errors
    /// See [`RatesError`]. An end rate too high to be reached is not an error; a start rate above
    /// the top rate is taken down to it at once.
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
        // 6 f^3 / j rounded up: below 2^87.
        let f = u128::from(rates.timer_hz);
        let cube = divide(
            f.wrapping_mul(f).wrapping_mul(f).wrapping_mul(6),
            jerk_hz_per_s2,
        );
        // At most 2^60 after this many halvings of f.
        let excess = (128_u32 - 60).saturating_sub(cube.leading_zeros());
        let tick_bits = excess.wrapping_add(2).checked_div(3).unwrap_or(0);
        let least_step = cube.wrapping_shr(tick_bits.wrapping_mul(3)).wrapping_add(1);
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
            // The acceleration is there within a tick: more than asked for.
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
            // The top rate is there within a tick.
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
        // So much longer than asked for, by less than a tick, that the path ends with the last
        // event. Rounded up: a last event beyond the end is made there; one before it would be
        // early by the cube root of the rounding.
        let step = divide(path.wrapping_add(events.into()).saturating_sub(1), events);
        let step = step.max(least_step).min(1 << 61) as i64;
        let half_more = step.wrapping_add(step >> 1);
        let mut profile = SCurve {
            to_go: 0,
            step,
            // w < 2^62 / 3: the rate is below a quarter of a step a tick.
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

    /// Events still to come in the whole move; [`len`](ExactSizeIterator::len) has those before the
    /// next stop.
    pub const fn remaining(&self) -> u32 {
        // Their sum is at most what `new` was given.
        self.remaining.wrapping_add(self.beyond)
    }

    /// Changes the top rate from the next event on (feed override): first the present acceleration
    /// goes, then the rate changes, within the same jerk. `false` where there is no room left for
    /// that before the end: the profile stays as it is.
    ///
    /// # Errors
    /// [`RatesError::Zero`] and [`RatesError::TimerOutOfRange`]; nothing has changed then.
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

    /// Slows down to standstill from the next event on and gives the events to the stop; the
    /// iterator then ends there, with the rest of the move [`remaining`](SCurve::remaining).
    /// Nothing changes and it is `None` where the end of the move comes before a stop: hold the
    /// next move.
    pub fn hold(&mut self) -> Option<u32> {
        if self.is_holding {
            return Some(self.remaining);
        }
        if self.remaining == 0 {
            return None;
        }
        let path = self.course(0).shortest()?;
        // Events that far away, rounded up; to_go is within one tick's path.
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

    /// Ends a hold: the move goes on from its present rate. `false` where a hold is too near its
    /// stop at the end of the move for new phases: resume it again when it [is
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

    /// Whether a hold has come to its stop.
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

    /// New phases from here to the end of so many events, if there is room for them.
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

    /// What is left of a rate at the end of a hold is none.
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
        // No guess: the next event is sought.
        self.lead = 0;
        self.last = 0;
    }

    /// Goes on to the next phase; `false` at the end.
    fn go_on(&mut self) -> bool {
        let Phases {
            first,
            is_first_down,
            last,
            ..
        } = self.phases;
        let up = if is_first_down { -1 } else { 1 };
        if self.phase == 4 && self.phases.level != 0 {
            // The cruise in pieces that 32 bits hold.
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

    /// So many ticks on in the present phase, or back.
    #[inline]
    fn advance(&mut self, ticks: i32) {
        // |ticks| < 2^30, |bend| <= 3 2^28 at both ends: sums fit 32 bits. The path fits 63 bits, as slopes are below a
        // quarter of a step.
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

    /// Finds the event by Newton steps in brackets, phase by phase; `ticks` of its interval have
    /// passed in this phase.
    #[inline(never)]
    fn seek(&mut self, ticks: u32, guess: u32) -> u32 {
        // Ticks since the event before or since this phase began; the event is after `low` and,
        // once known, at or before `high`.
        let (mut at, mut low, mut high, mut sum) = (ticks, 0_u32, None::<u32>, 0_u32);
        let mut guess = guess;
        // Newton steps are few; halving 2^30 ticks takes 30, and there are 8 phases and pieces of
        // the cruise.
        for _ in 0..400 {
            if self.is_there() && at.wrapping_add(sum) != 0 {
                break;
            }
            if self.to_go > 0 {
                low = at;
                if self.left == 0 {
                    if !self.go_on() {
                        // The path ends here, a rounding short of the last event.
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
            // Both below 2^30 ticks.
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
                    // Two ticks and the event between them: the second.
                    self.advance(last.wrapping_sub(at) as i32);
                    at = last;
                    break;
                }
                if target <= low.into() || target >= last.into() {
                    i64::from(low.wrapping_add(last) >> 1)
                } else {
                    target
                }
            } else {
                target.max(i64::from(low).wrapping_add(1)).min(last.into())
            };
            // Forward or back by less than 2^30.
            let change = self.short_enough(target.wrapping_sub(at.into()));
            self.advance(change);
            at = at.wrapping_add_signed(change);
        }
        let ticks = sum.wrapping_add(at).min(1 << 29);
        let change = self.jerk.wrapping_mul(ticks as i32);
        self.lead = i64::from(ticks).wrapping_mul(self.bend.wrapping_add(change).into());
        sum.wrapping_add(at)
    }

    /// The most of these ticks, halved until it does, in which the path stays below 4 steps.
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
        // Both are below 2^31, or the ticks wrong: then the event is not there and is sought.
        let divisor = shifted(mean, self.scale);
        let dividend = shifted(self.to_go, self.scale);
        let ticks = dividend
            .wrapping_add(divisor >> 1)
            .checked_div(divisor)
            .unwrap_or(0);
        // A path that grows with the cube of time is below 4 steps, and fits, if the interval grows
        // by half at most.
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

/// 32 bits of `value` from bit `low` on, which is below 32. Both halves by themselves: a shift of
/// 64 bits takes twice as long.
#[inline]
fn shifted(value: i64, low: u8) -> u32 {
    let high = (value >> 32) as u32;
    let up = 31_u32.wrapping_sub(low.into());
    (value as u32).wrapping_shr(low.into()) | high.wrapping_mul(2).wrapping_shl(up)
}
