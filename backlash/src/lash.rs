//! The seam: how much play an axis has, and which side of it is closed.

/// Which flank of the screw's thread carries the nut: the direction of the last motion.
#[derive(Copy, Clone, Eq, PartialEq, Hash, Debug, Default)]
pub enum Flank {
    /// Not known: the axis has not moved since power-up.
    #[default]
    Unknown,
    /// The last motion was positive.
    Positive,
    /// The last motion was negative.
    Negative,
}

impl Flank {
    /// The flank that motion in the direction of the sign of `direction` engages; `None` for 0.
    #[must_use]
    pub const fn towards(direction: i8) -> Option<Flank> {
        match direction {
            0 => None,
            1.. => Some(Flank::Positive),
            ..0 => Some(Flank::Negative),
        }
    }
}

/// The lash of one axis, with the memory of the direction it moved last.
///
/// [`Backlash`](crate::Backlash) has one value; a machine with a map of regions implements this itself.
///
/// ```
/// use husillo_backlash::{Flank, Lash};
///
/// /// More play in the second half of the travel.
/// struct Worn { flank: Flank }
///
/// impl Lash for Worn {
///     fn take_up(&mut self, direction: i8, load: i32) -> u32 {
///         let Some(flank) = Flank::towards(direction) else { return 0 };
///         let turned = self.flank != Flank::Unknown && self.flank != flank;
///         self.flank = flank;
///         match (turned, load >= 5000) {
///             (false, _) => 0,
///             (true, false) => 10,
///             (true, true) => 14,
///         }
///     }
/// }
///
/// let mut axis = Worn { flank: Flank::Positive };
/// assert_eq!([axis.take_up(1, 6000), axis.take_up(-1, 6001), axis.take_up(-1, 6000)], [0, 14, 0]);
/// ```
pub trait Lash {
    /// Motor steps owed before a step in the direction of the sign of `direction`, with the load at `load`.
    ///
    /// 0 unless the axis turns round, and for `direction` 0; the new direction is remembered, so the caller makes the
    /// steps it is told. A caller may leave out calls for further steps in one direction.
    fn take_up(&mut self, direction: i8, load: i32) -> u32;

    /// Whether the axis never owes anything, so that it may turn round without a stop. Unless a model knows, it may.
    fn is_free(&self) -> bool {
        false
    }
}
