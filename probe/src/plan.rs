//! What a probing cycle is to do.

use crate::{Edge, UnitVector};

/// One probing cycle: where, how fast, how often.
///
/// Positions and lengths are in nm or counts, whichever the axes use, speeds in the same unit a
/// second (or in any other unit: they are only handed on in
/// [`Request::Move`](crate::Request::Move)).
///
/// ```text
///            travel        search, probing speed            over-travel
///  start ───────────► approach ───────────────────► contact ──► stop
///                                     back off ◄───────┴──────────┘
///                                            └────────► contact   slowly, `touches` times
/// ```
#[derive(Copy, Clone, Eq, PartialEq, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Plan {
    /// Where the search begins.
    pub approach: [i64; 3],
    /// Direction of travel of the search, any direction.
    pub direction: UnitVector,
    /// How far from `approach` the contact is looked for, up to 2^32 - 1.
    pub search: u32,
    /// How far beyond a contact the axes may go until they stand.
    pub over_travel: u32,
    /// How far before a contact the next touch begins and the cycle ends. 0: the cycle ends where
    /// the axes stop.
    pub back_off: u32,
    /// Slow touches to average; 0: the contact of the search is the result.
    pub touches: u8,
    /// Speed to `approach`.
    pub travel_speed: u32,
    /// Speed of the search.
    pub probing_speed: u32,
    /// Speed of the slow touches.
    pub slow_speed: u32,
    /// Speed of backing off.
    pub back_off_speed: u32,
    /// The edge looked for: [`Edge::Made`] is a touch, [`Edge::Broken`] (G38.4, G38.5) begins in
    /// contact and ends free of it.
    pub until: Edge,
}

/// A plan that cannot be carried out.
#[derive(Copy, Clone, Eq, PartialEq, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum PlanError {
    /// There is no way to search.
    NoSearch,
    /// Slow touches, but nothing to back off for them.
    NoBackOff,
    /// A speed that is needed is 0.
    NoSpeed,
}

impl Plan {
    /// Whether the plan can be carried out.
    ///
    /// # Errors
    ///
    /// [`PlanError`] names the first thing missing.
    pub const fn check(&self) -> Result<(), PlanError> {
        let is_still = self.travel_speed == 0
            || self.probing_speed == 0
            || (self.touches > 0 && self.slow_speed == 0)
            || (self.back_off > 0 && self.back_off_speed == 0);
        if self.search == 0 {
            Err(PlanError::NoSearch)
        } else if self.touches > 0 && self.back_off == 0 {
            Err(PlanError::NoBackOff)
        } else if is_still {
            Err(PlanError::NoSpeed)
        } else {
            Ok(())
        }
    }
}

impl core::fmt::Display for PlanError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str(match self {
            PlanError::NoSearch => "no way to search for contact",
            PlanError::NoBackOff => "slow touches need a way to back off",
            PlanError::NoSpeed => "a speed of the probing cycle is 0",
        })
    }
}

impl core::error::Error for PlanError {}
