//! What measuring routines ask of a machine.

use super::view::View;
use crate::trouble::Trouble;
use husillo_probe::{Edge, UnitVector};

/// What carries a probe in straight lines. Positions are those of the tip's centre in nm, on the
/// axes of the machine; an axis that is not there stays 0. Where nobody knows the way of a count, a
/// count stands for a nm.
pub trait Prober {
    /// Where it is.
    ///
    /// # Errors
    ///
    /// No answer.
    fn position(&mut self) -> Result<[i64; 3], Trouble>;

    /// Goes straight there and stands; returns where.
    ///
    /// # Errors
    ///
    /// [`Trouble`]; outside of the travel nothing moves.
    fn go_to(&mut self, goal_nm: [i64; 3]) -> Result<[i64; 3], Trouble>;

    /// Goes straight there and stands, at most so fast along the path; returns where.
    ///
    /// # Errors
    ///
    /// Those of [`go_to`](Self::go_to).
    fn feed_to(&mut self, goal_nm: [i64; 3], nm_per_min: u64) -> Result<[i64; 3], Trouble>;

    /// Goes straight towards a goal, at most so fast along the path and as fast as a search, until
    /// the contact is made or broken: it brakes there and stays where it then stands.
    ///
    /// # Errors
    ///
    /// [`Trouble`]; where the contact is at the start what it should become, or the goal is outside
    /// of the travel, nothing moves.
    fn probe_to(
        &mut self,
        goal_nm: [i64; 3],
        nm_per_min: u64,
        until: Edge,
    ) -> Result<Probed, Trouble>;

    /// Whether it has met something where nothing was to be touched: what was measured is not good
    /// then.
    fn has_collided(&self) -> bool;

    /// From now on its messages name the positions that readings are called by.
    fn see_as(&mut self, _: &View) {}

    /// Touches from where it stands, at most so far; backs off and returns the mean of what was
    /// latched.
    ///
    /// # Errors
    ///
    /// [`Trouble`], the probing cycle's own among them.
    fn touch(&mut self, direction: &UnitVector, way_nm: u64) -> Result<Touched, Trouble>;
}

/// How a move that watches the contact ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Probed {
    /// Where the machine had the centre of the tip when the contact changed, with the pre-travel in
    /// it; `None`: it has not.
    pub changed_nm: Option<[i64; 3]>,
    /// Where it stands: a braking way farther, or at the goal.
    pub at_nm: [i64; 3],
}

/// A contact.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Touched {
    /// Where the machine had the centre of the tip when it was latched, mean of the slow touches:
    /// with the pre-travel in it, which [`Tip::centre_nm`](husillo_probe::Tip::centre_nm) takes
    /// off.
    pub centre_nm: [i64; 3],
    /// Slow touches averaged.
    pub touches: u8,
    /// The farthest of them less the nearest.
    pub spread_nm: i64,
}
