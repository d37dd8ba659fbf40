//! Anti-windup: the integral while the output is at a limit.

use crate::number::{Number, Word};

/// An anti-windup method: computes the next integral from the unlimited and the limited output.
/// Implemented by [`Clamp`], [`Conditional`] and [`BackCalculation`].
///
/// All methods keep the integral within its limits. The output therefore leaves its limit in the
/// sample in which the error changes sign, if the immediate parts of the law pull it away by half a
/// last digit or more. Without an immediate part (`Forward` without a proportional gain) it leaves
/// in the next sample.
pub trait AntiWindup<W: Word> {
    /// Returns the next integral. `sum` holds the output before its limits (`wanted`) and after
    /// them (`given`). All wide numbers have `bits` fractional bits.
    #[doc(hidden)]
    fn next(&self, sum: &Sum<W>, bits: u32) -> W::Wide;
}

/// One step of the integral.
#[doc(hidden)]
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Sum<W: Word> {
    pub(crate) before: W::Wide,
    pub(crate) step: W::Wide,
    pub(crate) limits: W::Span,
    pub(crate) wanted: W::Wide,
    pub(crate) given: W::Wide,
}

impl<W: Word> Sum<W> {
    #[inline(always)]
    fn limited(&self, step: W::Wide) -> W::Wide {
        // Limits are within 2^61, steps within 2^62.
        W::within(W::plus(self.before, step), &self.limits)
    }
}

/// The integral stops at its limits. The cheapest method.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Clamp;

impl<W: Word> AntiWindup<W> for Clamp {
    #[inline(always)]
    fn next(&self, sum: &Sum<W>, _bits: u32) -> W::Wide {
        sum.limited(sum.step)
    }
}

/// Same as [`Clamp`]. In addition the integral holds while the output is at a limit and the error
/// would drive it further.
///
/// # Source
/// Astrom and Hagglund, *PID Controllers*, 2nd ed., 3.5, conditional integration.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Conditional;

impl<W: Word> AntiWindup<W> for Conditional {
    #[inline(always)]
    fn next(&self, sum: &Sum<W>, _bits: u32) -> W::Wide {
        let none = W::Wide::default();
        let further = sum.wanted != sum.given && (sum.wanted > sum.given) == (sum.step > none);
        sum.limited(if further { none } else { sum.step })
    }
}

/// Same as [`Clamp`]. In addition the part of the output that the limit cuts off is fed back to the
/// integral, times a gain.
///
/// # Source
/// Astrom and Hagglund, *PID Controllers*, 2nd ed., 3.5, back-calculation and tracking. The gain is
/// T/Tt, with Tt the tracking time.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct BackCalculation<W: Word = i32> {
    /// Stored doubled, as all gains are.
    gain: W,
}

impl<W: Word> BackCalculation<W> {
    /// Feeds back the part `gain` of the cut, usually 0 to 1, in the type of the controller's
    /// gains. Returns `None` if the magnitude of `gain` is more than 2^29 last digits (`f32`: if it
    /// is not finite).
    pub fn new<G: Number<Word = W>>(gain: G) -> Option<Self> {
        let [gain] = W::gains([gain.to_word()])?;
        Some(Self { gain })
    }
}

impl<W: Word> AntiWindup<W> for BackCalculation<W> {
    #[inline(always)]
    fn next(&self, sum: &Sum<W>, bits: u32) -> W::Wide {
        if sum.wanted == sum.given {
            return sum.limited(sum.step);
        }
        let cut = W::rounded(W::less(sum.given, sum.wanted), bits);
        // The product is at most 2^30 * 2^31, and the step is within 2^61.
        sum.limited(W::plus(sum.step, self.gain.times(cut)))
    }
}
