//! Why a statement of a routine has no result.

use crate::Error;
use husillo_probe::FitError;
use std::fmt;

/// Why a statement has no result.
#[derive(Debug)]
pub enum Failure {
    /// The machine has failed.
    Machine(Error),
    /// The touches do not determine the feature.
    Fit(FitError),
    /// The points were touched from both sides.
    BothSides,
    /// The features determine no frame.
    NoFrame,
    /// The faces or lines are parallel.
    Parallel,
    /// A direction has the length 0.
    NoDirection,
    /// The feature of this name has no position: a distance or an angle.
    NoPosition(String),
    /// A feature of this name has no result.
    NotMeasured(String),
}

impl fmt::Display for Failure {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Machine(error) => error.fmt(out),
            Self::Fit(error) => error.fmt(out),
            Self::BothSides => out.write_str("points touched from inside and from outside"),
            Self::NoFrame => out.write_str("plane, line and point determine no frame"),
            Self::NoPosition(name) => write!(out, "`{name}` has no position"),
            Self::Parallel => out.write_str("the two are parallel"),
            Self::NotMeasured(name) => write!(out, "`{name}` was not measured"),
            Self::NoDirection => out.write_str("a direction of length 0"),
        }
    }
}

impl std::error::Error for Failure {}

impl From<Error> for Failure {
    fn from(error: Error) -> Self {
        Self::Machine(error)
    }
}

impl From<FitError> for Failure {
    fn from(error: FitError) -> Self {
        Self::Fit(error)
    }
}
