//! The printed DDA line with the exact, irrational length.

use crate::dda_line::square;
use crate::method::interpolator;
use crate::straight::{Register, Straight};

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
    walk: Straight<Sum, N>,
}

/// One axis.
#[derive(Copy, Clone, PartialEq, Eq, Debug)]
struct Sum {
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
        let sum = |distance: i32| Sum {
            sum: 0,
            rate: distance.unsigned_abs(),
            next: 1,
        };
        Some(LineDdaExact {
            walk: Straight::new(delta, events, square, sum),
        })
    }

    /// Number of events of the whole line, idle ones included.
    pub const fn events(&self) -> u32 {
        self.walk.events
    }
}

/// Product of two values below 2^63.
#[inline]
fn product(a: u64, b: u64) -> u128 {
    u128::from(a).wrapping_mul(u128::from(b))
}

impl Register for Sum {
    /// L^2, below 2^62.
    type Common = u64;

    #[inline]
    fn advance(&mut self, _: u32, square: u64, axes: &mut u8, bit: u8) {
        self.sum = self.sum.wrapping_add(self.rate.into());
        // At most 2^62.
        let next = u64::from(self.next);
        if product(self.sum, self.sum) > product(next.wrapping_mul(next), square) {
            self.next = self.next.wrapping_add(1);
            *axes |= bit;
        }
    }
}

interpolator!(LineDdaExact<N>, walk);
