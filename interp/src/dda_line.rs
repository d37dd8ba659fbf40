//! Straight line by a digital differential analyser (DDA).

use crate::lattice::rounded_root;
use crate::method::interpolator;
use crate::straight::{Register, Straight};

/// A straight line in one to eight axes with one BLU of path per event. In every pass each register
/// adds the distance of its axis; the axis steps when its register overflows the length L.
///
/// Every pass is an event, including idle ones (`axes == 0`). Passes at equal times therefore give
/// constant path speed in any direction. [`LineDda::new`] is the corrected form: round(L) passes,
/// with registers half full at the start. Every axis is then within half a step of its share and
/// makes its last step by the last pass. [`LineDda::printed`] is the original form.
///
/// | | |
/// | --- | --- |
/// | error | `new`: 1/2 BLU per axis, less than 0.7071 BLU from a line in two axes; `printed`: less than 1 BLU per axis |
/// | events | `new`: round(L); `printed`: floor(L) + 1 |
/// | speed ripple, equal times | one event of path time over any window; mean L / events, so off by less than 1 / (2 L) (`new`) or 1 / L |
/// | cost | 25 (2 axes) and 37 (3 axes) instructions per event on Cortex-M0, 17 and 23 on Cortex-M4F, 19 and 27 on RV32IMAC |
/// | state | 32 bits: 8 bytes per axis plus 20; L below 2^31 BLU |
/// | source | Koren, Computer control of manufacturing systems, 1983; `printed`: micromill, annex A.3 |
///
/// Faults of the printed program:
///
/// - Its registers start at 0 and its comparison is strict, so steps come one pass late. A line
///   (n, 1) stays flat until its very end.
/// - It repeats idle passes at once instead of after a clock period. A line at 45 degrees runs
///   1.414 times too fast.
/// - Its 16-bit counters end at 65 535 BLU.
///
/// Here its idle passes are events as well; skip events with `axes == 0` for the original timing.
///
/// # Examples
/// ```
/// let line = husillo_interp::LineDda::new([4, -3]).unwrap();
/// let deltas: Vec<[i8; 2]> = line.map(|step| step.deltas()).collect();
/// assert_eq!(deltas, [[1, -1], [1, 0], [0, -1], [1, 0], [1, -1]]);
/// ```
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct LineDda<const N: usize> {
    walk: Straight<Sum, N>,
}

/// The register of one axis.
#[derive(Copy, Clone, PartialEq, Eq, Debug)]
struct Sum {
    /// Negative; a step is due when it reaches 0.
    phase: i32,
    /// |d|, at most L.
    rate: u32,
}

impl<const N: usize> LineDda<N> {
    /// Creates the corrected DDA. A `delta` of all zeros gives no event. Returns `None` where the
    /// line is 2^31 BLU or longer. Axes above the eighth do not move.
    pub fn new(delta: [i32; N]) -> Option<Self> {
        // At most 2^31, and at least the longest distance.
        let events = rounded_root(square(delta)?) as u32;
        let half = events / 2;
        // After event k: floor((2 k d + n) / (2 n)) steps, as in `Line`: nearest, halves rounded
        // up.
        Some(Self::with(delta, events, events, |is_negative| {
            let phase = if is_negative {
                events.saturating_sub(half).saturating_sub(1)
            } else {
                half
            };
            // phase < n <= 2^31 (or both are 0), so the difference is from -2^31 to 0.
            phase.wrapping_sub(events) as i32
        }))
    }

    /// Creates the DDA of micromill A.3: registers start empty, steps occur above floor(L). Returns
    /// `None` where the line is 2^31 BLU or longer.
    ///
    /// The original also limits the steps of each axis, but that limit never acts before the last
    /// pass. Register j holds k d_j after k passes, which exceeds d_j floor(L) at k = floor(L) + 1
    /// for all axes at once.
    pub fn printed(delta: [i32; N]) -> Option<Self> {
        let length = square(delta)?.isqrt() as u32;
        // Below 2^31, so the sum fits.
        let events = if length == 0 {
            0
        } else {
            length.wrapping_add(1)
        };
        // Strictly above: the register has to exceed the length by one.
        Some(Self::with(delta, events, length, |_| {
            (events as i32).wrapping_neg()
        }))
    }

    fn with(delta: [i32; N], events: u32, length: u32, phase: impl Fn(bool) -> i32) -> Self {
        let sum = |distance: i32| Sum {
            phase: phase(distance < 0),
            rate: distance.unsigned_abs(),
        };
        LineDda {
            walk: Straight::new(delta, events, length, sum),
        }
    }

    /// Number of events of the whole line, idle ones included.
    pub const fn events(&self) -> u32 {
        self.walk.events
    }
}

/// L^2; `None` where L is 2^31 or more.
pub(crate) fn square<const N: usize>(delta: [i32; N]) -> Option<u64> {
    delta
        .iter()
        .try_fold(0_u64, |sum, distance| {
            let distance = u64::from(distance.unsigned_abs());
            // Each is at most 2^62.
            sum.checked_add(distance.wrapping_mul(distance))
        })
        .filter(|sum| *sum < 1 << 62)
}

impl Register for Sum {
    /// L, the overflow threshold.
    type Common = u32;

    #[inline]
    fn advance(&mut self, _: u32, length: u32, axes: &mut u8, bit: u8) {
        // -L - 1 <= phase < 0 and rate <= L + 1/2 <= 2^31, so the sum is from -2^31 to 2^31 - 1.
        self.phase = self.phase.wrapping_add(self.rate as i32);
        if self.phase >= 0 {
            self.phase = self.phase.wrapping_sub(length as i32);
            *axes |= bit;
        }
    }
}

interpolator!(LineDda<N>, walk);
