//! A method's own part: its next event and what the whole move adds up to.

use crate::Step;
use crate::interpolator::Totals;

/// What differs from one method to the next. [`interpolator!`] derives the public traits from it.
pub(crate) trait Method {
    /// The next event, or `None` at the end of the move and ever after.
    fn next_step(&mut self) -> Option<Step>;

    /// Events still to come.
    fn left(&self) -> u32;

    /// Sums over the whole move, whatever part of it is made.
    fn totals(&self) -> Totals;
}

/// Derives [`Iterator`], [`ExactSizeIterator`], [`FusedIterator`](core::iter::FusedIterator) and
/// [`Interpolator`](crate::Interpolator) of a type that is a [`Method`] or has one in a field.
///
/// A macro, because a blanket `impl<M: Method> Iterator for M` is not allowed: `Iterator` is
/// foreign.
macro_rules! interpolator {
    ($kind:ident $(<$axes:ident>)? $(, $field:ident)?) => {
        impl$(<const $axes: usize>)? Iterator for $kind$(<$axes>)? {
            type Item = crate::Step;

            #[inline]
            fn next(&mut self) -> Option<crate::Step> {
                crate::method::Method::next_step(&mut (*self)$(.$field)?)
            }

            #[inline]
            fn size_hint(&self) -> (usize, Option<usize>) {
                // 2^31 at most: only a 16-bit machine could not say it.
                let left = usize::try_from(crate::method::Method::left(&(*self)$(.$field)?)).ok();
                (left.unwrap_or(usize::MAX), left)
            }
        }

        impl$(<const $axes: usize>)? ExactSizeIterator for $kind$(<$axes>)? {}
        impl$(<const $axes: usize>)? core::iter::FusedIterator for $kind$(<$axes>)? {}

        impl$(<const $axes: usize>)? crate::Interpolator for $kind$(<$axes>)? {
            #[inline]
            fn remaining(&self) -> u32 {
                crate::method::Method::left(&(*self)$(.$field)?)
            }

            fn total_sweep(&self) -> u64 {
                crate::method::Method::totals(&(*self)$(.$field)?).total_sweep
            }

            fn largest_sweep(&self) -> u32 {
                crate::method::Method::totals(&(*self)$(.$field)?).largest_sweep
            }
        }
    };
}

pub(crate) use interpolator;
