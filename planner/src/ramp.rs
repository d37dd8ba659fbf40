//! Timing of the events of the executing move.

use crate::{
    Limits, Stretch, Timer,
    quotient::quotient,
    rate::{Rate, unit},
    stretch::square,
};

/// Path speed from event to event, as high as the top speed, the acceleration and the end of the
/// move allow.
///
/// The state is the square of the speed, which changes by at most 2 a ds over an event of the
/// length ds. The speed is carried from move to move, and so is the fraction of a tick, whichever
/// move the next event belongs to. At constant speed the times add up to exactly the programmed
/// ones. On a ramp, speeds are rounded down to whole nm/s.
///
/// # Cost
/// An event on a ramp takes a square root and a division of 64 bits; an event at constant speed
/// takes neither.
///
/// # Examples
/// ```
/// use husillo_planner::{LookAhead, Ramp, Stretch};
///
/// let stretch = Stretch {
///     length_nm: 100_000, // 100 steps of 1 um
///     top_nm_per_s: 1_000_000,
///     ceiling_nm_per_s: 1_000_000,
///     obeys_override: true,
///     acceleration_nm_per_s2: 50_000_000,
///     start_nm_per_s: 0,
///     entry_limit_nm_per_s: 0,
/// };
/// let mut moves = LookAhead::<(), 8>::new();
/// moves.push(stretch, ()).unwrap();
/// let mut ramp = Ramp::new(1_000_000);
/// // At 1 mm/s the whole move takes 100 000 us.
/// ramp.begin(&stretch, 100, 1, 100_000 << 16);
/// let waits: Vec<u64> = (0..100).map_while(|_| ramp.wait(1, moves.limits())).collect();
/// assert_eq!(waits[0], 6_324); // sqrt(2 ds / a)
/// assert_eq!(waits[50], 1_000);
/// assert!(waits[99].abs_diff(6_324) <= 1);
/// ```
#[derive(Clone, Debug)]
pub struct Ramp {
    timer_hz: u32,
    /// Square of the present speed, and the speed.
    squared: u64,
    speed: u32,
    is_held: bool,
    /// Fraction of a tick carried to the next event, times 2^64.
    owed: u64,
    /// 2 a ds per unit of sweep in (nm/s)^2, and the carried fraction of it.
    gain: Rate,
    gain_owed: u64,
    /// 2 a s for the rest of the move.
    remaining: u128,
    /// 2 ds f per unit of sweep: ticks times the sum of the speeds before and after.
    passage: Rate,
    /// Timer of the events at top speed.
    cruise: Timer,
    cruise_shift: u8,
    /// Sweep that may pass at top speed without any further check, as long as the exit limit does
    /// not fall below the one it was computed with. `cruised` is the sweep already passed
    /// and not yet subtracted from `remaining`.
    cruise_left: u64,
    cruise_exit: u64,
    cruised: u64,
    top: u32,
    top_squared: u64,
    /// Square of the speed that needs no ramp.
    floor: u64,
    /// Values of the move as begun, kept for another top speed.
    programmed_top: u32,
    start: u32,
    /// Square of the speed from which the speed may fall to any lower one at once: the start speed
    /// of the move of the last event.
    drop: u64,
    cruise_ticks_q16: u64,
    total_sweep: u64,
    largest_sweep: u32,
}

impl Ramp {
    /// Creates a ramp at standstill. Waits are in ticks of `timer_hz`.
    pub fn new(timer_hz: u32) -> Ramp {
        Ramp {
            timer_hz,
            squared: 0,
            speed: 0,
            is_held: false,
            owed: 0,
            gain: Rate::default(),
            gain_owed: 0,
            remaining: 0,
            passage: Rate::default(),
            cruise: Timer::new(0, 1, 1),
            cruise_shift: 1,
            cruise_left: 0,
            cruise_exit: 0,
            cruised: 0,
            top: 0,
            top_squared: 0,
            floor: 0,
            programmed_top: 1,
            start: 0,
            drop: 0,
            cruise_ticks_q16: 0,
            total_sweep: 1,
            largest_sweep: 1,
        }
    }

