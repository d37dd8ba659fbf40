//! Events timed by differences.

use crate::Waits;
use crate::ramp::{root::Root, slowness::part};

/// A number of events whose intervals follow from additions.
///
/// The intervals are a quadratic polynomial of the event number, so the times are a cubic one. All
/// values are ticks times 2^32, in two's complement. An interrupt needs nothing but this value to
/// time the events.
///
/// # Examples
/// ```
/// use husillo_planner::Piece;
///
/// // Three events at constant speed, 2.5 ticks each.
/// let mut piece = Piece { count: 3, interval_q32: 5 << 31, change_q32: 0, bend_q32: 0 };
/// let mut owed = 0;
/// let waits: Vec<u32> = std::iter::from_fn(|| piece.next(&mut owed)).collect();
/// assert_eq!(waits, [2, 3, 2]);
/// assert_eq!(owed, 1 << 31);
/// ```
#[derive(Copy, Clone, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Piece {
    /// Events left.
    pub count: u32,
    /// The next interval.
    pub interval_q32: u64,
    /// Change from the next interval to the one after it.
    pub change_q32: u64,
    /// Change of `change_q32` per event.
    pub bend_q32: u64,
}

impl Piece {
    /// Returns the ticks to wait before the next event. Returns `None` after the last one. `owed`
    /// is the fraction of a tick, carried from event to event and from piece to piece.
    ///
    /// # Cost
    /// Three 64-bit additions and one 32-bit addition.
    #[inline]
    pub fn next(&mut self, owed: &mut u32) -> Option<u32> {
        self.count = self.count.checked_sub(1)?;
        Some(self.step(owed))
    }

    /// Returns the next interval. The caller has already counted the event.
    #[inline]
    pub(crate) fn step(&mut self, owed: &mut u32) -> u32 {
        let time = self.interval_q32.wrapping_add((*owed).into());
        *owed = time as u32;
        self.interval_q32 = self.interval_q32.wrapping_add(self.change_q32);
        self.change_q32 = self.change_q32.wrapping_add(self.bend_q32);
        (time >> 32) as u32
    }

    /// Writes the waits before the next events, as [`next`](Piece::next) returns them, until the
    /// piece or the places end.
    pub(crate) fn fill<'a>(
        &mut self,
        owed: &mut u32,
        places: &mut impl Iterator<Item = &'a mut u32>,
        waits: &mut Waits,
    ) {
        // Local variables, which are in registers.
        let (mut piece, mut fraction, before) = (*self, *owed, self.count);
        let (mut ticks, mut least) = (waits.ticks, waits.least);
        while piece.count != 0 {
            let Some(place) = places.next() else { break };
            piece.count = piece.count.wrapping_sub(1);
            let wait = piece.step(&mut fraction);
            *place = wait;
            ticks = ticks.wrapping_add(wait);
            least = least.min(wait);
        }
        waits.count = waits.count.wrapping_add(before.wrapping_sub(piece.count));
        (waits.ticks, waits.least) = (ticks, least);
        (*self, *owed) = (piece, fraction);
    }

    /// Whether all waits are below 2^31 ticks. The intervals of a piece differ by less than a half.
    pub(crate) const fn is_quick(&self) -> bool {
        self.interval_q32 >> 62 == 0
    }

    /// Returns the time of the next `count` events, at most 2^11, in ticks times 2^32.
    pub(crate) fn time_of(&self, count: u32) -> u64 {
        // The binomial coefficients of `count` over 1, 2 and 3 are below 2^33. All sums are taken
        // modulo 2^64.
        let first = u64::from(count);
        let second = first.wrapping_mul(first.saturating_sub(1)) >> 1;
        let third = second.wrapping_mul(first.saturating_sub(2)) / 3;
        first
            .wrapping_mul(self.interval_q32)
            .wrapping_add(second.wrapping_mul(self.change_q32))
            .wrapping_add(third.wrapping_mul(self.bend_q32))
    }

    /// Takes the next `count` events out of this piece.
    pub(crate) fn split(&mut self, count: u32) -> Piece {
        let count = count.min(self.count);
        let front = Piece { count, ..*self };
        let n = u64::from(count);
        let pairs = n.wrapping_mul(n.saturating_sub(1)) >> 1;
        self.count = self.count.wrapping_sub(count);
        self.interval_q32 = self
            .interval_q32
            .wrapping_add(n.wrapping_mul(self.change_q32))
            .wrapping_add(pairs.wrapping_mul(self.bend_q32));
        self.change_q32 = self.change_q32.wrapping_add(n.wrapping_mul(self.bend_q32));
        front
    }
}

