//! Lash that is another at every place.

use crate::{Flank, Lash, LashMap};

/// An axis whose lash is looked up in a [`LashMap`] as the tool moves.
///
/// On the positive flank the motor stands at the load's position; on the negative flank it stands
/// before it by the lash at the place where the load is. So it does not only owe a take-up where it
/// turns round: on the negative flank it owes a step whenever the lash under the nut has become
/// another one, also while it stands and other axes move.
///
/// ```
/// use husillo_backlash::{Compensator, Flank, LashMap, MappedBacklash};
///
/// // X has 10 steps of play at Y 0 and 14 at Y 40; Y has none.
/// let x = LashMap::new([0, 1], [&[0][..], &[0, 40]], &[10, 14][..])?;
/// let y = LashMap::new([0, 1], [&[0][..], &[0]], &[0][..])?;
/// let mut stage = Compensator::new([x, y].map(|map| MappedBacklash::new(map, Flank::Positive)));
/// assert_eq!(stage.before(&[-1, 0], [0, 0]), [10, 0]);
/// assert_eq!(stage.follow(&[-1, 0]), None);
/// // Y alone moves up: X keeps its flank.
/// assert_eq!(stage.before(&[0, 1], [-1, 0]), [0, 0]);
/// assert_eq!((1..=40).filter_map(|y| stage.follow(&[-1, y])).collect::<Vec<_>>(), [[-1, 0]; 4]);
/// assert_eq!(stage.before(&[1, 0], [-1, 40]), [14, 0]);
/// # Ok::<(), husillo_backlash::MapError>(())
/// ```
#[derive(Copy, Clone, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct MappedBacklash<K, V> {
    map: LashMap<K, V>,
    flank: Flank,
    /// Motor steps the motor is before the load on the negative flank.
    held_steps: u32,
    /// Motor position less load position on the positive flank.
    origin: i32,
    /// Where the map was looked up, and how far from there it says the same.
    looked_up_at: [i32; 2],
    quiet_steps: u32,
}

impl<K: AsRef<[i32]>, V: AsRef<[u32]>> MappedBacklash<K, V> {
    /// The map of an axis, and its flank engaged now, with the load at machine zero; load and motor
    /// zero are here on the positive flank.
    ///
    /// With [`Flank::Unknown`] the first motion is not compensated: it finds the flank.
    #[must_use]
    pub fn new(map: LashMap<K, V>, flank: Flank) -> Self {
        let looked_up_at = [0; 2];
        let (held_steps, quiet_steps) = map.look_up(looked_up_at);
        MappedBacklash {
            map,
            flank,
            held_steps,
            origin: 0,
            looked_up_at,
            quiet_steps,
        }
    }

    /// The load position with the motor at `motor`, on the flank engaged now and with the lash that
    /// was followed last.
    #[must_use]
    pub const fn load_position(&self, motor: i32) -> i32 {
        let offset = match self.flank {
            Flank::Negative => self.origin.wrapping_sub(self.held_steps.cast_signed()),
            Flank::Positive | Flank::Unknown => self.origin,
        };
        motor.wrapping_sub(offset)
    }

    /// The flank engaged now.
    #[must_use]
    pub const fn flank(&self) -> Flank {
        self.flank
    }

    /// The map.
    pub const fn map(&self) -> &LashMap<K, V> {
        &self.map
    }

    /// The lash at a place.
    fn look_up(&mut self, at: [i32; 2]) -> u32 {
        let (steps, quiet_steps) = self.map.look_up(at);
        self.looked_up_at = at;
        self.quiet_steps = quiet_steps;
        steps
    }
}

impl<const N: usize, K: AsRef<[i32]>, V: AsRef<[u32]>> Lash<N> for MappedBacklash<K, V> {
    const VARIES: bool = true;

    fn take_up(&mut self, _: usize, direction: i8, load: &[i32; N]) -> u32 {
        let Some(flank) = Flank::towards(direction) else {
            return 0;
        };
        let before = core::mem::replace(&mut self.flank, flank);
        match (before, flank) {
            (Flank::Positive, Flank::Negative) => {
                self.held_steps = self.look_up(self.map.place(load));
                self.held_steps
            }
            // What the motor is before the load, wherever that was looked up.
            (Flank::Negative, Flank::Positive) => self.held_steps,
            (Flank::Unknown, Flank::Negative) => {
                // The motor is where it was, so the play lies on the other side of it.
                self.held_steps = self.look_up(self.map.place(load));
                self.origin = self.held_steps.cast_signed();
                0
            }
            _ => 0,
        }
    }

    #[inline]
    fn follow(&mut self, load: &[i32; N]) -> i32 {
        if self.flank != Flank::Negative {
            return 0;
        }
        let at = self.map.place(load);
        let is_near = at
            .iter()
            .zip(self.looked_up_at)
            .all(|(at, looked_up)| at.abs_diff(looked_up) <= self.quiet_steps);
        if is_near {
            return 0;
        }
        let steps = self.look_up(at);
        let before = core::mem::replace(&mut self.held_steps, steps);
        // Both below 2^20. More lash: further before the load, so backwards.
        before.cast_signed().wrapping_sub(steps.cast_signed())
    }

    fn is_free(&self) -> bool {
        self.map.is_free()
    }
}
