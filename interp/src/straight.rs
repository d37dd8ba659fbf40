//! The loop of every straight line: a register per axis, and events of equal sweep.

use crate::Step;
use crate::interpolator::Totals;
use crate::method::Method;
use crate::step::negative_axes;

/// One axis of a straight line.
pub(crate) trait Register {
    /// Values common to all axes.
    type Common: Copy;

    /// Advances by one of so many events, and sets `bit` in `axes` if the axis steps. A mask that
    /// is returned instead would cost a tenth of the instructions of an event on a Cortex-M0.
    fn advance(&mut self, events: u32, common: Self::Common, axes: &mut u8, bit: u8);
}

/// A straight line in progress.
#[derive(Clone, PartialEq, Eq, Debug)]
pub(crate) struct Straight<R: Register, const N: usize> {
    pub(crate) left: u32,
    /// Number of events of the whole line.
    pub(crate) events: u32,
    common: R::Common,
    /// Mask of the axes that step backwards.
    pub(crate) negative: u8,
    pub(crate) axes: [R; N],
}

impl<R: Register, const N: usize> Straight<R, N> {
    /// A line to `delta` steps away. `register` makes the register of a distance.
    pub(crate) fn new(
        delta: [i32; N],
        events: u32,
        common: R::Common,
        register: impl Fn(i32) -> R,
    ) -> Self {
        Straight {
            left: events,
            events,
            common,
            negative: negative_axes(delta),
            axes: delta.map(register),
        }
    }
}

impl<R: Register, const N: usize> Method for Straight<R, N> {
    #[inline]
    fn next_step(&mut self) -> Option<Step> {
        self.left = self.left.checked_sub(1)?;
        let (mut axes, mut bit) = (0_u8, 1_u8);
        for axis in &mut self.axes {
            axis.advance(self.events, self.common, &mut axes, bit);
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
