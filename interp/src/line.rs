//! The straight line in N axes.

use crate::lanes::Lanes;
use crate::method::interpolator;
use crate::straight::{Register, Straight};

/// A straight line in one to eight axes, with as many events as the longest axis has steps.
///
/// After event `k` of `n` (the longest distance) axis `j` has made `floor((2 k d_j + n) / (2 n))`
/// steps. This is the point nearest to the true line, with halves rounded towards +infinity in any
/// direction. The return path therefore visits the same points.
///
/// | | |
/// | --- | --- |
/// | error | at most 1/2 BLU per axis; in two axes at most 1/2 BLU from the line |
/// | events | max &#124;d_j&#124; |
/// | speed ripple | none where all events take the same time |
/// | state | 32 bits: 8 bytes per axis plus 12; every `i32` distance up to 2^31 |
/// | cost | 2, 3 and 6 axes: 25, 37 and 77 instructions per event on Cortex-M0; 17, 23 and 44 on Cortex-M4F; 19, 27 and 51 on RV32IMAC |
/// | source | Bresenham 1965, centred, in N axes |
///
/// # Examples
/// ```
/// let line = husillo_interp::Line::new([4, -2]);
/// let deltas: Vec<[i8; 2]> = line.map(|step| step.deltas()).collect();
/// assert_eq!(deltas, [[1, 0], [1, -1], [1, 0], [1, -1]]);
/// ```
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Line<const N: usize> {
    pub(crate) walk: Straight<Share, N>,
}

/// State of one axis of the line.
#[derive(Copy, Clone, PartialEq, Eq, Debug)]
pub(crate) struct Share {
    /// From -n to -1; a step is due when it reaches 0.
    phase: i32,
    /// |d|, at most n.
    rate: u32,
}

impl<const N: usize> Line<N> {
    /// Creates the line to `delta` steps away. Any `i32` is allowed; all zeros give no event. Axes
    /// above the eighth do not move.
    pub fn new(delta: [i32; N]) -> Self {
        let events = delta
            .iter()
            .map(|distance| distance.unsigned_abs())
            .max()
            .unwrap_or(0);
        // floor((2 k d + n) / (2 n)) = floor((k d + floor(n / 2)) / n), because k d is an integer.
        let half = events / 2;
        let share = |distance: i32| {
            // For a negative distance the phase is mirrored, n - 1 - phase: it passes n when the
            // true one passes 0.
            let phase = if distance < 0 {
                events.saturating_sub(half).saturating_sub(1)
            } else {
                half
            };
            Share {
                // phase < n <= 2^31 (or both are 0), so the difference is from -2^31 to 0.
                phase: phase.wrapping_sub(events) as i32,
                rate: distance.unsigned_abs(),
            }
        };
        Line {
            walk: Straight::new(delta, events, (), share),
        }
    }

    /// Number of events of the whole line: the distance of the longest axis, at most 2^31.
    pub const fn events(&self) -> u32 {
        self.walk.events
    }

    /// Masks of the axes that step in this line, and of those that step backwards.
    pub fn directions(&self) -> [u8; 2] {
        let (mut axes, mut bit) = (0_u8, 1_u8);
        for axis in &self.walk.axes {
            axes |= if axis.rate != 0 { bit } else { 0 };
            bit = bit.wrapping_shl(1);
        }
        [axes, self.walk.negative]
    }

    /// Writes the steps of the next events, at most 255, until the places or the events end.
    /// Returns the number of steps of each axis. These are the events of the iterator.
    ///
    /// # Cost
    /// Less than the iterator with [`Step::deltas`](crate::Step::deltas): the state of the axes
    /// stays in registers.
    ///
    /// # Examples
    /// ```
    /// let mut line = husillo_interp::Line::new([4, -2]);
    /// let mut deltas = [[0; 2]; 3];
    /// assert_eq!(line.fill(deltas.iter_mut()), [3, 1]);
    /// assert_eq!(deltas, [[1, 0], [1, -1], [1, 0]]);
    /// ```
    pub fn fill<'a>(&mut self, places: impl Iterator<Item = &'a mut [i8; N]>) -> [u8; N] {
        let events = self.walk.events;
        let signs = Lanes::signs(self.walk.negative);
        let mut steps = Lanes::default();
        // In a local variable, so that registers hold the axes.
        let mut axes = self.walk.axes;
        let most = self.walk.left.min(255);
        let mut left = most;
        for (place, _) in places.zip(0..most) {
            left = left.wrapping_sub(1);
            let mut due = Lanes::default();
            for (number, axis) in (0..8_u32).zip(&mut axes) {
                if axis.is_due(events) {
                    due.set(number);
                }
            }
            steps.add(due);
            *place = signs.of_steps(due);
        }
        self.walk.axes = axes;
        let made = most.wrapping_sub(left);
        self.walk.left = self.walk.left.wrapping_sub(made);
        steps.bytes()
    }
}

impl Share {
    /// Advances by one of so many events. Returns whether the axis steps.
    #[inline(always)]
    const fn is_due(&mut self, events: u32) -> bool {
        // See `advance`.
        let (phase, is_due) = (self.phase as u32).overflowing_add(self.rate);
        self.phase = phase as i32;
        if is_due {
            self.phase = phase.wrapping_sub(events) as i32;
        }
        is_due
    }
}

impl Register for Share {
    type Common = ();

    #[inline]
    fn advance(&mut self, events: u32, (): (), axes: &mut u8, bit: u8) {
        // -n <= phase < 0 and rate <= n <= 2^31, so the sum is from -2^31 to 2^31 - 1. In 32 bits
        // it carries where it reaches 0 or more.
        let (phase, is_due) = (self.phase as u32).overflowing_add(self.rate);
        self.phase = phase as i32;
        let due = phase.wrapping_sub(events) as i32;
        if cfg!(target_pointer_width = "64") {
            // Selected without a branch: desktop processors mispredict which axis steps.
            self.phase = if is_due { due } else { self.phase };
            *axes |= if is_due { bit } else { 0 };
        } else if self.phase >= 0 {
            // A branch takes the fewest instructions on a Cortex-M.
            self.phase = due;
            *axes |= bit;
        }
    }
}

interpolator!(Line<N>, walk);
