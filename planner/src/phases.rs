//! The seven phases of a jerk-limited move, in whole ticks.
//!
//! Units: the jerk is 1, so a change of rate during t ticks of full jerk is t^2 / 2. Rates are kept
//! doubled (`w`), path in sixths of its unit: all are integers, whatever the ticks.

use crate::wide::quotient;

/// A change of rate: `jerk` ticks of growing, `steady` ticks of constant and `jerk` ticks of
/// shrinking acceleration.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) struct Bend {
    pub(crate) jerk: u32,
    pub(crate) steady: u32,
}

/// What a jerk-limited move does from its present point on.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) struct Phases {
    /// Ticks until the present acceleration is gone.
    pub(crate) settle: u32,
    pub(crate) first: Bend,
    /// Whether the first change of rate slows down.
    pub(crate) is_first_down: bool,
    pub(crate) level: u64,
    pub(crate) last: Bend,
}

/// Where a move is and what it must keep to.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) struct Course {
    /// Present rate, doubled, and acceleration in ticks of jerk.
    pub(crate) w: u64,
    pub(crate) acceleration: i32,
    pub(crate) top_w: u64,
    pub(crate) end_w: u64,
    /// Most ticks of jerk: the greatest acceleration.
    pub(crate) most_jerk: u32,
}

impl Bend {
    /// The change of rate from one to the other, or up to one tick's worth of acceleration less, so
    /// that no limit is exceeded.
    fn between(one: u64, other: u64, most_jerk: u32) -> Bend {
        let change = one.abs_diff(other) >> 1;
        let jerk = (change.isqrt().min(most_jerk.into())) as u32;
        let steady = change
            .checked_div(jerk.into())
            .unwrap_or(0)
            .saturating_sub(jerk.into());
        Bend {
            jerk,
            // `Rates` keeps ramps below 2^30 ticks.
            steady: steady.min(u32::MAX.into()) as u32,
        }
    }

    /// What it changes of the doubled rate.
    fn change(self) -> u64 {
        // jerk < 2^28, both < 2^32.
        let ticks = u64::from(self.jerk).wrapping_add(self.steady.into());
        u64::from(self.jerk).wrapping_mul(ticks).wrapping_mul(2)
    }

    fn ticks(self) -> u64 {
        u64::from(self.jerk)
            .wrapping_mul(2)
            .wrapping_add(self.steady.into())
    }

    /// Sixths of path, when the lower of its rates is `w`: 3 (v + v') t.
    fn path(self, w: u64) -> u128 {
        // Rates < 2^62, ticks < 2^33.
        u128::from(w)
            .wrapping_mul(2)
            .wrapping_add(self.change().into())
            .wrapping_mul(self.ticks().into())
            .wrapping_mul(3)
            .wrapping_shr(1)
    }
}

impl Course {
    /// The rate when the present acceleration is gone, the ticks and the path to there; `None` if
    /// it would turn round.
    fn settled(&self) -> Option<(u64, u32, u128)> {
        let ticks = self.acceleration.unsigned_abs();
        // ticks < 2^29.
        let square = u64::from(ticks).wrapping_mul(ticks.into());
        let level = u128::from(self.w)
            .wrapping_mul(ticks.into())
            .wrapping_mul(3);
        let cube = u128::from(square)
            .wrapping_mul(ticks.into())
            .wrapping_mul(2);
        if self.acceleration < 0 {
            Some((self.w.checked_sub(square)?, ticks, level.checked_sub(cube)?))
        } else {
            Some((self.w.wrapping_add(square), ticks, level.wrapping_add(cube)))
        }
    }

    /// The two changes of rate over a peak (or, from above the top, down to it), their path and the
    /// peak.
    fn over(&self, from: u64, peak: u64) -> (Bend, Bend, u128, u64) {
        let first = Bend::between(from, peak, self.most_jerk);
        let peak = if from <= peak {
            from.wrapping_add(first.change())
        } else {
            from.wrapping_sub(first.change())
        };
        let last = Bend::between(peak, peak.min(self.end_w), self.most_jerk);
        let path = first
            .path(from.min(peak))
            .wrapping_add(last.path(peak.wrapping_sub(last.change())));
        (first, last, path, peak)
    }

    /// The shortest path to the end rate.
    pub(crate) fn shortest(&self) -> Option<u128> {
        let (from, _, path) = self.settled()?;
        Some(path.wrapping_add(self.over(from, from).2))
    }

    /// The quickest phases with a path of at most `room`, or with `is_whole` of at least `room` by
    /// less than one tick's path; and their path. `None` where the room is too short.
    ///
    /// A top rate out of reach costs a search by halves: at most 62 square roots.
    pub(crate) fn phases(&self, room: u128, is_whole: bool) -> Option<(Phases, u128)> {
        let (from, settle, settle_path) = self.settled()?;
        let room = room.checked_sub(settle_path)?;
        let fits = |peak: u64| self.over(from, peak).2 <= room;
        let peak = if fits(self.top_w) {
            self.top_w
        } else if !fits(from) {
            return None;
        } else if from >= self.top_w {
            from
        } else {
            let (mut low, mut high) = (from, self.top_w);
            while high.wrapping_sub(low) > 1 {
                // Below 2^62 both.
                let middle = low.wrapping_add(high) >> 1;
                if fits(middle) {
                    low = middle;
                } else {
                    high = middle;
                }
            }
            low
        };
        let (first, last, path, peak) = self.over(from, peak);
        let left = room.wrapping_sub(path);
        let a_tick = u128::from(peak).wrapping_mul(3);
        let left = if is_whole {
            left.wrapping_add(a_tick).saturating_sub(1)
        } else {
            left
        };
        let level = if peak == 0 { 0 } else { quotient(left, a_tick) };
        let path = settle_path
            .wrapping_add(path)
            .wrapping_add(a_tick.wrapping_mul(level.into()));
        let phases = Phases {
            settle,
            first,
            is_first_down: peak < from,
            level,
            last,
        };
        Some((phases, path))
    }
}
