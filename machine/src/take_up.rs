//! The tempo of a take-up: an axis alone, as fast as it can.

use husillo_planner::{Rates, SCurve, Timer, Trapezoid};

use crate::Axis;

/// Times the steps of one axis from standstill to standstill.
#[derive(Clone, Debug)]
pub(crate) enum TakeUp {
    /// At its highest rate from the first step on.
    Steady(Timer),
    /// Up to its highest rate and down again.
    Ramp(Trapezoid),
    /// The same with a limited jerk.
    Smooth(SCurve),
}

impl TakeUp {
    /// For so many steps.
    pub(crate) fn new(axis: &Axis, timer_hz: u32, steps: u32) -> TakeUp {
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
                Some(curve) => Some(TakeUp::Smooth(curve)),
                None => Trapezoid::new(&rates, steps).ok().map(TakeUp::Ramp),
            }
        });
        profile.unwrap_or_else(|| {
            TakeUp::Steady(Timer::new(
                u64::from(timer_hz),
                u64::from(axis.max_rate_hz),
                1,
            ))
        })
    }

    /// Ticks before the next step.
    pub(crate) fn wait(&mut self) -> u64 {
        match self {
            TakeUp::Steady(timer) => timer.wait(1),
            TakeUp::Ramp(ramp) => ramp.next().unwrap_or(0).into(),
            TakeUp::Smooth(curve) => curve.next().unwrap_or(0).into(),
        }
    }
}