    /// Begins a move at the speed with which the one before ended.
    ///
    /// `total_sweep` is the sum over all events of the move, `largest_sweep` that of the largest
    /// event. `cruise_ticks_q16` is the time of the whole move at `top_nm_per_s` in ticks times
    /// 2^16; it carries the exact programmed feed. A move without events is begun with a sweep of 1
    /// and waited for once; its ticks are carried to the next event.
    ///
    /// # Cost
    /// About ten divisions of 64 bits.
    pub fn begin(
        &mut self,
        stretch: &Stretch,
        total_sweep: u64,
        largest_sweep: u32,
        cruise_ticks_q16: u64,
    ) {
        let total_sweep = total_sweep.max(1);
        self.total_sweep = total_sweep;
        self.largest_sweep = largest_sweep;
        self.cruise_ticks_q16 = cruise_ticks_q16;
        self.programmed_top = stretch.top_nm_per_s.max(1);
        self.start = stretch.start_nm_per_s;
        let (length, length_bits) = unit(stretch.length(), total_sweep);
        // Rounded up, so that braking over the whole move takes no more than the look-ahead
        // assumes.
        self.gain = Rate::new(
            length,
            stretch.double_acceleration(),
            length_bits,
            largest_sweep,
        )
        .up();
        self.gain_owed = 0;
        self.remaining = stretch.gain();
        self.cruised = 0;
        let double_hz = u64::from(self.timer_hz).wrapping_mul(2);
        self.passage = Rate::new(length, double_hz, length_bits, largest_sweep);
        // Only a start speed brings a ramp above the limit of a junction; from there the speed may
        // fall at once.
        let entry = square(stretch.entry_limit_nm_per_s);
        if self.squared > entry {
            self.set_squared(entry);
        }
        // 0 is no top speed: the next event sets the one that holds then.
        self.top = 0;
    }

    /// Returns the ticks to wait before an event of this `sweep`, which is at most the largest one.
    ///
    /// `limits` are those of [`LookAhead::limits`](crate::LookAhead::limits) at this moment.
    /// Returns `None` when a hold has stopped the path. The event did not happen then; ask again
    /// after [`Ramp::resume`].
    #[inline]
    pub fn wait(&mut self, sweep: u32, limits: Limits) -> Option<u64> {
        let sweep_units = u64::from(sweep);
        if sweep_units <= self.cruise_left
            && limits.top_nm_per_s == self.top
            && limits.exit_squared >= self.cruise_exit
        {
            self.cruise_left = self.cruise_left.wrapping_sub(sweep_units);
            self.cruised = self.cruised.wrapping_add(sweep_units);
            let time = self.cruise.product(sweep_units);
            return Some(self.settle(time, self.cruise_shift));
        }
        self.wait_with_care(sweep, limits)
    }

    /// An event that may change the speed, or one of the first events at a constant speed.
    fn wait_with_care(&mut self, sweep: u32, limits: Limits) -> Option<u64> {
        if limits.top_nm_per_s != self.top {
            self.set_top(limits.top_nm_per_s);
        }
        self.cruise_left = 0;
        if self.cruised != 0 {
            self.settle_cruise();
        }
        // The product is at most 2^62 plus a sweep, the carried part is below 2^63.
        let gain = self.gain.times(sweep).wrapping_add(self.gain_owed);
        let (gain, gain_owed) = self.gain.split(gain);
        let remaining = self.remaining.saturating_sub(gain.into());
        let end = u64::try_from(remaining)
            .unwrap_or(u64::MAX)
            .saturating_add(limits.exit_squared);
        let before = self.squared.max(self.floor);
        let top = if self.is_held { 0 } else { self.top_squared };
        // One more than the gain, so that rounding does not keep it from braking to the end.
        let least = before.saturating_sub(gain.saturating_add(1));
        let after = before.saturating_add(gain).min(top).min(end).max(least);
        if self.is_held && after <= self.floor {
            self.set_squared(0);
            return None;
        }
        self.gain_owed = gain_owed;
        self.remaining = remaining;
        let after = after.max(self.floor);
        if before == self.top_squared && after == before {
            self.squared = after;
            self.speed = self.top;
            self.plan_cruise(end, limits.exit_squared);
            let time = self.cruise.product(sweep.into());
            return Some(self.settle(time, self.cruise_shift));
        }
        let speed_before = if before == self.squared {
            self.speed
        } else {
            root(before)
        };
        let speed_after = if after == self.top_squared {
            self.top
        } else if after == before {
            speed_before
        } else {
            root(after)
        };
        self.squared = after;
        self.speed = speed_after;
        let mut speeds = u64::from(speed_before).wrapping_add(speed_after.into());
        if before.saturating_add(after) < gain / 2 {
            // The event starts and ends nearly at rest. The speed rises and falls within it: the
            // mean is half of the peak sqrt(a ds), which is the root of half the gain.
            let peak = u64::from(root(gain / 2)).min(u64::from(self.top).wrapping_mul(2));
            speeds = speeds.max(peak).max(1);
        }
        let mut time = self.passage.times(sweep);
        let divisor = u32::try_from(speeds).unwrap_or_else(|_| {
            // 33 bits: above 2 m/s the last bit does not matter.
            time >>= 1;
            (speeds >> 1) as u32
        });
        let time = quotient(time, divisor);
        Some(self.settle(time, self.passage.fraction_bits()))
    }

