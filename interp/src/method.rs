//! The part that each method implements: its next event and the sums of the whole move.

use crate::Step;
use crate::interpolator::Totals;

/// The differences between methods. [`interpolator!`] derives the public traits from it.
pub(crate) trait Method {
    /// Returns the next event, or `None` at the end of the move and after it.
    fn next_step(&mut self) -> Option<Step>;

    /// Number of events still to come.
    fn left(&self) -> u32;

    /// Sums over the whole move, at any point of it.
    fn totals(&self) -> Totals;
}

/// Derives [`Iterator`], [`ExactSizeIterator`], [`FusedIterator`](core::iter::FusedIterator) and
/// [`Interpolator`](crate::Interpolator) for a type that is a [`Method`] or has one in a field.
///
/// This is a macro because `impl<M: Method> Iterator for M` is not allowed: `Iterator` is a foreign
/// trait.
macro_rules! interpolator {
    ($kind:ident $(<$axes:ident>)? $(, $field:ident)?) => {
        $crate::method::interpolator!(
            #[inline] [$(const $axes: usize)?] $kind$(<$axes>)? $(, $field)?
        );
    };
    (#[$inline:meta] [$($generics:tt)*] $kind:ty $(, $field:ident)?) => {
        impl<$($generics)*> Iterator for $kind {
            type Item = crate::Step;

            #[$inline]
            fn next(&mut self) -> Option<crate::Step> {
                crate::method::Method::next_step(&mut (*self)$(.$field)?)
            }

            #[inline]
            fn size_hint(&self) -> (usize, Option<usize>) {
                // At most 2^31; only a 16-bit machine could not represent it.
                let left = usize::try_from(crate::method::Method::left(&(*self)$(.$field)?)).ok();
                (left.unwrap_or(usize::MAX), left)
            }
        }

        impl<$($generics)*> ExactSizeIterator for $kind {}
        impl<$($generics)*> core::iter::FusedIterator for $kind {}

        impl<$($generics)*> crate::Interpolator for $kind {
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
