//! Braking of the planned path.
//!
//! From the speed v, full braking in slices reaches the speed V after a path of (v^2 - V^2) / 2 a,
//! where a is the step of a slice. Speeds are in units per slice and paths in half units, so the
//! path is (v^2 - V^2) / a half units.
//!
//! Braking is not allowed in a slice in which a rise leaves the window; there the speed stays
//! level. Before the first of these slices there are `free` slices. So the speed in the level
//! slices is v - `free` a, or 0 if this is negative.

use crate::jerk_window::{
    filter::{Point, Wait},
    scale::Scale,
};
use crate::ramp::whole_root;

/// Braking after a slice that begins with a given state.
#[derive(Copy, Clone, Debug)]
pub(crate) struct Braking {
    /// Full change of speed in a slice, at most 2^25.
    pub(crate) step: u32,
    /// Longer paths are taken as this; the path of any braking is shorter.
    pub(crate) reach: u64,
    /// Speed at the start of the slice, at most 2^30.
    pub(crate) speed: u32,
    /// Wait for braking after the slice.
    pub(crate) wait: Wait,
}

impl Braking {
    /// Braking from a state, without a slice before it.
    pub(crate) fn now(scale: &Scale, wait: Wait) -> Braking {
        Braking::after(scale, 0, wait)
    }

    /// Braking after a slice that begins with this speed.
    pub(crate) fn after(scale: &Scale, speed: u32, wait: Wait) -> Braking {
        Braking {
            step: scale.step,
            reach: scale.reach,
            speed,
            wait,
        }
    }

    /// The last step may be shorter than the others. It is then made in a whole slice, and takes
    /// up to an eighth of a step more path than full braking in a part of the slice.
    fn reserve(&self) -> i64 {
        i64::from(self.step >> 2).wrapping_add(1)
    }

    /// Path in the level slices.
    fn level(&self, speed: u32) -> i64 {
        let free = self.wait.free.wrapping_mul(self.step);
        let speed = i64::from(speed.saturating_sub(free));
        // At most 2^30 2^5.
        speed.wrapping_mul(self.wait.level.into()).wrapping_mul(2)
    }

    /// Whether braking to a speed from `end`, the speed after the slice, ends in time. `room` is
    /// the path to where it would end at the speed 0. `is_low`: the speed to brake to is at most a
    /// step.
    pub(crate) fn fits(&self, end: u32, room: i64, is_low: bool) -> bool {
        let slice = i64::from(self.speed).wrapping_add(end.into());
        self.is_within(end, room.saturating_sub(slice), is_low)
    }

    /// Whether braking from a speed fits in a room.
    pub(crate) fn is_within(&self, speed: u32, room: i64, is_low: bool) -> bool {
        let left = room.saturating_sub(self.level(speed));
        if is_low && speed < self.step {
            // One slice is enough. To a speed V, it takes v + V, and at least V of this is
            // reserved: Y is 2 V - V^2 / a behind the height.
            return left >= i64::from(speed);
        }
        let Ok(left) = u64::try_from(left.saturating_sub(self.reserve())) else {
            return false;
        };
        // At most 2^60.
        let squared = u64::from(speed).wrapping_mul(speed.into());
        squared <= left.min(self.reach).wrapping_mul(self.step.into())
    }

    /// The highest speed that [`fits`](Braking::fits). The room is too short for some speed below
    /// 2^30, so that all values fit.
    pub(crate) fn highest(&self, room: i64, is_low: bool) -> u32 {
        let speed = self.highest_of_ramp(room);
        if is_low && speed < self.step {
            self.highest_of_slice(room)
        } else {
            speed
        }
    }

    fn highest_of_ramp(&self, room: i64) -> u32 {
        let left = room
            .saturating_sub(self.speed.into())
            .saturating_sub(self.reserve());
        let Ok(left) = u64::try_from(left) else {
            return 0;
        };
        // Below 2^62, or no speed would be too high.
        let product = left.min(self.reach).wrapping_mul(self.step.into());
        let step = u64::from(self.step);
        let without = highest_of(step, product);
        let free = self.wait.free.wrapping_mul(self.step);
        if without <= free || self.wait.level == 0 {
            return without;
        }
        // Both are at most 2^25 2^5 2^25 2^4.
        let level = step.wrapping_mul(self.wait.level.wrapping_mul(2).into());
        let given_back = level.wrapping_mul(free.into());
        highest_of(step.wrapping_add(level), product.wrapping_add(given_back)).max(free)
    }

    /// The highest speed below a step.
    fn highest_of_slice(&self, room: i64) -> u32 {
        let slices = match self.wait.free {
            0 => self.wait.level.wrapping_add(1),
            _ => 1,
        };
        let left = u64::try_from(room.saturating_sub(self.speed.into())).unwrap_or(0);
        let speed = left.checked_div(slices.wrapping_mul(2).into()).unwrap_or(0);
        speed.min(self.step.saturating_sub(1).into()) as u32
    }

    /// Path left to where braking from `height` ends.
    pub(crate) fn room(lead: &Point, height: u64) -> i64 {
        height.wrapping_sub(lead.at) as i64
    }
}

/// The highest x with x^2 + `linear` x <= `product`. Both are below 2^63.
fn highest_of(linear: u64, product: u64) -> u32 {
    let half = linear.div_ceil(2);
    // half is at most 2^30.
    let root = whole_root(half.wrapping_mul(half).wrapping_add(product));
    u64::from(root).saturating_sub(half) as u32
}
