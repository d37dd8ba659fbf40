//! Events of different sweep, timed directly by the cubic.

use crate::quotient::quotient;
use crate::ramp::{
    piece::Shape,
    root::Root,
    slowness::{Slowness, part},
};
use crate::{Waits, timer::bits};

/// The present part of a move with events of different sweep: an arc, a helix or an ellipse.
///
/// Times within a part are in units of 2^`unit` of those of `Slowness`: the whole has 30 bits.
/// An event is then less than 2^-27 of the part off, and the last one takes the exact rest.
#[derive(Copy, Clone, Debug, Default)]
pub(crate) struct Span {
    /// Sweep of the part, and the sweep that has passed.
    pub(crate) sweep: u64,
    pub(crate) passed: u64,
    /// Time of the part, and the time that was given, in the units of `Slowness`.
    pub(crate) time: u64,
    pub(crate) given: u64,
    pub(crate) law: Law,
    pub(crate) unit: u8,
    /// Change of the squared speed over the part.
    pub(crate) gain: u64,
    /// Leading zeros of the sweep. With as many bits to the left, its 32 highest bits are a
    /// `place` in the part.
    pub(crate) zeros: u8,
    /// 2^63 divided by the place of the end.
    inverse: u32,
    /// Whether the time is that of the timer of the top speed.
    pub(crate) is_level: bool,
}

/// Time as a function of the place within a part.
#[derive(Copy, Clone, Debug)]
pub(crate) enum Law {
    /// Proportional to the sweep: t = p rate.
    Even { rate: u32 },
    /// t = p (linear -+ p (square -+ p cube)), with minus if the speed rises.
    Cubic(Cubic),
    /// By the timer of the top speed, where events are slow.
    Level,
    /// By the square root, for the first and the last grains of a ramp.
    Exact {
        /// Squared speed at the start.
        from: u64,
        speed: u32,
        is_rising: bool,
    },
}

impl Default for Law {
    fn default() -> Self {
        Law::Even { rate: 0 }
    }
}

/// The coefficients of the cubic. Products with a place are divided by 2^32.
#[derive(Copy, Clone, Debug)]
pub(crate) struct Cubic {
    linear: u32,
    square: u32,
    cube: u32,
    is_rising: bool,
}

impl Cubic {
    /// The time at a place.
    #[inline(always)]
    pub(crate) fn time(&self, place: u32) -> u32 {
        let inner = high(self.cube, place);
        if self.is_rising {
            let slope = high(self.square.saturating_sub(inner), place);
            high(self.linear.wrapping_sub(slope), place)
        } else {
            let slope = high(self.square.wrapping_add(inner), place);
            high(self.linear.wrapping_add(slope), place)
        }
    }
}

/// The upper word of a product.
#[inline(always)]
pub(crate) fn high(one: u32, other: u32) -> u32 {
    (u64::from(one).wrapping_mul(other.into()) >> 32) as u32
}

/// Bits of the time of a part.
const TIME_BITS: u32 = 30;

impl Span {
    /// A part of this sweep at constant speed, or between speeds so near that it does not matter.
    pub(crate) fn even(sweep: u64, time: u64, gain: u64) -> Span {
        let mut span = Span::of(sweep, time, gain);
        let rate = span.per_place(span.whole());
        span.law = Law::Even { rate };
        span
    }

    /// A part at the top speed, by its timer.
    pub(crate) fn level(sweep: u64, time: u64) -> Span {
        let mut span = Span::even(sweep, time, 0);
        span.is_level = true;
        span
    }

    /// A part with another law.
    pub(crate) fn with(sweep: u64, time: u64, gain: u64, law: Law) -> Span {
        let mut span = Span::of(sweep, time, gain);
        span.law = law;
        span
    }

    /// A part of constant acceleration.
    pub(crate) fn cubic(sweep: u64, time: u64, gain: u64, shape: &Shape) -> Span {
        let mut span = Span::of(sweep, time, gain);
        let whole = span.whole();
        // Below 0.13 and 0.02 of the time.
        let (bow, skew) = (high(whole, shape.bow), high(whole, shape.skew));
        let (double, triple) = (skew.wrapping_mul(2), skew.wrapping_mul(3));
        let (linear, square) = if shape.is_rising {
            (
                whole.wrapping_add(bow).wrapping_add(skew),
                bow.wrapping_add(triple),
            )
        } else {
            (
                whole.wrapping_sub(bow).wrapping_add(skew),
                bow.saturating_sub(triple),
            )
        };
        // A place is the part of the sweep times 1/2 to 1, so the coefficients grow by up to 2, 4
        // and 8. The cube of 2 skew is below 0.32 of the time.
        let times =
            |value: u32, count: u32| (0..count).fold(value, |value, _| span.per_place(value));
        let cubic = Cubic {
            // Less by more than all roundings, so that no place is later than the end.
            linear: times(linear, 1).saturating_sub(16),
            square: times(square, 2),
            cube: times(double, 3),
            is_rising: shape.is_rising,
        };
        span.law = Law::Cubic(cubic);
        span
    }

