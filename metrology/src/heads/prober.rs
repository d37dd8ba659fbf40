//! The interface of measuring routines to a machine.

use super::view::View;
use crate::error::Error;
use husillo_probe::{Edge, UnitVector};

/// A machine that moves a probe in straight lines. Positions are those of the centre of the tip in
/// nm, on the axes of the machine. The position of a missing axis is 0. If the length of a count is
/// not known, positions are in counts instead of nm.
pub trait Prober {
    /// The present position.
    ///
    /// # Errors
    ///
    /// No answer.
    fn position(&mut self) -> Result<[i64; 3], Error>;

    /// Moves to the goal along a straight path. Returns the position at which the axes come to
    /// rest.
    ///
    /// # Errors
    ///
    /// [`Error`]. If the goal is outside of the travel, nothing moves.
    fn go_to(&mut self, goal_nm: [i64; 3]) -> Result<[i64; 3], Error>;

    /// Moves to the goal in a guarded move. A contact is a collision, but the axes stop gently,
    /// within the over-travel of the probe. See [`Approach::Guarded`](super::Approach::Guarded).
    ///
    /// # Errors
    ///
    /// Those of [`go_to`](Self::go_to).
    fn guarded_to(&mut self, goal_nm: [i64; 3]) -> Result<[i64; 3], Error>;

    /// Moves to the goal with at most this speed along the path.
    ///
    /// # Errors
    ///
    /// Those of [`go_to`](Self::go_to).
    fn feed_to(&mut self, goal_nm: [i64; 3], nm_per_min: u64) -> Result<[i64; 3], Error>;

    /// Moves towards a goal along a straight path until the contact is made or broken. Then it
    /// brakes, and stays at the position where it comes to rest. The speed along the path is at
    /// most `nm_per_min`, and at most that of a search.
    ///
    /// # Errors
    ///
    /// [`Error`]. Nothing moves if the goal is outside of the travel, or if the contact already
    /// has the wanted state at the start.
    fn probe_to(
        &mut self,
        goal_nm: [i64; 3],
        nm_per_min: u64,
        until: Edge,
    ) -> Result<Probed, Error>;

    /// Whether there was a collision. Then no result is valid.
    fn has_collided(&self) -> bool;

    /// Sets the view by which messages contain positions instead of readings.
    fn see_as(&mut self, _: &View) {}

    /// Touches from the present position, within a distance of `distance_nm`. Backs off and returns
    /// the mean of the latched positions.
    ///
    /// # Errors
    ///
    /// [`Error`], including a failure of the probing cycle.
    fn touch(&mut self, direction: &UnitVector, distance_nm: u64) -> Result<Touched, Error>;
}

/// The end of a move that watches the contact.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Probed {
    /// Position of the centre of the tip when the contact changed. It includes the pre-travel.
    /// `None`: the contact did not change.
    pub changed_nm: Option<[i64; 3]>,
    /// The position at which the machine comes to rest: the braking distance beyond the change, or
    /// the goal.
    pub at_nm: [i64; 3],
}

/// A contact.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Touched {
    /// Latched position of the centre of the tip, mean of the slow touches. It includes the
    /// pre-travel, which [`Tip::centre_nm`](husillo_probe::Tip::centre_nm) removes.
    pub centre_nm: [i64; 3],
    /// Number of slow touches in the mean.
    pub touches: u8,
    /// Distance between the nearest and the farthest slow touch.
    pub spread_nm: i64,
}
