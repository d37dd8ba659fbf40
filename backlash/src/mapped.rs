//! Backlash that varies with the position.

use crate::{BacklashMap, BacklashModel, Flank};

/// An axis whose backlash is looked up in a [`BacklashMap`] as the tool moves.
///
/// On the positive flank the motor is at the position of the load. On the negative flank it is
/// ahead of the load, in the negative direction, by the backlash at that position. So there is a
/// take-up when the axis reverses. On the negative flank there is also a step whenever the backlash
/// at the nut changes, even while this axis stands still and others move.
///
/// # Examples
/// ```
/// use husillo_backlash::{Compensator, Flank, BacklashMap, MappedBacklash};
///
/// // X has 10 steps of backlash at Y 0 and 14 at Y 40; Y has none.
/// let x = BacklashMap::new([0, 1], [&[0][..], &[0, 40]], &[10, 14][..])?;
/// let y = BacklashMap::new([0, 1], [&[0][..], &[0]], &[0][..])?;
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
    map: BacklashMap<K, V>,
    flank: Flank,
    /// Motor steps between motor and load on the negative flank.
    held_steps: u32,
    /// Motor position less load position on the positive flank.
    origin: i32,
    /// The position of the last look-up, and the distance within which the backlash stays the same.
    looked_up_at: [i32; 2],
    quiet_steps: u32,
}

impl<K: AsRef<[i32]>, V: AsRef<[u32]>> MappedBacklash<K, V> {
    /// Creates an axis with its map and its engaged flank, with the load at machine zero. On the
    /// positive flank the motor is at its zero there.
    ///
    /// With [`Flank::Unknown`] the first motion is not compensated, because it finds the flank.
    #[must_use]
    pub fn new(map: BacklashMap<K, V>, flank: Flank) -> Self {
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

    /// Returns the load position with the motor at `motor`, for the engaged flank and the last
    /// backlash.
    #[must_use]
    pub const fn load_position(&self, motor: i32) -> i32 {
        let offset = match self.flank {
            Flank::Negative => self.origin.wrapping_sub(self.held_steps.cast_signed()),
            Flank::Positive | Flank::Unknown => self.origin,
        };
        motor.wrapping_sub(offset)
    }

    /// Returns the engaged flank.
    #[must_use]
    pub const fn flank(&self) -> Flank {
        self.flank
    }

    /// Returns the map.
    pub const fn map(&self) -> &BacklashMap<K, V> {
        &self.map
    }

    /// Returns the backlash at a position.
    fn look_up(&mut self, at: [i32; 2]) -> u32 {
        let (steps, quiet_steps) = self.map.look_up(at);
        self.looked_up_at = at;
        self.quiet_steps = quiet_steps;
        steps
    }
}

impl<const N: usize, K: AsRef<[i32]>, V: AsRef<[u32]>> BacklashModel<N> for MappedBacklash<K, V> {
    const VARIES: bool = true;

    fn take_up(&mut self, _: usize, direction: i8, load: &[i32; N]) -> u32 {
        let Some(flank) = Flank::towards(direction) else {
            return 0;
        };
        let before = core::mem::replace(&mut self.flank, flank);
        match (before, flank) {
            (Flank::Positive, Flank::Negative) => {
                self.held_steps = self.look_up(self.map.position(load));
                self.held_steps
            }
            // The distance between motor and load does not change while the axis stands.
            (Flank::Negative, Flank::Positive) => self.held_steps,
            (Flank::Unknown, Flank::Negative) => {
                // The motor has not moved, so the backlash is on its other side.
                self.held_steps = self.look_up(self.map.position(load));
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
        let at = self.map.position(load);
        let is_near = at
            .iter()
            .zip(self.looked_up_at)
            .all(|(at, looked_up)| at.abs_diff(looked_up) <= self.quiet_steps);
        if is_near {
            return 0;
        }
        let steps = self.look_up(at);
        let before = core::mem::replace(&mut self.held_steps, steps);
        // Both are below 2^20. With more backlash the motor moves back, away from the load.
        before.cast_signed().wrapping_sub(steps.cast_signed())
    }

    fn is_free(&self) -> bool {
        self.map.is_free()
    }
}
