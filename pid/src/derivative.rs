//! What the derivative is taken of.

use crate::number::Word;

/// The signal whose difference of two samples is the derivative. Implemented by [`OfError`] and
/// [`OfMeasurement`].
pub trait Derivative {
    /// The signal.
    #[doc(hidden)]
    fn source<W: Word>(error: W, measured: W) -> W;
}

/// The derivative is of the error: a step of the target kicks.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct OfError;

/// The derivative is of the measurement, negated: a step of the target does not kick.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct OfMeasurement;

impl Derivative for OfError {
    #[inline(always)]
    fn source<W: Word>(error: W, _measured: W) -> W {
        error
    }
}

impl Derivative for OfMeasurement {
    #[inline(always)]
    fn source<W: Word>(_error: W, measured: W) -> W {
        W::default().minus(measured)
    }
}
