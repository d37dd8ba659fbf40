//! The printed DDA line with the exact, irrational length.

use crate::Step;
use crate::dda_line::square;
use crate::interpolator::Totals;
use crate::method::{Method, interpolator};
use crate::step::negative_axes;

/// A straight line by the DDA of micromill A.3 with the exact length L = sqrt(sum d^2) instead of
/// floor(L), for comparison.
///
/// After k passes axis j has made step number c + 1 when k d_j exceeds (c + 1) L. The squares are
/// compared in 128 bits.
///
/// | | |
/// | --- | --- |
/// | error | less than 1 BLU per axis |
/// | events | floor(L) + 1, idle ones included |
/// | speed ripple, equal times | one event of path time over any window; mean L / events |
/// | cost | 2 axes: 911 instructions per event on Cortex-M0, which has no long multiplication; 100 on Cortex-M4F, 109 on RV32IMAC |
/// | state | 64 and 128 bits: 16 bytes per axis plus 24; L below 2^31 BLU |
/// | source | micromill, annex A.3 (for its faults see [`LineDda`](crate::LineDda)) |
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct LineDdaExact<const N: usize> {
    left: u32,
    events: u32,
    /// L^2, below 2^62.
    square: u64,
    negative: u8,
    axes: [Register; N],
}

/// One axis.
#[derive(Copy, Clone, PartialEq, Eq, Debug)]
struct Register {
    /// k |d|: below 2^62, because k <= 2^31.
    sum: u64,
    rate: u32,
    /// Number of its next step, from 1 to 2^31.
    next: u32,
}

impl<const N: usize> LineDdaExact<N> {
    /// Creates the line to `delta` steps away. All zeros give no event. Returns `None` where the
    /// line is 2^31 BLU or longer. Axes above the eighth do not move.
    pub fn new(delta: [i32; N]) -> Option<Self> {
        let square = square(delta)?;
        // The root is below 2^31.
        let events = if square == 0 {
            0
        } else {
            (square.isqrt() as u32).wrapping_add(1)
        };
        Some(LineDdaExact {
            left: events,
            events,
            square,
            negative: negative_axes(delta),
            axes: delta.map(|distance| Register {
                sum: 0,
                rate: distance.unsigned_abs(),
                next: 1,
            }),
        })
    }

    /// Number of events of the whole line, idle ones included.
    pub const fn events(&self) -> u32 {
        self.events
    }
}

/// Product of two values below 2^63.
#[inline]
fn product(a: u64, b: u64) -> u128 {
    u128::from(a).wrapping_mul(u128::from(b))
}

impl<const N: usize> Method for LineDdaExact<N> {
    #[inline]
    fn next_step(&mut self) -> Option<Step> {
        self.left = self.left.checked_sub(1)?;
        let (mut axes, mut bit) = (0_u8, 1_u8);
        for axis in &mut self.axes {
            axis.sum = axis.sum.wrapping_add(axis.rate.into());
            // At most 2^62.
            let next = u64::from(axis.next);
            if product(axis.sum, axis.sum) > product(next.wrapping_mul(next), self.square) {
                axis.next = axis.next.wrapping_add(1);
                axes |= bit;
            }
            bit = bit.wrapping_shl(1);
        }
        Some(Step {
            axes,
            negative: axes & self.negative,
            sweep: 1,
        })
    }

    #[inline]
    fn left(&self) -> u32 {
        self.left
    }

    #[inline]
    fn totals(&self) -> Totals {
        Totals::of_ones(self.events)
    }
}

interpolator!(LineDdaExact<N>);
