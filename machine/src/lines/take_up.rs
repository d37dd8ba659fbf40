//! Take-up of axes before they reverse and where the backlash changes: one axis at a time, as fast
//! as possible.

use husillo_backlash::{BacklashModel, Compensator};
use husillo_interp::Step;
use husillo_planner::{Rates, SCurve, Timer, Trapezoid};

use crate::{Axis, Config, MAX_WAIT_TICKS, StepEvent};

/// Result for a path step where the backlash changes.
pub(crate) enum Followed<const N: usize> {
    /// Make these motor steps.
    One([i8; N]),
    /// An axis makes two steps in one direction: `first`, then the step of the path.
    /// `interval_ticks` is the interval of that axis at its highest rate.
    Two { first: [i8; N], interval_ticks: u32 },
    /// More than one step is due; a take-up has begun.
    Stop,
}

/// Take-up of all axes: steps due and steps in progress.
#[derive(Clone, Debug)]
pub(crate) struct TakeUp<const N: usize, L: BacklashModel<N>> {
    compensator: Compensator<N, L>,
    is_on: bool,
    /// Motor steps still to make, signed.
    owed: [i32; N],
    /// Timing of the axis in take-up; `None` when none is due.
    pace: Option<Pace>,
    /// Correction steps of the waiting path step, signed.
    with_step: [i8; N],
    /// Motor steps that an abort left unmade, per axis, signed.
    unfinished: Option<[i32; N]>,
}

impl<const N: usize, L: BacklashModel<N>> TakeUp<N, L> {
    pub(crate) const fn new(backlash: [L; N]) -> Self {
        TakeUp {
            compensator: Compensator::new(backlash),
            is_on: true,
            owed: [0; N],
            pace: None,
            with_step: [0; N],
            unfinished: None,
        }
    }

    pub(crate) const fn set_on(&mut self, on: bool) {
        self.is_on = on;
    }

    /// The axes that must not reverse while the path moves.
    pub(crate) fn stops(&self) -> [bool; N] {
        let backlash = self.compensator.backlash().each_ref();
        backlash.map(|backlash| self.is_on && !backlash.is_free())
    }

    /// Whether a take-up is in progress.
    #[inline]
    pub(crate) const fn is_under_way(&self) -> bool {
        self.pace.is_some()
    }

    /// Whether a take-up may be due before this step.
    #[inline]
    pub(crate) const fn may_owe(&self, step: Step) -> bool {
        let turns = !self.compensator.is_straight_on(step.axes, step.negative);
        self.is_on && (turns || self.unfinished.is_some())
    }

    /// Direction and backlash of an axis, for steps outside the path that return to their start.
    /// Both are 0 before the axis has moved and while its nut is between the flanks. `None` without
    /// take-up.
    #[cold]
    pub(crate) fn play(&mut self, axis: usize, load: &[i32; N]) -> Option<(i8, u32)> {
        if !self.is_on {
            return None;
        }
        let unfinished = self.unfinished.unwrap_or([0; N]);
        let rests = [&self.owed, &unfinished];
        let is_between = rests
            .iter()
            .any(|rest| rest.get(axis).is_some_and(|rest| *rest != 0));
        let play = self.compensator.play(axis, load);
        Some(play.filter(|_| !is_between).unwrap_or((0, 0)))
    }

    /// Determines the take-up that is due before the axes of `delta` move, with the load at `load`.
    #[cold]
    pub(crate) fn turn(&mut self, delta: &[i8; N], load: [i32; N], config: &Config<N>) {
        if !self.is_on {
            return;
        }
        let backlash = self.compensator.before(delta, load);
        let mut unfinished = self.unfinished.take().unwrap_or([0; N]);
        let axes = self
            .owed
            .iter_mut()
            .zip(&mut unfinished)
            .zip(delta.iter().zip(backlash));
        for ((owed, rest), (delta, backlash)) in axes {
            let direction = i32::from(*delta);
            if direction != 0 {
                // A reversal after an interrupted take-up needs only the steps that were made: the
                // rest has the other sign. Backlash and rest are below 2^31.
                let backlash = i32::try_from(backlash).unwrap_or(i32::MAX);
                *owed = direction.wrapping_mul(backlash).saturating_add(*rest);
                *rest = 0;
            }
        }
        self.unfinished = unfinished
            .iter()
            .any(|rest| *rest != 0)
            .then_some(unfinished);
        self.next_axis(config);
    }

