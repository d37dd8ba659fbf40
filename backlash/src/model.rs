//! The interface of backlash models: the backlash of an axis, and its engaged flank.

/// The flank of the screw's thread that carries the nut: the direction of the last motion.
#[derive(Copy, Clone, Eq, PartialEq, Hash, Debug, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Flank {
    /// Unknown: the axis has not moved since power-up.
    #[default]
    Unknown,
    /// The last motion was positive.
    Positive,
    /// The last motion was negative.
    Negative,
}

impl Flank {
    /// Returns the flank that a motion with the sign of `direction` engages. `None` for 0.
    #[must_use]
    pub const fn towards(direction: i8) -> Option<Flank> {
        match direction {
            0 => None,
            1.. => Some(Flank::Positive),
            ..0 => Some(Flank::Negative),
        }
    }
}

/// The backlash of one axis of a machine with `N` axes, and the direction of its last
/// motion.
///
/// [`Backlash`](crate::Backlash) has one value, [`MappedBacklash`](crate::MappedBacklash) a map.
/// For another model, implement this trait.
///
/// # Examples
/// ```
/// use husillo_backlash::{Flank, BacklashModel};
///
/// /// X has more backlash in the second half of the travel of Y.
/// struct Worn { flank: Flank }
///
/// impl BacklashModel<2> for Worn {
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
pub trait BacklashModel<const N: usize> {
    /// Whether the backlash may change while the axis does not reverse. Then
    /// [`BacklashModel::follow`] is called after every event. Otherwise there is no cost.
    const VARIES: bool = false;

    /// Returns the take-up in motor steps before a step with the sign of `direction`. `load` has
    /// the positions of all axes, and `axis` is the number of this one.
    ///
    /// It is 0 unless the axis reverses, and for `direction` 0. The new direction is stored, so the
    /// caller makes the returned steps. A caller may leave out calls for further steps in one
    /// direction.
    fn take_up(&mut self, axis: usize, direction: i8, load: &[i32; N]) -> u32;

    /// Returns the signed motor steps that are due because the backlash at `load` differs from that
    /// at the last call, or at the last reversal. The load does not move in them.
    ///
    /// An event of a machine moves every axis by at most one step. A model that returns more than
    /// one step for such a move stops the path for them.
    fn follow(&mut self, load: &[i32; N]) -> i32 {
        let _ = load;
        0
    }

    /// Whether the axis never has a take-up, so that it may reverse without a stop. By default it
    /// may have one.
    fn is_free(&self) -> bool {
        false
    }
}
