//! Minimum interval between the steps of an axis, across all moves however short.

use husillo_interp::Moves;

use crate::lines::tempo::Pace;
use crate::{Axis, Config, Segment, StepEvent};

/// Number of steps of each axis that are checked per move. In a longer move its total time keeps
/// the steps apart: its ends lie between steps, so it has less than one step too many.
const WATCHED_STEPS: u8 = 64;

/// Keeps the time of the last step of each axis, across all moves, take-ups and dwells.
///
/// The time of a move is that of its programmed length. Its steps are those between two points of
/// the grid, so a move shorter than a step may still contain a step. A step that would follow the
/// last one of its axis too soon waits, and so do all later ones. Later moves catch up as far as
/// the rates allow, so programmed times still add up.
///
/// An axis that does not step at every event of a line steps at events that are due for another
/// axis. With r events to a step, an interval has at least the whole number of events below r. So
/// it may be shorter by less than the wait of one event, and is longer than half of the interval of
/// the rate. On a helix two events in a row differ by up to sqrt(2), so it is longer than 1/2.42 of
/// that interval. The guard allows exactly that; the average of any number of intervals is not
/// shorter. Delaying these steps would stop the other axes at every one of them.
///
/// The clock has 32 bits. A step nearly 2^32 ticks after the last one of its axis may also wait,
/// for at most one interval, if the event before it is nearer than that.
#[derive(Clone, Debug)]
pub struct StepGuard<const N: usize> {
    now: u32,
    /// Tick of the last step of each axis.
    last: [u32; N],
    /// Ticks by which the path is behind its programmed time.
    late: u32,
    /// Axes whose next step is compared with their last one, as a bit mask from the first axis on.
    watched: u8,
    /// Axes for which an event is never shorter than the interval of their rate: those of a line
    /// that are no slower than the longest one, and both axes of a circle.
    steady: u8,
    /// Whether two steps of a steady axis may be closer by 1/sqrt(2), as at 45 degrees of a circle.
    is_round: bool,
    /// Number of steps still to check per axis.
    left: [u8; N],
}

impl<const N: usize> Default for StepGuard<N> {
    fn default() -> Self {
        Self::new()
    }
}

impl<const N: usize> StepGuard<N> {
    /// Creates a guard as if every axis had just made a step.
    pub const fn new() -> Self {
        StepGuard {
            now: 0,
            last: [0; N],
            late: 0,
            watched: u8::MAX,
            steady: u8::MAX,
            is_round: false,
            left: [WATCHED_STEPS; N],
        }
    }

    /// The path stands: earlier delays are no longer caught up.
    pub const fn rest(&mut self) {
        self.late = 0;
    }

    /// Begins a move at constant speed and returns its ticks: those of its feed over its programmed
    /// length. `path` is the path of the move.
    ///
    /// `segment` has passed [`Config::check`](crate::Config::check). All axes count as steady,
    /// which is right where all have the same highest rate.
    pub fn begin<P: Moves<N>>(
        &mut self,
        config: &Config<N>,
        segment: &Segment<N>,
        path: &P,
    ) -> u64 {
        let ticks = self.ticks(&config.pace(segment, path), 100, path.remaining());
        self.watch(path.radius().is_some(), path.remaining(), u8::MAX);
        ticks
    }

    /// The ticks of a move of `events` steps, minus the delay that it catches up.
    pub(crate) fn ticks(&mut self, pace: &Pace, percent: u8, events: u32) -> u64 {
        let programmed = pace.ticks(percent);
        if events >= u32::from(WATCHED_STEPS) {
            return programmed;
        }
        // All its steps are checked, so none comes too soon.
        let sooner = u32::try_from(programmed).map_or(self.late, |ticks| ticks.min(self.late));
        self.late = self.late.wrapping_sub(sooner);
        programmed.wrapping_sub(sooner.into())
    }

