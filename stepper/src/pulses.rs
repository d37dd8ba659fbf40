//! Pulses of several step and direction drivers on one stream of events.

use crate::{CoilDriver, Levels, PulseTiming};

/// State of the pulses of `N` drivers, in timer ticks from the last change of levels.
///
/// Each axis has its own pulse, so the pulses of two axes may overlap. A step is delayed until its
/// driver is ready for it (DIR stable and STEP low for long enough). Later steps catch up.
#[derive(Copy, Clone, Debug)]
pub(crate) struct Pulses<const N: usize> {
    /// Timing of each driver; `None` if a step of this driver is one change of levels.
    timing: [Option<PulseTiming>; N],
    axes: [Pulse; N],
    /// Ticks until every changed DIR is stable.
    setup_left: u32,
    /// Delay of the last step in ticks.
    late: u32,
}

/// Pulse of one axis: remaining ticks of each of its times.
#[derive(Copy, Clone, Debug, Default)]
struct Pulse {
    /// Until STEP falls; 0 if it is low.
    high_left: u32,
    /// Until STEP may rise.
    low_left: u32,
    /// Until DIR may change.
    hold_left: u32,
}

impl<const N: usize> Pulses<N> {
    /// Returns `None` where no driver needs pulses.
    pub(crate) fn of<D: CoilDriver>(drivers: &[D; N]) -> Option<Self> {
        let timing = drivers.each_ref().map(CoilDriver::timing);
        timing.iter().any(Option::is_some).then_some(Self {
            timing,
            axes: [Pulse::default(); N],
            setup_left: 0,
            late: 0,
        })
    }

    /// Runs everything within a wait, and the step by `delta` at its end (`delta` may be all zero).
    /// Calls `present` for each change of levels with the ticks since the previous one.
    pub(crate) fn run<D: CoilDriver>(
        &mut self,
        drivers: &mut [D; N],
        levels: &mut [Levels; N],
        wait_ticks: u32,
        delta: &[i8; N],
        mut present: impl FnMut(u32, &[Levels; N]),
    ) {
        // The rest of the wait after the delay of the last step is caught up.
        let made_up = self.late.min(wait_ticks);
        self.late = self.late.wrapping_sub(made_up);
        let mut left = wait_ticks.wrapping_sub(made_up);
        let mut turns = self.turns(drivers, levels, delta);
        loop {
            let ready_in = self.ready_in(&turns, delta);
            let due_in = left.max(ready_in);
            let Some(next) = self.next_change(&turns).filter(|next| *next <= due_in) else {
                break;
            };
            self.pass(next);
            self.late = self.late.saturating_add(next.saturating_sub(left));
            left = left.saturating_sub(next);
            self.change(drivers, levels, &mut turns, delta);
            present(next, levels);
        }
        let wait = left.max(self.ready_in(&turns, delta));
        self.late = self.late.saturating_add(wait.saturating_sub(left));
        self.pass(wait);
        self.step(drivers, levels, delta);
        present(wait, levels);
    }

    /// Ticks until the last pulse in progress ends; `None` without a pulse.
    pub(crate) fn last_fall(&self) -> Option<u32> {
        let falls = self.axes.iter().map(|pulse| pulse.high_left);
        falls.max().filter(|left| *left > 0)
    }

    /// The axes whose DIR has to change before they step.
    fn turns<D: CoilDriver>(
        &self,
        drivers: &[D; N],
        levels: &[Levels; N],
        delta: &[i8; N],
    ) -> [bool; N] {
        let mut turns = [false; N];
        let axes = drivers.iter().zip(levels).zip(self.timing).zip(delta);
        for (turn, (((driver, levels), timing), delta)) in turns.iter_mut().zip(axes) {
            let is_forward = levels.contains(Levels::DIR);
            let is_on = driver.levels().contains(Levels::ENABLE);
            *turn = timing.is_some() && is_on && *delta != 0 && (*delta > 0) != is_forward;
        }
        turns
    }

    /// Ticks until every axis of `delta` may step.
    fn ready_in(&self, turns: &[bool; N], delta: &[i8; N]) -> u32 {
        let axes = self.axes.iter().zip(self.timing).zip(turns).zip(delta);
        axes.filter(|(_, delta)| **delta != 0)
            .filter_map(|(((pulse, timing), turns), _)| {
                let timing = timing?;
                let low = match pulse.high_left {
                    0 => pulse.low_left,
                    high => high.saturating_add(timing.low()),
                };
                let turned = if *turns {
                    pulse.hold_left.saturating_add(timing.setup_ticks)
                } else {
                    self.setup_left
                };
                Some(low.max(turned))
            })
            .max()
            .unwrap_or(0)
    }

    /// Ticks until STEP of an axis falls, or DIR of an axis may change.
    fn next_change(&self, turns: &[bool; N]) -> Option<u32> {
        let falls = self.axes.iter().map(|pulse| pulse.high_left);
        let falls = falls.filter(|left| *left > 0).min();
        let turned = self.axes.iter().zip(turns).filter(|(_, turns)| **turns);
        let turned = turned.map(|(pulse, _)| pulse.hold_left).min();
        match (falls, turned) {
            (Some(falls), Some(turned)) => Some(falls.min(turned)),
            (falls, turned) => falls.or(turned),
        }
    }

    /// Lets time pass. For an axis whose STEP falls now, the remaining time stays 0 until
    /// [`change`](Pulses::change) is called.
    fn pass(&mut self, ticks: u32) {
        self.setup_left = self.setup_left.saturating_sub(ticks);
        for pulse in &mut self.axes {
            pulse.low_left = pulse.low_left.saturating_sub(ticks);
            pulse.hold_left = pulse.hold_left.saturating_sub(ticks);
            pulse.high_left = pulse.high_left.saturating_sub(ticks);
        }
    }

    /// Lets STEP fall for axes whose pulse has ended, and changes DIR of reversing axes where
    /// permitted.
    fn change<D: CoilDriver>(
        &mut self,
        drivers: &mut [D; N],
        levels: &mut [Levels; N],
        turns: &mut [bool; N],
        delta: &[i8; N],
    ) {
        let axes = drivers.iter_mut().zip(levels).zip(&mut self.axes);
        let rest = self.timing.iter().zip(turns).zip(delta);
        for (((driver, levels), pulse), ((timing, turns), delta)) in axes.zip(rest) {
            let Some(timing) = timing else { continue };
            if levels.contains(Levels::STEP) && pulse.high_left == 0 {
                *levels = driver.end_pulse();
                pulse.low_left = timing.low();
            }
            if *turns && pulse.hold_left == 0 {
                *turns = false;
                *levels = driver.turn(*delta);
                self.setup_left = self.setup_left.max(timing.setup_ticks);
            }
        }
    }

    /// Makes the step.
    fn step<D: CoilDriver>(
        &mut self,
        drivers: &mut [D; N],
        levels: &mut [Levels; N],
        delta: &[i8; N],
    ) {
        let axes = drivers.iter_mut().zip(levels).zip(&mut self.axes);
        for (((driver, levels), pulse), (timing, delta)) in axes.zip(self.timing.iter().zip(delta))
        {
            let Some(timing) = timing else {
                *levels = driver.step(*delta);
                continue;
            };
            // The previous pulse of this axis has ended, because its fall was due.
            if *delta != 0 {
                *levels = driver.step(*delta);
                if levels.contains(Levels::STEP) {
                    pulse.high_left = timing.high();
                    pulse.hold_left = timing.hold_ticks;
                }
            }
        }
    }
}
