//! The seam: how much play an axis has, and which side of it is closed.

/// Which flank of the screw's thread carries the nut: the direction of the last motion.
#[derive(Copy, Clone, Eq, PartialEq, Hash, Debug, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
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

/// The lash of one axis of a machine of `N`, with the memory of the direction it moved last.
///
/// [`Backlash`](crate::Backlash) has one value, [`MappedBacklash`](crate::MappedBacklash) a map; a
/// machine with another law implements this itself.
///
/// ```
/// use husillo_backlash::{Flank, Lash};
///
/// /// X has more play in the second half of the travel of Y.
/// struct Worn { flank: Flank }
///
/// impl Lash<2> for Worn {
///     fn take_up(&mut self, _: usize, direction: i8, load: &[i32; 2]) -> u32 {
///         let Some(flank) = Flank::towards(direction) else { return 0 };
///         let turned = self.flank != Flank::Unknown && self.flank != flank;
///         self.flank = flank;
///         match (turned, load[1] >= 5000) {
///             (false, _) => 0,
///             (true, false) => 10,
///             (true, true) => 14,
///         }
///     }
/// }
///
/// let mut axis = Worn { flank: Flank::Positive };
/// let owed = [(1, 6000), (-1, 6000), (-1, 6000)].map(
///     |(direction, y)| axis.take_up(0, direction, &[0, y])
/// );
/// assert_eq!(owed, [0, 14, 0]);
/// ```
pub trait Lash<const N: usize> {
    /// Whether the lash under the nut may change without the axis turning round: then
    /// [`Lash::follow`] is asked after every event. Where it may not, that costs nothing.
    const VARIES: bool = false;

    /// Motor steps owed before a step in the direction of the sign of `direction`, with the load of
    /// every axis at `load`; this axis is number `axis` of them.
    ///
    /// 0 unless the axis turns round, and for `direction` 0; the new direction is remembered, so
    /// the caller makes the steps that this returns. A caller may leave out calls for further steps
    /// in one direction.
    fn take_up(&mut self, axis: usize, direction: i8, load: &[i32; N]) -> u32;

    /// Motor steps owed, signed, because the lash under the nut is another at `load` than where
    /// this was asked last, or the axis turned round last. The load does not move in them.
    ///
    /// Steps of a machine move every axis by one at most; a model that owes more than one step for
    /// such a move stops the path for them.
    fn follow(&mut self, load: &[i32; N]) -> i32 {
        let _ = load;
        0
    }

    /// Whether the axis never owes anything, so that it may turn round without a stop. Unless a
    /// model knows, it may.
    fn is_free(&self) -> bool {
        false
    }
}
