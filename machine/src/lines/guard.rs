//! No axis steps sooner after its last step than its highest rate allows, however short the moves are.

use crate::{Config, MAX_WAIT_TICKS};

/// Keeps the time of each axis' last step, over all moves, take-ups and dwells.
///
/// A move ends with a step at its last tick, wherever between two steps its programmed end lies. A next move that is shorter
/// than a step may round to one all the same. Such a step waits here. The path makes up for the delay in the waits that follow, a
/// quarter of each at most, so programmed times still add up.
#[derive(Clone, Debug)]
pub(crate) struct Guard<const N: usize> {
    /// Ticks between two steps of each axis at its highest rate, rounded down; [`MAX_WAIT_TICKS`] at most.
    interval: [u64; N],
    /// Ticks since the beginning.
    clock: u64,
    /// The earliest tick of the next step of each axis.
    earliest: [u64; N],
    /// Ticks by which the path is behind its programmed time.
    late: u64,
}

impl<const N: usize> Guard<N> {
    pub(crate) fn new(config: &Config<N>) -> Self {
        Guard {
            interval: config.axes.map(|axis| {
                let interval = config.timer_hz.checked_div(axis.max_rate_hz);
                interval
                    .unwrap_or(MAX_WAIT_TICKS)
                    .min(MAX_WAIT_TICKS)
                    .into()
            }),
            clock: 0,
            earliest: [0; N],
            late: 0,
        }
    }

    /// Time in which no axis steps.
    pub(crate) const fn pass(&mut self, ticks: u32) {
        self.clock = self.clock.wrapping_add(ticks as u64);
    }

    /// The path stands: it makes up for no delay from before.
    pub(crate) const fn rest(&mut self) {
        self.late = 0;
    }

    /// The ticks before a step of the path that was to come after `wait` of them, [`MAX_WAIT_TICKS`] at most.
    #[inline]
    pub(crate) fn path_step(&mut self, wait: u64, delta: &[i8; N]) -> u64 {
        let mut due = self.clock.wrapping_add(wait);
        if self.late != 0 {
            let sooner = self.late.min(wait >> 2);
            self.late = self.late.wrapping_sub(sooner);
            due = due.wrapping_sub(sooner);
        }
        let mut at = due;
        for (earliest, delta) in self.earliest.iter().zip(delta) {
            if *delta != 0 && *earliest > at {
                at = *earliest;
            }
        }
        self.late = self.late.wrapping_add(at.wrapping_sub(due));
        let wait = at.wrapping_sub(self.clock);
        self.stepped(at, delta);
        wait
    }

    /// A step that comes after exactly `wait_ticks`: of a take-up, or of what follows the spindle, whose time is not known.
    pub(crate) fn own_step(&mut self, wait_ticks: u32, delta: &[i8; N]) {
        self.stepped(self.clock.wrapping_add(wait_ticks.into()), delta);
    }

    #[inline]
    fn stepped(&mut self, at: u64, delta: &[i8; N]) {
        self.clock = at;
        let axes = self.earliest.iter_mut().zip(&self.interval).zip(delta);
        for ((earliest, interval), delta) in axes {
            if *delta != 0 {
                *earliest = at.wrapping_add(*interval);
            }
        }
    }
}
