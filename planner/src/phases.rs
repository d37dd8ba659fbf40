//! The seven phases of a jerk-limited move, in whole ticks.
//!
//! Units: the jerk is 1, so t ticks of full jerk change the rate by t^2 / 2. Rates are kept doubled
//! (`w`) and paths in sixths of their unit. All values are therefore integers for any number of
//! ticks.

use crate::wide::quotient;

/// A change of rate: the acceleration grows for `jerk` ticks, is constant for `steady` ticks and
/// shrinks for `jerk` ticks.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) struct Bend {
    pub(crate) jerk: u32,
    pub(crate) steady: u32,
}

/// The course of a jerk-limited move from its present point on.
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

/// The present state of a move, and its limits.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) struct Course {
    /// Present rate, doubled, and present acceleration in ticks of jerk.
    pub(crate) w: u64,
    pub(crate) acceleration: i32,
    pub(crate) top_w: u64,
    pub(crate) end_w: u64,
    /// Most ticks of jerk; this is the greatest acceleration.
    pub(crate) most_jerk: u32,
}

impl Bend {
    /// The change of rate from one rate to the other. It falls short by up to one tick of
    /// acceleration, so that no limit is exceeded.
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

    /// The change of the doubled rate.
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

    /// Path in sixths, where `w` is the lower of the two rates: 3 (v + v') t.
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
    /// The rate at which the present acceleration has vanished, with the ticks and the path until
    /// then; `None` if the motion would reverse.
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

    /// The two changes of rate over a peak (or, from above the top rate, down to it), with their
    /// path and the peak.
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

    /// The quickest phases with a path of at most `room`, and that path. With `is_whole` the path
    /// is at least `room`, by less than the path of one tick. `None` where the room is too short.
    ///
    /// If the top rate is out of reach, the peak is found by bisection: at most 62 square roots.
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
                // Both are below 2^62.
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
