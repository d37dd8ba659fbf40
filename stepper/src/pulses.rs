//! Pulses of several step and direction drivers on one stream of events.

use crate::{CoilDriver, Levels, PulseTiming};

/// State of the pulses of `N` drivers. Times are timer ticks since an origin that is moved before
/// they overflow.
///
/// Each axis has its own pulse, so the pulses of two axes may overlap. A step is delayed until its
/// driver is ready for it (DIR stable and STEP low for long enough). Later steps catch up.
#[derive(Copy, Clone, Debug)]
pub(crate) struct Pulses<const N: usize> {
    /// Timing of each driver; `None` if a step of this driver is one change of levels.
    timing: [Option<PulseTiming>; N],
    axes: [Pulse; N],
    now: u32,
    /// When the next STEP falls; [`NEVER`] if all are low.
    next_fall: u32,
    /// When every changed DIR is stable.
    stable_at: u32,
    /// Delay of the last step in ticks.
    late: u32,
}

/// The time of a change that does not come. All others are earlier.
const NEVER: u32 = u32::MAX;
/// The latest time at which a wait begins. A driver may then take as long for a pulse and a turn.
const LATEST: u32 = 1 << 31;

/// Pulse of one axis.
#[derive(Copy, Clone, Debug)]
struct Pulse {
    /// When STEP falls; [`NEVER`] if it is low.
    falls_at: u32,
    /// When STEP may rise.
    may_rise_at: u32,
    /// When DIR may change.
    may_turn_at: u32,
}

impl Pulse {
    /// STEP is low, and nothing waits.
    const NONE: Self = Self {
        falls_at: NEVER,
        may_rise_at: 0,
        may_turn_at: 0,
    };
}

impl<const N: usize> Pulses<N> {
    /// Returns `None` where no driver needs pulses.
    pub(crate) fn of<D: CoilDriver>(drivers: &[D; N]) -> Option<Self> {
        let timing = drivers.each_ref().map(CoilDriver::timing);
        timing.iter().any(Option::is_some).then_some(Self {
            timing,
            axes: [Pulse::NONE; N],
            now: 0,
            next_fall: NEVER,
            stable_at: 0,
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
        let left = wait_ticks.wrapping_sub(made_up);
        if self.now.checked_add(left).is_none() {
            self.begin_at_zero();
        }
        let due = self.now.saturating_add(left);
        let mut turns = self.turns(drivers, levels, delta);
        let last = loop {
            let step_at = due.max(self.ready_at(&turns, delta));
            let next = self.next_change(&turns);
            if next == NEVER || next > step_at {
                break step_at;
            }
            let wait = self.pass(next);
            self.change(drivers, levels, &mut turns, delta);
            present(wait, levels);
        };
        self.late = self.late.saturating_add(last.wrapping_sub(due));
        let wait = self.pass(last);
        if self.now > LATEST {
            self.begin_at_zero();
        }
        self.step(drivers, levels, delta);
        present(wait, levels);
    }

    /// Ticks until the last pulse in progress ends; `None` without a pulse.
    pub(crate) fn last_fall(&self) -> Option<u32> {
        let high = self.axes.iter().filter(|pulse| pulse.falls_at < NEVER);
        let last = high.map(|pulse| pulse.falls_at).max()?;
        Some(last.saturating_sub(self.now))
    }

    /// Makes now the origin of all times. What is over stays over.
    #[cold]
    fn begin_at_zero(&mut self) {
        let since = |time: u32| match time {
            NEVER => NEVER,
            _ => time.saturating_sub(self.now),
        };
        for pulse in &mut self.axes {
            pulse.falls_at = since(pulse.falls_at);
            pulse.may_rise_at = since(pulse.may_rise_at);
            pulse.may_turn_at = since(pulse.may_turn_at);
        }
        self.next_fall = since(self.next_fall);
        self.stable_at = since(self.stable_at);
        self.now = 0;
    }

    /// The axes whose DIR has to change before they step.
    fn turns<D: CoilDriver>(
        &self,
        drivers: &[D; N],
        levels: &[Levels; N],
        delta: &[i8; N],
    ) -> [bool; N] {
        let mut turns = [false; N];
        let axes = drivers.iter().zip(levels).zip(&self.timing).zip(delta);
        for (turn, (((driver, levels), timing), delta)) in turns.iter_mut().zip(axes) {
            let is_forward = levels.contains(Levels::DIR);
            *turn = *delta != 0
                && (*delta > 0) != is_forward
                && timing.is_some()
                && driver.levels().contains(Levels::ENABLE);
        }
        turns
    }

    /// When every axis of `delta` may step.
    fn ready_at(&self, turns: &[bool; N], delta: &[i8; N]) -> u32 {
        let mut ready_at = 0;
        let axes = self.axes.iter().zip(&self.timing).zip(turns).zip(delta);
        for (((pulse, timing), turns), delta) in axes {
            let (Some(timing), false) = (timing, *delta == 0) else {
                continue;
            };
            let stable_at = if *turns {
                let turned_at = pulse.may_turn_at.max(self.now);
                turned_at.saturating_add(timing.setup_ticks)
            } else {
                self.stable_at
            };
            ready_at = pulse.may_rise_at.max(stable_at).max(ready_at);
        }
        ready_at
    }

    /// When STEP of an axis falls, or DIR of an axis may change.
    fn next_change(&self, turns: &[bool; N]) -> u32 {
        let mut next = self.next_fall;
        for (pulse, turns) in self.axes.iter().zip(turns) {
            if *turns {
                next = next.min(pulse.may_turn_at.max(self.now));
            }
        }
        next
    }

    /// Goes on to a time that is not over. Returns the ticks until then.
    fn pass(&mut self, to: u32) -> u32 {
        let wait = to.saturating_sub(self.now);
        self.now = to;
        wait
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
        self.next_fall = NEVER;
        let axes = drivers.iter_mut().zip(levels).zip(&mut self.axes);
        let rest = self.timing.iter().zip(turns).zip(delta);
        for (((driver, levels), pulse), ((timing, turns), delta)) in axes.zip(rest) {
            let Some(timing) = timing else { continue };
            if pulse.falls_at <= self.now {
                *levels = driver.end_pulse();
                pulse.falls_at = NEVER;
            }
            self.next_fall = self.next_fall.min(pulse.falls_at);
            if *turns && pulse.may_turn_at <= self.now {
                *turns = false;
                *levels = driver.turn(*delta);
                let stable_at = after(self.now, timing.setup_ticks);
                self.stable_at = self.stable_at.max(stable_at);
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
                    pulse.falls_at = after(self.now, timing.high());
                    pulse.may_rise_at = pulse.falls_at.saturating_add(timing.low());
                    self.next_fall = self.next_fall.min(pulse.falls_at);
                    pulse.may_turn_at = after(self.now, timing.hold_ticks);
                }
            }
        }
    }
}

/// The time this many ticks after another one.
fn after(time: u32, ticks: u32) -> u32 {
    time.saturating_add(ticks).min(NEVER - 1)
}
