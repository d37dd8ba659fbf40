//! The stage on events.

use crate::Lash;

/// Watches step events for axes that turn round and says what each owes first.
///
/// While no axis turns round, an event costs one comparison an axis and no call into the lash model.
///
/// ```
/// use husillo_backlash::{Backlash, Compensator, Flank};
///
/// let axis = |lash| Backlash::new(lash, Flank::Positive);
/// let mut stage = Compensator::new([axis(3), axis(2)]);
/// assert_eq!(stage.before(&[1, 1], [0, 0]), [0, 0]);
/// // Both turn round: 3 steps of X alone, then 2 of Y alone, then the event.
/// assert_eq!(stage.before(&[-1, -1], [1, 1]), [3, 2]);
/// ```
#[derive(Copy, Clone, Debug)]
pub struct Compensator<const N: usize, L: Lash> {
    lash: [L; N],
    /// Direction of each axis' last event; 0 until its first.
    last: [i8; N],
}

impl<const N: usize, L: Lash> Compensator<N, L> {
    /// One lash model per axis; each knows its flank.
    pub const fn new(lash: [L; N]) -> Self {
        Compensator { lash, last: [0; N] }
    }

    /// Motor steps each axis owes before the event `delta` (entries -1, 0, +1), with the load at `load`.
    ///
    /// To be made in the direction of the axis' `delta`, one axis after the other from the first, and before the event.
    /// The load does not move in them. Remembers the new directions: ask once an event.
    #[inline]
    pub fn before(&mut self, delta: &[i8; N], load: [i32; N]) -> [u32; N] {
        if self.is_straight_on(delta) {
            [0; N]
        } else {
            self.turn(delta, load)
        }
    }

    /// Whether no axis of `delta` moves another way than it did last; then nothing is owed.
    #[inline]
    #[must_use]
    pub fn is_straight_on(&self, delta: &[i8; N]) -> bool {
        let mut turns = false;
        for (&now, &last) in delta.iter().zip(&self.last) {
            turns |= (now != 0) & (now != last);
        }
        !turns
    }

    /// The lash models, the first axis first.
    pub const fn lash(&self) -> &[L; N] {
        &self.lash
    }

    /// The lash models, to be changed: after homing, or for another map.
    pub fn lash_mut(&mut self) -> &mut [L; N] {
        self.last = [0; N]; // the models know the directions; ask them again
        &mut self.lash
    }

    #[cold]
    fn turn(&mut self, delta: &[i8; N], load: [i32; N]) -> [u32; N] {
        let mut owed = [0; N];
        let axes = self
            .lash
            .iter_mut()
            .zip(&mut self.last)
            .zip(delta.iter().zip(load));
        for (owed, ((lash, last), (&now, load))) in owed.iter_mut().zip(axes) {
            if now != 0 && now != *last {
                *owed = lash.take_up(now, load);
                *last = now;
            }
        }
        owed
    }
}