    /// Begins a move of `events` steps; its first steps are checked. `steady` is a mask of axes.
    pub(crate) const fn watch(&mut self, is_round: bool, events: u32, steady: u8) {
        // Two steps at 45 degrees of a circle may be closer, so only the first one is checked.
        let is_long = is_round && events >= 2 * WATCHED_STEPS as u32;
        self.watched = u8::MAX;
        self.steady = steady;
        self.is_round = is_round && !is_long;
        self.left = [if is_long { 1 } else { WATCHED_STEPS }; N];
    }

    /// Returns the wait of a path step that is due after `wait` ticks and has at least one checked
    /// axis.
    #[cold]
    #[inline(never)]
    pub(crate) fn wait(&mut self, config: &Config<N>, wait: u32, axes: u8) -> u32 {
        let (mut at, mut bit) = (wait, 1_u8);
        let axes = axes & self.watched;
        let axes_of = config.axes.iter().zip(self.last.iter().zip(&mut self.left));
        for (axis, (last, left)) in axes_of {
            if axes & bit != 0 {
                let mut interval = interval_ticks(axis, config.timer_hz);
                if self.steady & bit == 0 {
                    interval = interval.saturating_sub(wait);
                } else if self.is_round && *left < WATCHED_STEPS {
                    interval = nearer(interval);
                }
                at = at.max(interval.saturating_sub(self.now.wrapping_sub(*last)));
                *left = left.saturating_sub(1);
                if *left == 0 {
                    self.watched &= !bit;
                }
            }
            bit = bit.wrapping_shl(1);
        }
        self.late = self.late.saturating_add(at.wrapping_sub(wait));
        at
    }

    /// Records a path step of these axes, of which at least one is checked, and returns its wait.
    /// It makes no divisions where the steps are farther apart than `longest`, the interval of the
    /// slowest axis.
    #[inline]
    pub(crate) fn step_beyond(
        &mut self,
        longest: u32,
        config: &Config<N>,
        wait: u32,
        axes: u8,
    ) -> u32 {
        let at = self.now.wrapping_add(wait);
        // No step was made in this wait, so a longer one needs no comparison.
        let watched = if wait < longest {
            axes & self.watched
        } else {
            0
        };
        let mut bit = 1_u8;
        for last in &self.last {
            if watched & bit != 0 && at.wrapping_sub(*last) < longest {
                let wait = self.wait(config, wait, axes);
                self.stepped(wait, axes);
                return wait;
            }
            bit = bit.wrapping_shl(1);
        }
        self.now = at;
        let mut bit = 1_u8;
        for (last, left) in self.last.iter_mut().zip(&mut self.left) {
            if axes & bit != 0 {
                *last = at;
                // 0 for an axis that is not checked.
                *left = left.saturating_sub(1);
                if *left == 0 {
                    self.watched &= !bit;
                }
            }
            bit = bit.wrapping_shl(1);
        }
        wait
    }

    /// Whether one of these axes is checked.
    #[inline]
    pub(crate) const fn watches(&self, axes: u8) -> bool {
        self.watched & axes != 0
    }

    /// Whether the time of a step of these axes has to be recorded, with `remaining` steps of the
    /// move after it. It does if the step is compared with the last one of its axis, or if the next
    /// move may begin soon after it.
    ///
    /// Where all axes have the same rate, earlier steps of a move are farther from the next move
    /// than the shortest interval of any axis.
    #[inline]
    pub const fn follows(&self, axes: u8, remaining: u32) -> bool {
        remaining < WATCHED_STEPS as u32 || self.watches(axes)
    }

    /// Records a path step that [`follows`](StepGuard::follows). Returns the ticks to wait instead
    /// of `wait`.
    #[cold]
    #[inline(never)]
    pub fn step(&mut self, config: &Config<N>, mut wait: u32, axes: u8) -> u32 {
        if self.watches(axes) {
            wait = self.wait(config, wait, axes);
        }
        self.stepped(wait, axes);
        wait
    }

