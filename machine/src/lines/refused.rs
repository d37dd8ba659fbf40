//! Reasons for refusing a line.

use core::fmt;

use husillo_gcode::{Error, Nm};

/// Reason why [`Machine::line`](crate::Machine::line) refused a line. The state is unchanged.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Refused {
    /// The previous line still has commands to begin. Pull events, then offer this line again.
    Busy,
    /// The line is wrong; the error has its column.
    Program(Error),
    /// The line requests a move that this machine cannot make.
    Move(MoveError),
}

/// Reason why this machine cannot make a move.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum MoveError {
    /// The path leaves the travel of an axis.
    Travel {
        /// Index of the axis.
        axis: usize,
        /// The farthest position on the path in the machine frame.
        position: Nm,
        /// The exceeded limit in the machine frame.
        limit: Nm,
    },
    /// A position of this axis is beyond 2^31 steps.
    Reach {
        /// Index of the axis.
        axis: usize,
    },
    /// An arc in a plane whose axes have steps of different length, for methods that need equal
    /// ones; or one step is more than 256 times the other; or it is a spiral of almost a whole
    /// turn.
    UnequalSteps,
    /// An arc whose start and end radii differ by more than the arc tolerance of the machine.
    ArcTolerance {
        /// The difference.
        mismatch: Nm,
        /// The tolerance of the machine.
        tolerance: Nm,
    },
    /// An arc with a radius of 2^28 steps or more.
    ArcTooLarge,
    /// A NURBS of more than 64 control points.
    TooManyPoints,
    /// A command that needs a function this machine does not have.
    Unsupported(Means),
}

/// Function that a command needs.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum Means {
    /// G5 to G5.3: curves.
    Splines,
    /// G33, G76, G95: a spindle encoder.
    SpindleFeedback,
    /// G33.1: a spindle with an encoder that reverses within some turns.
    RigidTapping,
    /// G96: a spindle whose speed follows a diameter.
    SurfaceSpeed,
    /// M19: a spindle that can be held at an angle.
    SpindleAngle,
    /// G38: a probe.
    Probe,
    /// G41, G42: a stage of radius compensation before the machine.
    RadiusCompensation,
    /// M62 to M68: an input or output of this number.
    InputsAndOutputs,
    /// M60: pallets.
    Pallets,
    /// M104 to M109, M140, M190: heaters and fans.
    Heaters,
    /// M52 P1: an input that scales the feed.
    AdaptiveFeed,
    /// G38 under G95: a feed per turn cannot brake at a contact.
    ProbeFeed,
}

impl Means {
    /// Name of the function.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Splines => "splines",
            Self::SpindleFeedback => "moves synchronised with the spindle",
            Self::RigidTapping => "rigid tapping",
            Self::SurfaceSpeed => "constant surface speed",
            Self::SpindleAngle => "a spindle held at an angle",
            Self::Probe => "a probe",
            Self::RadiusCompensation => "cutter compensation",
            Self::InputsAndOutputs => "an input or output of this number",
            Self::Pallets => "pallets",
            Self::Heaters => "heaters and fans",
            Self::AdaptiveFeed => "a feed from an input",
            Self::ProbeFeed => "probing at a feed per turn",
        }
    }
}

impl fmt::Display for Refused {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Busy => f.write_str("busy with the line before"),
            Self::Program(error) => error.fmt(f),
            Self::Move(error) => error.fmt(f),
        }
    }
}

impl fmt::Display for MoveError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Travel { .. } => f.write_str("target is beyond the soft limit"),
            Self::Reach { .. } => f.write_str("number too large for the axis"),
            Self::UnequalSteps => f.write_str(
                "arc whose axes have steps too different, or whose radii differ near a whole turn",
            ),
            Self::ArcTolerance { .. } => f.write_str("the end point is not on the arc"),
            Self::ArcTooLarge => f.write_str("arc radius too large"),
            Self::TooManyPoints => f.write_str("a curve of more than 64 control points"),
            Self::Unsupported(means) => write!(f, "this machine has no means for {}", means.name()),
        }
    }
}

impl core::error::Error for Refused {}
impl core::error::Error for MoveError {}

impl From<Error> for Refused {
    fn from(error: Error) -> Self {
        Self::Program(error)
    }
}

impl From<MoveError> for Refused {
    fn from(error: MoveError) -> Self {
        Self::Move(error)
    }
}
