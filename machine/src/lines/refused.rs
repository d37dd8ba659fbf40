//! Why a line was not taken.

use core::fmt;

use husillo_gcode::{Error, Nm};

/// Why [`Machine::line`](crate::Machine::line) did not take a line. Nothing has changed.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum Refused {
    /// The line before still has commands to begin: pull events, then offer this line again.
    Busy,
    /// The line is wrong, with the place in it.
    Program(Error),
    /// The line means a move this machine cannot make.
    Move(MoveError),
}

/// Why a move cannot be made on this machine.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum MoveError {
    /// The path leaves the travel of an axis.
    Travel {
        /// Number of the axis.
        axis: usize,
        /// The farthest position on the path, machine frame.
        position: Nm,
        /// The limit it passes, machine frame.
        limit: Nm,
    },
    /// A position of this axis is beyond 2^31 steps.
    Reach {
        /// Number of the axis.
        axis: usize,
    },
    /// An arc in a plane whose axes have different steps.
    UnequalSteps,
    /// An arc whose radii at start and end differ by more than the machine's arc tolerance.
    ArcTolerance {
        /// The difference.
        mismatch: Nm,
        /// What the machine allows.
        tolerance: Nm,
    },
    /// An arc with a radius of 2^28 steps or more.
    ArcTooLarge,
    /// A command for which this machine has no means.
    Unsupported(Means),
}

/// What a command would need.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Means {
    /// G5, G5.1: an interpolator of splines.
    Splines,
    /// G33, G76, G95: an encoder on the spindle.
    SpindleFeedback,
    /// G96: a spindle whose speed follows a diameter.
    SurfaceSpeed,
    /// M19: a spindle that can be held at an angle.
    SpindleAngle,
    /// G38: a probe.
    Probe,
    /// G41, G42: a stage of radius compensation before the machine.
    RadiusCompensation,
    /// M60, M62 to M68: inputs, outputs, pallets.
    InputsAndOutputs,
}

impl Means {
    /// What it is, in words.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Splines => "splines",
            Self::SpindleFeedback => "moves synchronised with the spindle",
            Self::SurfaceSpeed => "constant surface speed",
            Self::SpindleAngle => "a spindle held at an angle",
            Self::Probe => "a probe",
            Self::RadiusCompensation => "cutter compensation",
            Self::InputsAndOutputs => "inputs and outputs",
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
            Self::UnequalSteps => f.write_str("arc in a plane of unequal steps"),
            Self::ArcTolerance { .. } => f.write_str("the end point is not on the arc"),
            Self::ArcTooLarge => f.write_str("arc radius too large"),
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
