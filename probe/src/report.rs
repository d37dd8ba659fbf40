//! What goes in and out of a probing cycle.

use crate::UnitVector;

/// What the machine tells the cycle each tick.
#[derive(Copy, Clone, Eq, PartialEq, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Input {
    /// Where the axes are.
    pub position: [i64; 3],
    /// The debounced contact, `true` is closed.
    pub contact: bool,
    /// Where the axes were at the last change of `contact`
    /// ([`Latched::position`](crate::Latched::position), or what the axis controller captured).
    /// Read only in the tick in which the cycle sees the change; without a latch, give `position`.
    /// What is more than the over-travel off the way of the search is refused as
    /// [`Failure::NotLatched`].
    pub latched: [i64; 3],
    /// The last request is carried out: the axes stand at the target, or they have stopped. It must
    /// be `false` from the answer with a [`Request::Move`] or [`Request::Stop`] until that is so.
    pub still: bool,
}

/// What the cycle wants of the machine.
#[derive(Copy, Clone, Eq, PartialEq, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Request {
    /// Begin to move in a straight line to `target`, in place of what was requested before.
    Move {
        /// Where to.
        target: [i64; 3],
        /// How fast, in the plan's unit.
        speed: u32,
    },
    /// Brake at the machine's own rate.
    Stop,
    /// Carry on with the last request.
    Wait,
    /// The cycle is over and has a result. Said again each tick.
    Done(Measurement),
    /// The cycle is over without a result, the axes stand. Said again each tick.
    Failed(Failure),
}

/// The result of a probing cycle.
#[derive(Copy, Clone, Eq, PartialEq, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Measurement {
    /// The latched position, mean of the slow touches, each coordinate to the nearest; not
    /// compensated.
    pub touch: Touch,
    /// How many touches went into it.
    pub touches: u8,
    /// The farthest touch less the nearest along the direction of travel.
    pub spread: i64,
    /// The longest way from a contact, along the direction of travel, that was seen.
    pub over_travel: i64,
}

/// A latched position and how the probe came there: what compensation and calibration want to know.
#[derive(Copy, Clone, Eq, PartialEq, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Touch {
    /// Where the axes were at the instant of contact.
    pub position: [i64; 3],
    /// The direction of travel.
    pub direction: UnitVector,
}

/// Why a probing cycle has no result.
///
/// After each of them but [`ContactAtStart`](Failure::ContactAtStart) the probe has backed off
/// where the plan has it.
#[derive(Copy, Clone, Eq, PartialEq, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Failure {
    /// In contact before the cycle has moved (or not in contact, when the plan looks for the end of
    /// one).
    ContactAtStart,
    /// Contact on the way to the approach point: something is in the way.
    ContactInApproach,
    /// No contact within the search.
    NoContact,
    /// The contact was made, but what was latched is not on the way of the search: it is of another
    /// contact.
    NotLatched,
    /// The contact broke before the axes stood, or a slow touch did not find it again.
    LostContact,
    /// The axes went farther beyond the contact than the plan allows.
    OverTravel,
    /// Still in contact after backing off.
    StuckContact,
}

impl core::fmt::Display for Failure {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str(match self {
            Failure::ContactAtStart => "contact at start",
            Failure::ContactInApproach => "contact on the way to the approach point",
            Failure::NoContact => "no contact",
            Failure::NotLatched => "contact, not latched",
            Failure::LostContact => "contact lost",
            Failure::OverTravel => "over-travel limit passed",
            Failure::StuckContact => "contact still made after backing off",
        })
    }
}

impl core::error::Error for Failure {}