    fn of(sweep: u64, time: u64, gain: u64) -> Span {
        let sweep = sweep.max(1);
        let zeros = sweep.leading_zeros();
        let divisor = (sweep.wrapping_shl(zeros) >> 32) as u32;
        Span {
            sweep,
            passed: 0,
            time,
            given: 0,
            law: Law::default(),
            unit: bits(time).saturating_sub(TIME_BITS) as u8,
            gain,
            zeros: zeros as u8,
            inverse: quotient(1 << 63, divisor).min(u32::MAX.into()) as u32,
            is_level: false,
        }
    }

    /// The time of the part in its units.
    fn whole(&self) -> u32 {
        self.time.wrapping_shr(self.unit.into()) as u32
    }

    /// A value per part of the sweep, converted to one per place.
    fn per_place(&self, value: u32) -> u32 {
        // Below 2^31 2^32.
        (u64::from(value).wrapping_mul(self.inverse.into()) >> 31) as u32
    }

    /// The place that has been passed, in 2^-32 of the next power of two of the sweep.
    #[inline(always)]
    fn place(&self) -> u32 {
        (self.passed.wrapping_shl(self.zeros.into()) >> 32) as u32
    }

    /// Passes `sweep` more, within the part. Returns its time.
    pub(crate) fn pass(&mut self, sweep: u64, slowness: &Slowness) -> u64 {
        self.passed = self.passed.wrapping_add(sweep);
        let time = self.time_at(slowness).min(self.time).max(self.given);
        let wait = time.wrapping_sub(self.given);
        self.given = time;
        wait
    }

    /// Returns the part of the sweep that has passed, in units of 2^-32; below 2^32.
    pub(crate) fn share(&self) -> u32 {
        // place < 2^64 / inverse 2^31.
        let share = u64::from(self.place()).wrapping_mul(self.inverse.into()) >> 31;
        share.min(u32::MAX.into()) as u32
    }

    fn time_at(&self, slowness: &Slowness) -> u64 {
        let time = match self.law {
            Law::Even { rate } => high(rate, self.place()),
            Law::Level => 0,
            Law::Cubic(cubic) => cubic.time(self.place()),
            Law::Exact {
                from,
                speed,
                is_rising,
            } => {
                let gain = part(self.gain, self.share());
                let square = if is_rising {
                    from.saturating_add(gain)
                } else {
                    from.saturating_sub(gain)
                };
                return slowness.time(Root::of(square).speed.abs_diff(speed));
            }
        };
        u64::from(time).wrapping_shl(self.unit.into())
    }

    /// Most sweep of the events for [`fill`](Self::fill): they end before the end of the part. 0
    /// for a part that it cannot time. The part is in units of 2^-32 tick.
    pub(crate) fn room(&self) -> u32 {
        if !matches!(self.law, Law::Even { .. } | Law::Cubic(_))
            || self.unit == 0
            || self.time >> 61 != 0
        {
            return 0;
        }
        let room = self.sweep.wrapping_sub(self.passed).saturating_sub(1);
        room.min(u32::MAX.into()) as u32
    }

    /// Replaces the sweeps of events by the waits before them. `owed` is the fraction of a tick.
    pub(crate) fn fill<'a>(
        &mut self,
        owed: &mut u32,
        places: impl Iterator<Item = &'a mut u32>,
    ) -> Waits {
        match self.law {
            Law::Even { rate } => self.fill_by(owed, places, |place| high(rate, place)),
            Law::Cubic(cubic) => self.fill_by(owed, places, |place| cubic.time(place)),
            _ => Waits::NONE,
        }
    }

    #[inline(always)]
    fn fill_by<'a>(
        &mut self,
        owed: &mut u32,
        places: impl Iterator<Item = &'a mut u32>,
        time_at: impl Fn(u32) -> u32,
    ) -> Waits {
        let (mut waits, mut fraction) = (Waits::NONE, *owed);
        let (unit, zeros) = (u32::from(self.unit), u32::from(self.zeros));
        let mut passed = self.passed;
        // All times are multiples of the unit, and the part has less than 2^30 of them.
        let mut before = self.given.wrapping_shr(unit) as u32;
        for place in places {
            passed = passed.wrapping_add(u64::from(*place));
            let time = time_at((passed.wrapping_shl(zeros) >> 32) as u32).max(before);
            let wait = time.wrapping_sub(before);
            before = time;
            // The unit is from 1 to 31.
            let (sum, carries) = fraction.overflowing_add(wait.wrapping_shl(unit));
            fraction = sum;
            let whole = wait.wrapping_shr(32_u32.wrapping_sub(unit));
            let wait = whole.wrapping_add(carries.into());
            *place = wait;
            waits.count = waits.count.wrapping_add(1);
            waits.ticks = waits.ticks.wrapping_add(wait);
            waits.least = waits.least.min(wait);
        }
        self.passed = passed;
        self.given = u64::from(before).wrapping_shl(unit);
        *owed = fraction;
        waits
    }
}