    /// Computes how far the path may cruise if after this event the square of the speed must not
    /// exceed `end`.
    ///
    /// The distance is a power of two of events: that needs no division, only a few more checks on
    /// the way to the end.
    fn plan_cruise(&mut self, end: u64, exit_squared: u64) {
        let spare = end.saturating_sub(self.top_squared);
        let (gain, _) = self.gain.split(self.gain.times(self.largest_sweep));
        // spare / 2^bits(gain + 1) events of the largest sweep gain less than `spare`.
        let bits = 64_u32.wrapping_sub(gain.saturating_add(1).leading_zeros());
        let events = spare.checked_shr(bits).unwrap_or(0);
        self.cruise_left = events.saturating_mul(self.largest_sweep.into());
        self.cruise_exit = exit_squared;
    }

    /// Subtracts the sweep passed at top speed from the rest of the move.
    fn settle_cruise(&mut self) {
        // The factors have 62 and 64 bits.
        let product = self
            .gain
            .times_long(self.cruised)
            .wrapping_add(self.gain_owed.into());
        let (gain, owed) = self.gain.split_long(product);
        self.remaining = self.remaining.saturating_sub(gain);
        self.gain_owed = owed;
        self.cruised = 0;
    }

    /// Feed hold: the path brakes from the next event on, through as many moves as necessary.
    pub fn hold(&mut self) {
        self.is_held = true;
        self.cruise_left = 0;
    }

    /// Ends a hold, even if it has not yet stopped the path.
    pub fn resume(&mut self) {
        self.is_held = false;
    }

    /// Whether a hold is active.
    pub const fn is_held(&self) -> bool {
        self.is_held
    }

    /// Sets the speed to 0, after a dwell, a take-up or an abort. The next event starts from rest.
    pub fn stop(&mut self) {
        self.set_squared(0);
    }

    /// Path speed after the last event in nm/s, rounded down.
    pub const fn speed_nm_per_s(&self) -> u32 {
        self.speed
    }

    /// Whole ticks of a time with this many fraction bits (1 to 63); the remainder is carried.
    fn settle(&mut self, time: u64, fraction_bits: u8) -> u64 {
        let bits = u32::from(fraction_bits);
        let fraction = time.wrapping_shl(64_u32.wrapping_sub(bits));
        let (owed, carries) = self.owed.overflowing_add(fraction);
        self.owed = owed;
        // At most 2^63: a carry fits.
        time.wrapping_shr(bits).wrapping_add(carries.into())
    }

    fn set_squared(&mut self, squared: u64) {
        self.squared = squared;
        self.speed = root(squared);
        self.cruise_left = 0;
    }

    /// Sets another top speed: the cruise takes the programmed time in proportion.
    #[cold]
    fn set_top(&mut self, top: u32) {
        let top = top.max(1);
        self.cruise_left = 0;
        self.top = top;
        self.top_squared = square(top);
        self.floor = square(self.start.min(top));
        if self.squared <= self.drop && self.squared > self.top_squared {
            self.set_squared(self.top_squared);
        }
        self.drop = square(self.start);
        let ticks = scale(self.cruise_ticks_q16, self.programmed_top, top);
        self.cruise = Timer::with_most_bits(ticks, self.total_sweep, self.largest_sweep, 47);
        // From 16 to 63.
        self.cruise_shift = self.cruise.fraction_bits().wrapping_add(16);
    }
}

/// The square has 64 bits, so the root has 32.
fn root(squared: u64) -> u32 {
    squared.isqrt() as u32
}

/// `ticks` `numerator` / `denominator`, which is not 0, rounded down; saturates.
fn scale(ticks: u64, numerator: u32, denominator: u32) -> u64 {
    if numerator == denominator {
        return ticks;
    }
    let numerator = u64::from(numerator);
    let whole = quotient(ticks, denominator);
    let rest = ticks.wrapping_sub(whole.wrapping_mul(denominator.into()));
    // rest and numerator are below 2^32.
    let part = quotient(rest.wrapping_mul(numerator), denominator);
    whole.saturating_mul(numerator).saturating_add(part)
}
