//! No axis steps sooner after its last step than its highest rate allows, however short a move is.

use husillo_interp::Moves;

use crate::lines::tempo::Tempo;
use crate::{Axis, Config, Segment};

/// So many steps of each axis are watched in a move. In a longer one the time of the whole move
/// keeps them apart: its ends lie between steps, so it has less than one step too many.
const WATCHED_STEPS: u8 = 64;

/// Keeps the time of each axis' last step, over all moves, take-ups and dwells.
///
/// A move's time is that of its programmed way, and its steps are those between two places of the
/// grid: a way shorter than a step may have a step all the same. Where a step would come too soon
/// after the last one of its axis, it waits, and what follows with it. Later moves make up for the
/// delay, as far as the rates allow, so programmed times still add up.
///
/// The clock has 32 bits. A step nearly 2^32 ticks after the last one of its axis may wait too, for
/// an interval at most.
#[derive(Clone, Debug)]
pub struct StepGuard<const N: usize> {
    now: u32,
    /// Tick of the last step of each axis.
    last: [u32; N],
    /// Ticks by which the path is behind its programmed time.
    late: u32,
    /// Axes whose next step is compared with their last one: bit 0 is the first.
    watched: u8,
    /// How many more of its steps are.
    left: [u8; N],
}

impl<const N: usize> Default for StepGuard<N> {
    fn default() -> Self {
        Self::new()
    }
}

impl<const N: usize> StepGuard<N> {
    /// As if every axis had just made a step.
    pub const fn new() -> Self {
        StepGuard {
            now: 0,
            last: [0; N],
            late: 0,
            watched: u8::MAX,
            left: [WATCHED_STEPS; N],
        }
    }

    /// The path stands: it makes up for no delay from before.
    pub const fn rest(&mut self) {
        self.late = 0;
    }

    /// A move at constant speed begins, with the path that is laid for it: the ticks that it takes,
    /// those of its feed on its programmed length.
    ///
    /// `segment` has passed [`Config::check`](crate::Config::check).
    pub fn begin<P: Moves<N>>(
        &mut self,
        config: &Config<N>,
        segment: &Segment<N>,
        path: &P,
    ) -> u64 {
        let ticks = self.ticks(&config.tempo(segment, path), 100, path.remaining());
        self.watch(path.radius().is_some(), path.remaining());
        ticks
    }

    /// The ticks of a move of so many steps, less what it makes up for.
    pub(crate) fn ticks(&mut self, tempo: &Tempo, percent: u8, events: u32) -> u64 {
        let programmed = tempo.ticks(percent);
        if events >= u32::from(WATCHED_STEPS) {
            return programmed;
        }
        // All its steps are watched: none comes too soon.
        let sooner = u32::try_from(programmed).map_or(self.late, |ticks| ticks.min(self.late));
        self.late = self.late.wrapping_sub(sooner);
        programmed.wrapping_sub(sooner.into())
    }

    /// A move of so many steps begins: its first ones are watched.
    pub(crate) const fn watch(&mut self, is_round: bool, events: u32) {
        // Two steps at 45 degrees of a circle may be nearer.
        let is_long = is_round && events >= 2 * WATCHED_STEPS as u32;
        self.watched = u8::MAX;
        self.left = [if is_long { 1 } else { WATCHED_STEPS }; N];
    }

    /// The wait of a step of the path that was to come after `wait` ticks; one of its axes or more
    /// are watched.
    #[cold]
    #[inline(never)]
    pub(crate) fn wait(&mut self, config: &Config<N>, wait: u32, axes: u8) -> u32 {
        let (mut at, mut bit) = (wait, 1_u8);
        let axes = axes & self.watched;
        let axes_of = config.axes.iter().zip(self.last.iter().zip(&mut self.left));
        for (axis, (last, left)) in axes_of {
            if axes & bit != 0 {
                let interval = interval_ticks(axis, config.timer_hz);
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

    /// Whether one of these axes is watched.
    #[inline]
    pub(crate) const fn watches(&self, axes: u8) -> bool {
        self.watched & axes != 0
    }

    /// Whether the time of a step of these axes has to be known, with so many steps of the move
    /// behind it: it is compared with the last one of its axis, or the next move may begin soon
    /// after it.
    ///
    /// What steps earlier in a move is farther from the next one than any axis' shortest interval,
    /// where all axes have the same rate.
    #[inline]
    pub const fn follows(&self, axes: u8, remaining: u32) -> bool {
        remaining < WATCHED_STEPS as u32 || self.watches(axes)
    }

    /// A step of the path that [`follows`](StepGuard::follows): when it comes, instead of after `wait`
    /// ticks.
    #[cold]
    #[inline(never)]
    pub fn step(&mut self, config: &Config<N>, mut wait: u32, axes: u8) -> u32 {
        if self.watches(axes) {
            wait = self.wait(config, wait, axes);
        }
        self.stepped(wait, axes);
        wait
    }

    /// A step of the path that need not be known of.
    #[inline]
    pub const fn pass(&mut self, wait: u32) {
        self.now = self.now.wrapping_add(wait);
    }

    /// These axes of the path step after `wait` ticks.
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

    /// These axes step beside the path, of a take-up or by the spindle, whose time is not known.
    #[inline(never)]
    pub fn stepped_aside(&mut self, wait: u32, axes: u8) {
        self.stepped(wait, axes);
        self.watched |= axes;
    }
}

/// Axes that move, as bits.
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

/// Ticks between two steps of an axis at its highest rate, less the part of a step that a longer
/// move may have too many.
fn interval_ticks(axis: &Axis, timer_hz: u32) -> u32 {
    let interval = timer_hz.checked_div(axis.max_rate_hz).unwrap_or(0);
    interval.wrapping_sub(interval / u32::from(WATCHED_STEPS))
}
