//! The compensation of step events.

use crate::BacklashModel;

/// Detects the axes that reverse in a step event, and returns the take-up of each. It compensates
/// eight axes at most. Further axes have no take-up.
///
/// # Cost
/// While no axis reverses, an event costs a few operations on masks and no call of the backlash
/// model.
///
/// # Examples
/// ```
/// use husillo_backlash::{Backlash, Compensator, Flank};
///
/// let axis = |backlash| Backlash::new(backlash, Flank::Positive);
/// let mut stage = Compensator::new([axis(3), axis(2)]);
/// assert_eq!(stage.before(&[1, 1], [0, 0]), [0, 0]);
/// // Both reverse: 3 steps of X alone, then 2 of Y alone, then the event.
/// assert_eq!(stage.before(&[-1, -1], [1, 1]), [3, 2]);
/// assert!(stage.is_straight_on(0b01, 0b01)); // X continues in the negative direction
/// ```
#[derive(Copy, Clone, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Compensator<const N: usize, L: BacklashModel<N>> {
    backlash: [L; N],
    /// Axes whose last event was in the positive direction, and those with a negative one; bit 0 is
    /// the first axis.
    positive: u8,
    negative: u8,
}

impl<const N: usize, L: BacklashModel<N>> Compensator<N, L> {
    /// Creates it with one backlash model per axis. Each model knows its flank.
    pub const fn new(backlash: [L; N]) -> Self {
        Compensator {
            backlash,
            positive: 0,
            negative: 0,
        }
    }

    /// Returns the take-up of each axis in motor steps before the event `delta` (entries -1, 0,
    /// +1), with the load at `load`.
    ///
    /// The caller makes these steps before the event, in the direction of the axis' `delta`, one
    /// axis after the other from the first. The load does not move in them. The new directions are
    /// stored, so call it once per event.
    #[inline]
    pub fn before(&mut self, delta: &[i8; N], load: [i32; N]) -> [u32; N] {
        let mut owed = [0; N];
        let mut bit = 1_u8;
        let axes = self.backlash.iter_mut().zip(0..N).zip(delta);
        for (owed, ((backlash, axis), &now)) in owed.iter_mut().zip(axes) {
            let (this, other) = match now {
                0 => (&mut 0, &mut 0),
                1.. => (&mut self.positive, &mut self.negative),
                ..0 => (&mut self.negative, &mut self.positive),
            };
            if now != 0 && *this & bit == 0 {
                // Beyond the eighth axis there is no bit.
                *owed = if bit == 0 {
                    0
                } else {
                    backlash.take_up(axis, now, &load)
                };
                *this |= bit;
                *other &= !bit;
            }
            bit = bit.wrapping_shl(1) & !1;
        }
        owed
    }

    /// Returns the signed motor steps of each axis that are due because the backlash at `load` has
    /// changed. `load` is the position after the next event: see [`BacklashModel::follow`]. `None`
    /// if there are none. Call it after [`Compensator::before`].
    #[inline]
    pub fn follow(&mut self, load: &[i32; N]) -> Option<[i32; N]> {
        if !L::VARIES {
            return None;
        }
        let mut owed = [0; N];
        let mut is_due = false;
        for (owed, backlash) in owed.iter_mut().zip(&mut self.backlash) {
            *owed = backlash.follow(load);
            is_due |= *owed != 0;
        }
        is_due.then_some(owed)
    }

    /// Returns the direction of the last event of an axis, and the take-up in motor steps if it
    /// reversed now, with the load at `load`. Returns `None` before its first event.
    ///
    /// It is for a caller that moves a motor off the path and back, through the backlash. The model
    /// is called for a reversal and for the return at the same position, which leaves it unchanged.
    pub fn play(&mut self, axis: usize, load: &[i32; N]) -> Option<(i8, u32)> {
        let bit = 1_u8.checked_shl(u32::try_from(axis).ok()?)?;
        let direction = if self.positive & bit != 0 {
            1
        } else if self.negative & bit != 0 {
            -1
        } else {
            return None;
        };
        let backlash = self.backlash.get_mut(axis)?;
        let owed = backlash.take_up(axis, -direction, load);
        backlash.take_up(axis, direction, load);
        Some((direction, owed))
    }

    /// Whether no axis reverses in an event of `axes` (bit 0 is the first axis), of which those in
    /// `negative` move in the negative direction. Then there is no take-up.
    #[inline]
    #[must_use]
    pub const fn is_straight_on(&self, axes: u8, negative: u8) -> bool {
        let forwards = axes & !negative;
        let backwards = axes & negative;
        (forwards & !self.positive) | (backwards & !self.negative) == 0
    }

    /// Returns the backlash models, the first axis first.
    pub const fn backlash(&self) -> &[L; N] {
        &self.backlash
    }

    /// Returns the backlash models for changes: after homing, or for another map.
    pub fn backlash_mut(&mut self) -> &mut [L; N] {
        // The models have the directions, so they are called again.
        self.positive = 0;
        self.negative = 0;
        &mut self.backlash
    }
}
