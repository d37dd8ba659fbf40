//! Why a statement of a routine has no result.

use crate::Trouble;
use husillo_probe::FitError;
use std::fmt;

/// Why a statement has no result.
#[derive(Debug)]
pub enum Failure {
    /// On the machine.
    Machine(Trouble),
    /// What was touched is no such feature.
    Fit(FitError),
    /// Some points were touched from one side, some from the other.
    BothSides,
    /// The parts of a frame lie so that they determine none.
    NoFrame,
    /// Faces or lines that are parallel.
    Parallel,
    /// A direction that is none.
    NoDirection,
    /// A feature that has no result itself.
    NotMeasured(String),
}

impl fmt::Display for Failure {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Machine(trouble) => trouble.fmt(out),
            Self::Fit(error) => error.fmt(out),
            Self::BothSides => out.write_str("points touched from inside and from outside"),
            Self::NoFrame => out.write_str("plane, line and point determine no frame"),
            Self::Parallel => out.write_str("the two are parallel"),
            Self::NotMeasured(name) => write!(out, "`{name}` was not measured"),
            Self::NoDirection => out.write_str("a direction without length"),
        }
    }
}

impl std::error::Error for Failure {}

impl From<Trouble> for Failure {
    fn from(trouble: Trouble) -> Self {
        Self::Machine(trouble)
    }
}

impl From<FitError> for Failure {
    fn from(error: FitError) -> Self {
        Self::Fit(error)
    }
}
