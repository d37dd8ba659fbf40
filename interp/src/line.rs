//! The straight line through N axes.

use core::iter::FusedIterator;

use crate::Step;

/// A straight line: as many events as the longest axis has steps, in `u32` arithmetic only.
///
/// After event `k` of `n` (the longest distance) axis `j` has made `floor((2 k d_j + n) / (2 n))`
/// steps: nearest to the true line, halves towards +infinity whatever the direction, so that the
/// way back visits the same points. Error at most 1/2 BLU an axis.
///
/// Cost: one addition, one comparison and two masks for each axis and event.
///
/// ```
/// let line = husillo_interp::Line::new([4, -2]);
/// let deltas: Vec<_> = line.map(|step| step.delta).collect();
/// assert_eq!(deltas, [[1, 0], [1, -1], [1, 0], [1, -1]]);
/// ```
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Line<const N: usize> {
    events: u32,
    left: u32,
    axes: [Share; N],
}

/// What one axis has of the line.
#[derive(Copy, Clone, PartialEq, Eq, Debug)]
struct Share {
    /// Below `events`; a step is due when it reaches `events`.
    phase: u32,
    /// |d|, at most `events`.
    rate: u32,
    /// Direction of the axis.
    sign: i8,
}

impl<const N: usize> Line<N> {
    /// The line from here to `delta` steps away. Any `i32` is allowed; all zero gives no event.
    pub fn new(delta: [i32; N]) -> Self {
        let events = delta
            .iter()
            .map(|distance| distance.unsigned_abs())
            .max()
            .unwrap_or(0);
        // floor((2 k d + n) / (2 n)) = floor((k d + floor(n / 2)) / n), as k d is an integer.
        let half = events / 2;
        let axes = delta.map(|distance| Share {
            // Downwards the phase is mirrored, n - 1 - phase: it passes n when the true one passes 0.
            phase: if distance < 0 {
                events.saturating_sub(half).saturating_sub(1)
            } else {
                half
            },
            rate: distance.unsigned_abs(),
            sign: if distance < 0 { -1 } else { 1 },
        });
        Line {
            events,
            left: events,
            axes,
        }
    }

    /// Events of the whole line: the distance of the longest axis, at most 2^31.
    pub const fn events(&self) -> u32 {
        self.events
    }

    /// Events still to come.
    pub const fn remaining(&self) -> u32 {
        self.left
    }
}

impl<const N: usize> Iterator for Line<N> {
    type Item = Step<N>;

    #[inline]
    fn next(&mut self) -> Option<Step<N>> {
        self.left = self.left.checked_sub(1)?;
        let events = self.events;
        let mut delta = [0; N];
        for (delta, axis) in delta.iter_mut().zip(&mut self.axes) {
            // phase < n and rate <= n <= 2^31: the sum is at most 2^32 - 1.
            let phase = axis.phase.wrapping_add(axis.rate);
            let is_due = phase >= events;
            axis.phase = if is_due {
                phase.wrapping_sub(events)
            } else {
                phase
            };
            *delta = if is_due { axis.sign } else { 0 };
        }
        Some(Step { delta, sweep: 1 })
    }

    #[inline]
    fn size_hint(&self) -> (usize, Option<usize>) {
        let left = usize::try_from(self.left).ok();
        (left.unwrap_or(usize::MAX), left)
    }
}

impl<const N: usize> ExactSizeIterator for Line<N> {}
impl<const N: usize> FusedIterator for Line<N> {}
