//! The signal of the derivative.

use crate::number::Word;

/// The signal of the derivative: the derivative is the difference of its last two samples.
/// Implemented by [`OfError`] and [`OfMeasurement`].
pub trait Derivative {
    /// The signal.
    #[doc(hidden)]
    fn source<W: Word>(error: W, measured: W) -> W;
}

/// Derivative of the error. A step of the target causes a kick of the output.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct OfError;

/// Derivative of the negated measurement. A step of the target causes no kick.
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
