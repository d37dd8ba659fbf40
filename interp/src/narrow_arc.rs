//! The general arc with 32-bit state only, for processors without room for the 64-bit case.

use crate::arc::start;
use crate::counted::Counted;
use crate::method::interpolator;
use crate::walk::{Start, Walk};
use crate::{ArcError, ArcMove};

/// An [`Arc`](crate::Arc) whose state has words of 32 bits. The steps are the same; an arc that
/// does not fit is refused with [`ArcError::Wide`].
///
/// | | |
/// | --- | --- |
/// | range | with the fraction bits of [`fraction_bits_for`](crate::fraction_bits_for) up to R = 2^25, except where the ends lie far off the circle and there are few steps |
/// | state | 96 bytes instead of 152 |
/// | cost | on a Cortex-M0 2 kB less code, and no choice of the width at every event |
/// | otherwise | as [`Arc`](crate::Arc) |
///
/// # Examples
/// ```
/// use husillo_interp::{Arc, ArcMove, Direction, NarrowArc, Rim};
///
/// let arc = ArcMove {
///     from: [500, 0],
///     to: [0, 500],
///     centre: [0, 0],
///     fraction_bits: 0,
///     direction: Direction::CounterClockwise,
///     turns: 0,
///     rim: Rim::Spiral,
/// };
/// assert!(NarrowArc::new(&arc)?.eq(Arc::new(&arc)?));
/// # Ok::<(), husillo_interp::ArcError>(())
/// ```
#[derive(Clone, Debug)]
pub struct NarrowArc {
    counted: Counted<Walk<i32>>,
    radius: u64,
}

impl NarrowArc {
    /// Prepares an arc. Walks it once to count its events and to sum its sweep.
    ///
    /// # Errors
    /// See [`ArcError`]; nothing is walked then.
    pub fn new(arc: &ArcMove) -> Result<NarrowArc, ArcError> {
        let (start, radius) = narrow(arc)?;
        let walk = Walk::new(&start);
        let totals = walk.totals().ok_or(ArcError::TooLong)?;
        Ok(NarrowArc {
            counted: Counted::with_totals(walk, totals),
            radius,
        })
    }

    /// Checks an arc as [`NarrowArc::new`] does, without the walk.
    ///
    /// # Errors
    /// As [`NarrowArc::new`].
    pub fn check(arc: &ArcMove) -> Result<(), ArcError> {
        narrow(arc).map(|_| ())
    }

    /// As [`Arc::radius`](crate::Arc::radius).
    pub const fn radius(&self) -> u64 {
        self.radius
    }
}

fn narrow(arc: &ArcMove) -> Result<(Start, u64), ArcError> {
    let (start, radius, fits_narrow) = start(arc, [0, 1])?;
    if fits_narrow {
        Ok((start, radius))
    } else {
        Err(ArcError::Wide)
    }
}

interpolator!(NarrowArc, counted);
