//! Plan of a probing cycle.

use crate::{Edge, UnitVector};

/// Plan of one probing cycle: positions, speeds, number of touches.
///
/// Positions and lengths are in nm or counts, as the axes use them. Speeds are in the same unit per
/// second, or in any other unit: the cycle only passes them on in
/// [`Request::Move`](crate::Request::Move).
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
    /// Start of the search.
    pub approach: [i64; 3],
    /// Direction of travel of the search, any direction.
    pub direction: UnitVector,
    /// Length of the search from `approach`, up to 2^32 - 1.
    pub search: u32,
    /// Largest distance beyond a contact in which the axes must stop.
    pub over_travel: u32,
    /// Distance from a contact at which the next touch begins and the cycle ends. 0: the cycle ends
    /// where the axes stop.
    pub back_off: u32,
    /// Number of slow touches to average. 0: the contact of the search is the result.
    pub touches: u8,
    /// Speed to `approach`.
    pub travel_speed: u32,
    /// Speed of the search.
    pub probing_speed: u32,
    /// Speed of the slow touches.
    pub slow_speed: u32,
    /// Speed of backing off.
    pub back_off_speed: u32,
    /// The edge to find. [`Edge::Made`] is a touch. [`Edge::Broken`] (G38.4, G38.5) begins in
    /// contact and ends free of it.
    pub until: Edge,
}

/// Error of a plan that cannot be carried out.
#[derive(Copy, Clone, Eq, PartialEq, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum PlanError {
    /// The search length is 0.
    NoSearch,
    /// There are slow touches but no back-off distance.
    NoBackOff,
    /// A required speed is 0.
    NoSpeed,
}

impl Plan {
    /// Checks that the plan can be carried out.
    ///
    /// # Errors
    /// Fails with the [`PlanError`] of the first missing value.
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
            PlanError::NoSearch => "the search length of the probing cycle is 0",
            PlanError::NoBackOff => "slow touches need a back-off distance",
            PlanError::NoSpeed => "a speed of the probing cycle is 0",
        })
    }
}

impl core::error::Error for PlanError {}
