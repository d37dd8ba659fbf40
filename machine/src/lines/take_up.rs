//! What axes owe before they turn round, and for lash that is another where they go: each alone, as fast as it can.

use husillo_backlash::{Compensator, Lash};
use husillo_interp::Step;
use husillo_planner::{Rates, SCurve, Timer, Trapezoid};

use crate::{Axis, Config, MAX_WAIT_TICKS, StepEvent};

/// What becomes of a step of the path where the lash is another.
pub(crate) enum Followed<const N: usize> {
    /// These motor steps.
    One([i8; N]),
    /// An axis makes two steps one way: these first, and the path's after them. An interval of that axis at its highest rate.
    Two { first: [i8; N], interval_ticks: u32 },
    /// More is owed than a step; it is on its way.
    Stop,
}

/// The take-up of all axes: what is owed, and on its way.
#[derive(Clone, Debug)]
pub(crate) struct TakeUp<const N: usize, L: Lash<N>> {
    compensator: Compensator<N, L>,
    is_on: bool,
    /// Motor steps still to make, signed.
    owed: [i32; N],
    /// The tempo of the axis that makes them; `None` when nothing is owed.
    pace: Option<Pace>,
    /// What the step of the path that waits carries besides, signed.
    with_step: [i8; N],
    /// What an abort left: motor steps that an axis has not made, signed.
    unfinished: Option<[i32; N]>,
}

impl<const N: usize, L: Lash<N>> TakeUp<N, L> {
    pub(crate) const fn new(lash: [L; N]) -> Self {
        TakeUp {
            compensator: Compensator::new(lash),
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

    /// The axes that must not turn round while the path moves.
    pub(crate) fn stops(&self) -> [bool; N] {
        let lash = self.compensator.lash().each_ref();
        lash.map(|lash| self.is_on && !lash.is_free())
    }

    /// Whether an axis is being taken up.
    #[inline]
    pub(crate) const fn is_under_way(&self) -> bool {
        self.pace.is_some()
    }

    /// Whether something may be owed before this step.
    #[inline]
    pub(crate) const fn may_owe(&self, step: Step) -> bool {
        let turns = !self.compensator.is_straight_on(step.axes, step.negative);
        self.is_on && (turns || self.unfinished.is_some())
    }

    /// Direction and lash of an axis, for steps beside the path that end where they began: 0 and 0 before it has moved, and while its nut lies
    /// between the flanks. `None` where nothing is taken up.
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

    /// Before the axes of `delta` move that way, with the load at `load`: they owe their take-up from now on.
    #[cold]
    pub(crate) fn turn(&mut self, delta: &[i8; N], load: [i32; N], config: &Config<N>) {
        if !self.is_on {
            return;
        }
        let lash = self.compensator.before(delta, load);
        let mut unfinished = self.unfinished.take().unwrap_or([0; N]);
        let axes = self
            .owed
            .iter_mut()
            .zip(&mut unfinished)
            .zip(delta.iter().zip(lash));
        for ((owed, rest), (delta, lash)) in axes {
            let direction = i32::from(*delta);
            if direction != 0 {
                // Back again from a take-up cut short owes only what that one had made: the rest has
                // the other sign. Lash and rest are below 2^31.
                let lash = i32::try_from(lash).unwrap_or(i32::MAX);
                *owed = direction.wrapping_mul(lash).saturating_add(*rest);
                *rest = 0;
            }
        }
        self.unfinished = unfinished
            .iter()
            .any(|rest| *rest != 0)
            .then_some(unfinished);
        self.next_axis(config);
    }

    /// The motor steps of a step of the path by `delta`, to `load`: with what it owes for the lash there.
    #[inline]
    pub(crate) fn follow(
        &mut self,
        mut delta: [i8; N],
        load: &[i32; N],
        config: &Config<N>,
    ) -> Followed<N> {
        let mut owed = self.compensator.follow(load).filter(|_| self.is_on);
        if let (Some(owed), Some(unfinished)) = (&mut owed, &mut self.unfinished) {
            // The nut of a take-up that was cut short lies on no flank: the screw stays until that axis moves.
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
                // The take-up before this step has been made, so nothing else is owed.
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
            // One of them is 0, or they make 0 together.
            *delta = delta.wrapping_add(owed);
        }
        Followed::One(delta)
    }

    /// One motor step: X before Y before Z. `None` when nothing is owed.
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

    /// Drops what is owed; it is made, or given back, before that axis moves again.
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

    /// Readies the next axis that owes.
    fn next_axis(&mut self, config: &Config<N>) {
        let axes = self.owed.iter().zip(&config.axes);
        self.pace = axes
            .into_iter()
            .find(|(owed, _)| **owed != 0)
            .map(|(owed, axis)| Pace::new(axis, config.timer_hz, owed.unsigned_abs()));
    }
}

/// Times the steps of one axis from standstill to standstill.
#[derive(Clone, Debug)]
enum Pace {
    /// At its highest rate from the first step on.
    Steady(Timer),
    /// Up to its highest rate and down again.
    Ramp(Trapezoid),
    /// The same with a limited jerk.
    Smooth(SCurve),
}

impl Pace {
    /// For so many steps.
    fn new(axis: &Axis, timer_hz: u32, steps: u32) -> Pace {
        let profile = axis.ramp.and_then(|ramp| {
            let rates = Rates {
                timer_hz,
                start_rate_hz: ramp.start_rate_hz,
                top_rate_hz: axis.max_rate_hz,
                end_rate_hz: ramp.start_rate_hz,
                acceleration_hz_per_s: ramp.acceleration_hz_per_s,
            };
            // Refused are a jerk that the timer is too slow for, and ramps of a quarter of an hour: such an axis starts
            // as it did without.
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