    /// Records a path step whose time is not needed.
    #[inline]
    pub const fn pass(&mut self, wait: u32) {
        self.now = self.now.wrapping_add(wait);
    }

    /// Records path steps of these axes after `wait` ticks.
    #[inline]
    pub(crate) fn stepped(&mut self, wait: u32, axes: u8) {
        self.now = self.now.wrapping_add(wait);
        let mut bit = 1_u8;
        for last in &mut self.last {
            if axes & bit != 0 {
                *last = self.now;
            }
            bit = bit.wrapping_shl(1);
        }
    }

    /// Records path steps of a line, none of which can be too soon. `made` is the number of steps
    /// of each axis, and `ticks` the sum of the waits.
    pub(crate) fn pass_line(&mut self, steps: &[StepEvent<N>], made: &[u32; N], ticks: u32) {
        let (mut axes, mut bit) = (0, 1_u8);
        for (left, made) in self.left.iter_mut().zip(made) {
            if *made != 0 {
                axes |= bit;
                // 0 for an axis that is not checked.
                *left = left.saturating_sub((*made).min(u8::MAX.into()) as u8);
                if *left == 0 {
                    self.watched &= !bit;
                }
            }
            bit = bit.wrapping_shl(1);
        }
        self.pass_until(self.now.wrapping_add(ticks), steps, axes);
    }

    /// Records path steps that were not checked, of which `axes` is the mask.
    pub(crate) fn pass_all(&mut self, steps: &[StepEvent<N>], axes: u8) {
        let ticks = steps.iter().map(|step| step.wait_ticks);
        self.pass_until(ticks.fold(self.now, u32::wrapping_add), steps, axes);
    }

    /// Records path steps, the last of which is made now. `axes` is their mask.
    fn pass_until(&mut self, now: u32, steps: &[StepEvent<N>], axes: u8) {
        self.now = now;
        let (mut left, mut at) = (axes, now);
        for step in steps.iter().rev() {
            if left == 0 {
                break;
            }
            let mut bit = 1_u8;
            for (last, delta) in self.last.iter_mut().zip(step.delta) {
                if left & bit != 0 && delta != 0 {
                    *last = at;
                    left &= !bit;
                }
                bit = bit.wrapping_shl(1);
            }
            at = at.wrapping_sub(step.wait_ticks);
        }
    }

    /// Records steps of these axes outside the path: steps of a take-up, or spindle-synchronised
    /// steps, whose time is unknown.
    #[inline(never)]
    pub fn stepped_aside(&mut self, wait: u32, axes: u8) {
        self.stepped(wait, axes);
        self.watched |= axes;
    }
}

/// Mask of the axes that move.
#[inline]
pub(crate) fn bits<const N: usize>(delta: &[i8; N]) -> u8 {
    let (mut axes, mut bit) = (0, 1_u8);
    for delta in delta {
        if *delta != 0 {
            axes |= bit;
        }
        bit = bit.wrapping_shl(1);
    }
    axes
}

/// A part of an interval below 1/sqrt(2): 45/64.
const fn nearer(interval: u32) -> u32 {
    interval
        .wrapping_sub(interval >> 2)
        .wrapping_sub(interval >> 5)
        .wrapping_sub(interval >> 6)
}

/// Ticks between two steps of an axis at its highest rate, minus the fraction of a step by which a
/// longer move may have too many.
fn interval_ticks(axis: &Axis, timer_hz: u32) -> u32 {
    let interval = timer_hz.checked_div(axis.max_rate_hz).unwrap_or(0);
    interval.wrapping_sub(interval / u32::from(WATCHED_STEPS))
}

/// The longest of these intervals.
pub(crate) fn longest_interval<const N: usize>(config: &Config<N>) -> u32 {
    let intervals = config.axes.iter();
    let intervals = intervals.map(|axis| interval_ticks(axis, config.timer_hz));
    intervals.max().unwrap_or(0)
}