    /// Returns the motor steps of a path step by `delta` to `load`, including corrections for the
    /// backlash there.
    #[inline]
    pub(crate) fn follow(
        &mut self,
        mut delta: [i8; N],
        load: &[i32; N],
        config: &Config<N>,
    ) -> Followed<N> {
        let mut owed = self.compensator.follow(load).filter(|_| self.is_on);
        if let (Some(owed), Some(unfinished)) = (&mut owed, &mut self.unfinished) {
            // After an interrupted take-up the nut is between the flanks: the screw stays until
            // that axis moves.
            for (owed, rest) in owed.iter_mut().zip(unfinished) {
                if *rest != 0 {
                    *rest = rest.saturating_add(core::mem::take(owed));
                }
            }
        }
        let owed = match owed {
            None => core::mem::replace(&mut self.with_step, [0; N]),
            Some(owed) if owed.iter().all(|owed| owed.unsigned_abs() <= 1) => {
                owed.map(|owed| owed as i8)
            }
            Some(owed) => {
                // The take-up before this step is complete, so nothing else is due.
                self.owed = owed;
                self.next_axis(config);
                return Followed::Stop;
            }
        };
        let mut first = [0; N];
        let mut axis = None;
        let axes = first.iter_mut().zip(&config.axes);
        for ((delta, owed), (first, facts)) in delta.iter().zip(owed).zip(axes) {
            if *delta != 0 && *delta == owed {
                *first = owed;
                axis = axis.max(Some(config.timer_hz.div_ceil(facts.max_rate_hz.max(1))));
            }
        }
        if let Some(interval_ticks) = axis {
            for (later, (owed, first)) in self.with_step.iter_mut().zip(owed.iter().zip(first)) {
                *later = owed.wrapping_sub(first);
            }
            return Followed::Two {
                first,
                interval_ticks,
            };
        }
        for (delta, owed) in delta.iter_mut().zip(owed) {
            // One of them is 0, or their sum is 0.
            *delta = delta.wrapping_add(owed);
        }
        Followed::One(delta)
    }

    /// Makes one motor step: X before Y before Z. Returns `None` when none is due.
    pub(crate) fn step(&mut self, config: &Config<N>) -> Option<StepEvent<N>> {
        let wait = self.pace.as_mut()?.wait().min(MAX_WAIT_TICKS.into());
        let axes = (0..N).zip(&mut self.owed);
        let (number, owed) = axes.into_iter().find(|(_, owed)| **owed != 0)?;
        let direction = owed.signum();
        *owed = owed.wrapping_sub(direction);
        if *owed == 0 {
            self.next_axis(config);
        }
        let mut delta = [0; N];
        if let Some(delta) = delta.get_mut(number) {
            *delta = direction as i8;
        }
        Some(StepEvent {
            wait_ticks: wait as u32,
            delta,
        })
    }

    /// Interrupts the take-up; it is completed or reversed before that axis moves again.
    pub(crate) fn abort(&mut self) {
        if self.is_under_way() || self.with_step.iter().any(|owed| *owed != 0) {
            let mut unfinished = self.unfinished.unwrap_or([0; N]);
            let left = self.owed.iter().zip(self.with_step);
            for (rest, (owed, with_step)) in unfinished.iter_mut().zip(left) {
                *rest = rest.saturating_add(*owed).saturating_add(with_step.into());
            }
            self.unfinished = Some(unfinished);
        }
        self.owed = [0; N];
        self.with_step = [0; N];
        self.pace = None;
    }

    /// Prepares the next axis with steps due.
    fn next_axis(&mut self, config: &Config<N>) {
        let axes = self.owed.iter().zip(&config.axes);
        self.pace = axes
            .into_iter()
            .find(|(owed, _)| **owed != 0)
            .map(|(owed, axis)| Pace::new(axis, config.timer_hz, owed.unsigned_abs()));
    }
}

/// Timing of the steps of one axis from standstill to standstill.
#[derive(Clone, Debug)]
enum Pace {
    /// At the highest rate from the first step on.
    Steady(Timer),
    /// Ramps up to the highest rate and down again.
    Ramp(Trapezoid),
    /// The same with limited jerk.
    Smooth(SCurve),
}

impl Pace {
    /// Creates the timing of `steps` steps.
    fn new(axis: &Axis, timer_hz: u32, steps: u32) -> Pace {
        let profile = axis.ramp.and_then(|ramp| {
            let rates = Rates {
                timer_hz,
                start_rate_hz: ramp.start_rate_hz,
                top_rate_hz: axis.max_rate_hz,
                end_rate_hz: ramp.start_rate_hz,
                acceleration_hz_per_s: ramp.acceleration_hz_per_s,
            };
            // A jerk that the timer cannot resolve and ramps of a quarter of an hour are refused:
            // such an axis starts as one without them.
            let smooth = ramp
                .jerk_hz_per_s2
                .and_then(|jerk| SCurve::new(&rates, jerk, steps).ok());
            match smooth {
                Some(curve) => Some(Pace::Smooth(curve)),
                None => Trapezoid::new(&rates, steps).ok().map(Pace::Ramp),
            }
        });
        profile.unwrap_or_else(|| {
            Pace::Steady(Timer::new(
                u64::from(timer_hz),
                u64::from(axis.max_rate_hz),
                1,
            ))
        })
    }

    /// Ticks before the next step.
    fn wait(&mut self) -> u64 {
        match self {
            Pace::Steady(timer) => timer.wait(1),
            Pace::Ramp(ramp) => ramp.next().unwrap_or(0).into(),
            Pace::Smooth(curve) => curve.next().unwrap_or(0).into(),
        }
    }
}