/// The times within a ramp of constant acceleration, as a cubic through its time and its end speeds
/// (Hermite interpolation). With r = (v' - v) / (v' + v) and x the part of the path:
///
/// ```text
/// t / T = x + A x (1 - x) - B (2 x - 1) x (1 - x),   A = r / (1 - r^2),   B = r A
/// ```
#[derive(Copy, Clone, Debug)]
pub(crate) struct Shape {
    /// |A| and B in units of 2^-32.
    pub(crate) bow: u32,
    pub(crate) skew: u32,
    pub(crate) is_rising: bool,
}

impl Shape {
    /// `gain` is the difference of the squared speeds. It is at most half of the smaller one.
    #[inline]
    pub(crate) fn new(before: &Root, after: &Root, gain: u64) -> Shape {
        // A = (v'^2 - v^2) / 4 v v', B = (v' - v)^2 / 4 v v'; 1 / v = inverse 2^(shift - 62).
        let [one, other] = [before.shift, after.shift].map(u32::from);
        // At most 2^31.
        let inverses = u64::from(before.inverse).wrapping_mul(after.inverse.into()) >> 31;
        let gain = gain.wrapping_shl(one.wrapping_add(other)) >> 32;
        let speeds = after.speed.abs_diff(before.speed);
        let squared = u64::from(speeds.wrapping_shl(one))
            .wrapping_mul(speeds.wrapping_shl(other).into())
            >> 32;
        Shape {
            // Below 2^31 2^31.
            bow: (gain.wrapping_mul(inverses) >> 31) as u32,
            skew: (squared.wrapping_mul(inverses) >> 31) as u32,
            is_rising: after.speed > before.speed,
        }
    }
}

/// Returns the piece of `count` events, 2 to 1024, that takes `time`, and the rest of the time. The
/// rest is due to rounding and is below 2^-21 tick.
///
/// The rounding of the second difference moves events within the piece by up to 0.1 `count`^3 2^-32
/// tick. The ends are exact, because the interval is computed from the rounded differences.
pub(crate) fn by_differences(count: u32, time: u64, shape: &Shape) -> (Piece, u64) {
    // Too small by less than 2^-32, that is by a relative 2^-22.
    let inverse = u32::MAX.checked_div(count).unwrap_or(0);
    let divide = |value: u64| part(value, inverse);
    let first = divide(time);
    // At most a 2^-21th part of the time.
    let left = time.wrapping_sub(first.wrapping_mul(count.into()));
    let more = left.min(u32::MAX.into()).wrapping_mul(inverse.into()) >> 32;
    let mean = first.wrapping_add(more);
    let slope = divide(mean);
    let third = divide(part(slope, shape.skew));
    let bend = third.wrapping_mul(12);
    // 2 A + 6 B where the speed rises, otherwise -2 |A| + 6 B; A is below 0.13, B below 0.02.
    let [double, six] = [shape.bow.wrapping_mul(2), shape.skew.wrapping_mul(6)];
    let change = if shape.is_rising {
        bend.wrapping_sub(part(slope, double.wrapping_add(six)))
    } else {
        bend.wrapping_add(part(slope, double.saturating_sub(six)))
    };
    // The sum of all intervals is `count` times the mean, plus half a unit each where the product
    // is odd; then `count` is even.
    let before = u64::from(count.wrapping_sub(1));
    let product = before.wrapping_mul(change);
    let half = (product as i64 >> 1) as u64;
    let cubes = before
        .wrapping_mul(count.wrapping_sub(2).into())
        .wrapping_mul(2);
    let interval = mean
        .wrapping_sub(half)
        .wrapping_sub(cubes.wrapping_mul(third));
    let odd = if product & 1 == 0 { 0 } else { count >> 1 };
    // A product of 32 bits where `left` had no more.
    let rest = left
        .wrapping_sub(more.wrapping_mul(count.into()))
        .wrapping_sub(odd.into());
    let piece = Piece {
        count,
        interval_q32: interval,
        change_q32: change,
        bend_q32: bend,
    };
    (piece, rest)
}
