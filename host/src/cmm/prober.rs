//! What measuring routines ask of a machine.

use super::trouble::Trouble;
use husillo_probe::UnitVector;

/// What carries a probe in straight lines. Positions are those of the tip's centre in nm, on the axes of the machine; an axis that is
/// not there stays 0. Where nobody knows the way of a count, a count stands for a nm.
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

    /// Touches from where it stands, at most so far; backs off and returns the mean of what was latched.
    ///
    /// # Errors
    ///
    /// [`Trouble`], the probing cycle's own among them.
    fn touch(&mut self, direction: &UnitVector, way_nm: u64) -> Result<Touched, Trouble>;
}

/// A contact.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Touched {
    /// Where the machine had the centre of the tip when it was latched, mean of the slow touches: with the pre-travel in it, which
    /// [`Tip::centre_nm`](husillo_probe::Tip::centre_nm) takes off.
    pub centre_nm: [i64; 3],
    /// Slow touches averaged.
    pub touches: u8,
    /// The farthest of them less the nearest.
    pub spread_nm: i64,
}
