//! The stage on events.

use crate::Lash;

/// Watches step events for axes that turn round and says what each owes first. Eight axes at most:
/// further ones owe nothing.
///
/// While no axis turns round, an event costs a few operations on masks and no call into the lash
/// model.
///
/// ```
/// use husillo_backlash::{Backlash, Compensator, Flank};
///
/// let axis = |lash| Backlash::new(lash, Flank::Positive);
/// let mut stage = Compensator::new([axis(3), axis(2)]);
/// assert_eq!(stage.before(&[1, 1], [0, 0]), [0, 0]);
/// // Both turn round: 3 steps of X alone, then 2 of Y alone, then the event.
/// assert_eq!(stage.before(&[-1, -1], [1, 1]), [3, 2]);
/// assert!(stage.is_straight_on(0b01, 0b01)); // X on in the negative direction
/// ```
#[derive(Copy, Clone, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Compensator<const N: usize, L: Lash<N>> {
    lash: [L; N],
    /// Axes whose last event was in the positive direction, and those with a negative one; bit 0 is
    /// the first axis.
    positive: u8,
    negative: u8,
}

impl<const N: usize, L: Lash<N>> Compensator<N, L> {
    /// One lash model per axis; each knows its flank.
    pub const fn new(lash: [L; N]) -> Self {
        Compensator {
            lash,
            positive: 0,
            negative: 0,
        }
    }

    /// Motor steps each axis owes before the event `delta` (entries -1, 0, +1), with the load at
    /// `load`.
    ///
    /// To be made in the direction of the axis' `delta`, one axis after the other from the first,
    /// and before the event. The load does not move in them. Remembers the new directions: ask once
    /// an event.
    #[inline]
    pub fn before(&mut self, delta: &[i8; N], load: [i32; N]) -> [u32; N] {
        let mut owed = [0; N];
        let mut bit = 1_u8;
        let axes = self.lash.iter_mut().zip(0..N).zip(delta);
        for (owed, ((lash, axis), &now)) in owed.iter_mut().zip(axes) {
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
                    lash.take_up(axis, now, &load)
                };
                *this |= bit;
                *other &= !bit;
            }
            bit = bit.wrapping_shl(1) & !1;
        }
        owed
    }

    /// Motor steps each axis owes, signed, since the lash under its nut is another at `load`, where
    /// the event that comes next will take the load: see [`Lash::follow`]. `None` where no axis
    /// owes any. After [`Compensator::before`].
    #[inline]
    pub fn follow(&mut self, load: &[i32; N]) -> Option<[i32; N]> {
        if !L::VARIES {
            return None;
        }
        let mut owed = [0; N];
        let mut is_due = false;
        for (owed, lash) in owed.iter_mut().zip(&mut self.lash) {
            *owed = lash.follow(load);
            is_due |= *owed != 0;
        }
        is_due.then_some(owed)
    }

    /// The direction of an axis' last event, and the motor steps it would owe if it turned round
    /// now, with the load at `load`. `None` before its first event.
    ///
    /// For who moves a motor beside the path and back, across the lash that the path has. The model
    /// is asked for a turn and for the turn back at one place, which leaves it as it was.
    pub fn play(&mut self, axis: usize, load: &[i32; N]) -> Option<(i8, u32)> {
        let bit = 1_u8.checked_shl(u32::try_from(axis).ok()?)?;
        let direction = if self.positive & bit != 0 {
            1
        } else if self.negative & bit != 0 {
            -1
        } else {
            return None;
        };
        let lash = self.lash.get_mut(axis)?;
        let owed = lash.take_up(axis, -direction, load);
        lash.take_up(axis, direction, load);
        Some((direction, owed))
    }

    /// Whether an event of `axes` (bit 0 is the first axis), of which those in `negative` go
    /// backwards, turns none round; then nothing is owed.
    #[inline]
    #[must_use]
    pub const fn is_straight_on(&self, axes: u8, negative: u8) -> bool {
        let forwards = axes & !negative;
        let backwards = axes & negative;
        (forwards & !self.positive) | (backwards & !self.negative) == 0
    }

    /// The lash models, the first axis first.
    pub const fn lash(&self) -> &[L; N] {
        &self.lash
    }

    /// The lash models, to be changed: after homing, or for another map.
    pub fn lash_mut(&mut self) -> &mut [L; N] {
        // The models know the directions; ask them again.
        self.positive = 0;
        self.negative = 0;
        &mut self.lash
    }
}
