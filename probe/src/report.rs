//! Inputs and outputs of a probing cycle.

use crate::UnitVector;

/// The state of the machine in one tick.
#[derive(Copy, Clone, Eq, PartialEq, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Input {
    /// Position of the axes.
    pub position: [i64; 3],
    /// The debounced contact. `true` is closed.
    pub contact: bool,
    /// Position of the axes at the last change of `contact`
    /// ([`Latched::position`](crate::Latched::position), or the capture of the axis controller).
    /// The cycle reads it only in the tick in which it sees the change. Without a latch, pass
    /// `position`. A latched position that is off the search by more than the over-travel fails
    /// with [`Failure::NotLatched`].
    pub latched: [i64; 3],
    /// Whether the last request is carried out: the axes stand at the target or have stopped. It
    /// must be `false` from the answer with a [`Request::Move`] or [`Request::Stop`] until then.
    pub still: bool,
}

/// A request of the cycle to the machine.
#[derive(Copy, Clone, Eq, PartialEq, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Request {
    /// Start a straight move to `target`. It replaces the previous request.
    Move {
        /// The target.
        target: [i64; 3],
        /// The speed, in the unit of the plan.
        speed: u32,
    },
    /// Brake at the deceleration of the machine.
    Stop,
    /// Continue with the last request.
    Wait,
    /// The cycle is over and has a result. Repeated in each tick.
    Done(Measurement),
    /// The cycle is over without a result, and the axes stand. Repeated in each tick.
    Failed(Failure),
}

/// The result of a probing cycle.
#[derive(Copy, Clone, Eq, PartialEq, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Measurement {
    /// The latched position, not compensated: mean of the slow touches, each coordinate rounded to
    /// the nearest.
    pub touch: Touch,
    /// Number of touches in the mean.
    pub touches: u8,
    /// Difference between the farthest and the nearest touch along the direction of travel.
    pub spread: i64,
    /// Largest distance beyond a contact, along the direction of travel.
    pub over_travel: i64,
}

/// A latched position and its direction of travel: the input of compensation and calibration.
#[derive(Copy, Clone, Eq, PartialEq, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Touch {
    /// Position of the axes at the instant of contact.
    pub position: [i64; 3],
    /// The direction of travel.
    pub direction: UnitVector,
}

/// Failure of a probing cycle.
///
/// After every failure except [`ContactAtStart`](Failure::ContactAtStart) the probe has backed off,
/// if the plan has a back-off distance.
#[derive(Copy, Clone, Eq, PartialEq, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Failure {
    /// In contact before the first move, or not in contact if the plan looks for the end of a
    /// contact.
    ContactAtStart,
    /// Contact on the move to the approach point: an obstacle.
    ContactInApproach,
    /// No contact within the search.
    NoContact,
    /// The contact was made, but the latched position is not on the search. It belongs to another
    /// contact.
    NotLatched,
    /// The contact broke before the axes stood still, or a slow touch did not find it again.
    LostContact,
    /// The axes moved farther beyond the contact than the plan allows.
    OverTravel,
    /// Still in contact after backing off.
    StuckContact,
}

impl core::fmt::Display for Failure {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str(match self {
            Failure::ContactAtStart => "contact at start",
            Failure::ContactInApproach => "contact during the move to the approach point",
            Failure::NoContact => "no contact",
            Failure::NotLatched => "contact, not latched",
            Failure::LostContact => "contact lost",
            Failure::OverTravel => "over-travel limit passed",
            Failure::StuckContact => "contact still made after backing off",
        })
    }
}

impl core::error::Error for Failure {}
