//! What the integral does while the output is at a limit.

use crate::number::{Number, Word};

/// A remedy against windup: how the integral goes on, given what the output would have been.
/// Implemented by [`Clamp`], [`Conditional`] and [`BackCalculation`].
///
/// All of them keep the integral within its limits, so that the output leaves its limit in the very
/// sample in which the rest of the law pulls it away by half a last digit or more, that is when the
/// error changes sign; without a part that acts at once, as `Forward` without a proportional gain,
/// in the sample behind it.
pub trait AntiWindup<W: Word> {
    /// The next integral. `wanted` is the output before its limits, `given` the one after; `bits`
    /// are behind the point of all wide numbers.
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
        // Limits within 2^61, steps within 2^62.
        W::within(W::plus(self.before, step), &self.limits)
    }
}

/// The integral stops at its limits. The cheapest.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Clamp;

impl<W: Word> AntiWindup<W> for Clamp {
    #[inline(always)]
    fn next(&self, sum: &Sum<W>, _bits: u32) -> W::Wide {
        sum.limited(sum.step)
    }
}

/// As [`Clamp`], and the integral holds still while the output is at a limit and the error would
/// drive it further.
///
/// Source: Astrom and Hagglund, *PID Controllers*, 2nd ed., 3.5, conditional integration.
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

/// As [`Clamp`], and what the limit cuts off the output is led back to the integral, times a gain.
///
/// Source: Astrom and Hagglund, *PID Controllers*, 2nd ed., 3.5, back-calculation and tracking; the
/// gain is T/Tt, with Tt the tracking time.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct BackCalculation<W: Word = i32> {
    /// Doubled, as all gains.
    gain: W,
}

impl<W: Word> BackCalculation<W> {
    /// Leads back the part `gain` of what is cut off, 0 to 1 as a rule, in the type of the
    /// controller's gains. `None` if it has more than 29 bits.
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
        // A gain within 2^30 times 2^31, and a step within 2^61.
        sum.limited(W::plus(sum.step, self.gain.times(cut)))
    }
}
