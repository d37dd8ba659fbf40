//! Speed profiles of 2000 events.

use core::hint::black_box;

use husillo_machine::{AccelerationLimits, AxisLimits, JerkLimits, StepperAxis};
use husillo_planner::{Rates, Recurrence, SCurve, ServoMotion, ServoProfile, Trapezoid};
use husillo_stepper::{PulseNanoseconds, StepDirection};

use crate::{Count, time};

const EVENTS: u32 = 2000;

/// From standstill to standstill, always below the top rate.
const RAMP: Rates = Rates {
    timer_hz: 1_000_000,
    start_rate_hz: 0,
    top_rate_hz: 20_000,
    end_rate_hz: 0,
    acceleration_hz_per_s: 100_000,
};

#[inline(never)]
pub fn all(count: Count<'_>) {
    // At the top rate throughout.
    let level = Rates {
        start_rate_hz: 20_000,
        end_rate_hz: 20_000,
        ..RAMP
    };
    // A fast timer and a slow machine: intervals of thousands of ticks that change by thousands.
    let coarse = Rates {
        timer_hz: 32_000_000,
        acceleration_hz_per_s: 4_000,
        ..RAMP
    };
    for (name, rates) in [
        ("trapezoid_ramp", &RAMP),
        ("trapezoid_ramp_32_mhz", &coarse),
        ("trapezoid_level", &level),
    ] {
        if let Ok(profile) = Trapezoid::new(rates, EVENTS) {
            time(count, name, &profile);
        }
    }
    for (name, rates) in [
        ("recurrence_ramp", &RAMP),
        ("recurrence_ramp_32_mhz", &coarse),
        ("recurrence_level", &level),
    ] {
        if let Ok(profile) = Recurrence::new(rates, EVENTS) {
            time(count, name, &profile);
        }
    }
    for (name, rates, jerk) in [
        ("s_curve", &RAMP, 1_000_000),
        ("s_curve_32_mhz", &coarse, 40_000),
    ] {
        if let Ok(profile) = SCurve::new(rates, jerk, EVENTS) {
            time(count, name, &profile);
        }
    }
    servo(count);
    axes(count);
}

/// Counts whole moves of an axis on an A4988, and a new goal on the way.
fn axes(count: Count<'_>) {
    let acceleration = AccelerationLimits {
        timer_hz: RAMP.timer_hz,
        top_rate_hz: RAMP.top_rate_hz,
        acceleration_hz_per_s: RAMP.acceleration_hz_per_s,
    };
    let jerk = JerkLimits {
        timer_hz: RAMP.timer_hz,
        top_rate_hz: RAMP.top_rate_hz,
        acceleration_hz_per_s: RAMP.acceleration_hz_per_s,
        jerk_hz_per_s2: 1_000_000,
    };
    axis(count, ["stepper_axis", "stepper_axis_goal"], acceleration);
    axis(
        count,
        ["stepper_axis_s_curve", "stepper_axis_s_curve_goal"],
        jerk,
    );
}

#[inline(never)]
fn axis<L>(count: Count<'_>, [moves, goals]: [&str; 2], limits: L)
where
    L: AxisLimits + Clone,
    L::Profile: Clone,
{
    let driver = StepDirection::new(PulseNanoseconds::A4988.ticks(RAMP.timer_hz));
    let Ok(mut axis) = StepperAxis::new(driver, limits) else {
        return;
    };
    count(moves, EVENTS, &mut || {
        axis.move_to(black_box(EVENTS.cast_signed()));
        while let Some(change) = axis.next_change() {
            black_box((change.ticks, change.levels));
        }
        axis.set_position(0);
    });
    axis.move_to(EVENTS.cast_signed());
    for _ in 0..EVENTS {
        axis.next_change();
    }
    count(goals, 2, &mut || {
        axis.move_to(black_box(20_000));
        axis.move_to(black_box(10_000));
    });
}

/// Counts servo moves of 4000 counts. One is at top velocity for nine tenths of the distance, the
/// other consists of ramps.
fn servo(count: Count<'_>) {
    for (name, velocity, acceleration) in [
        ("servo_profile_slew", 0x1_0000, 0x100),
        ("servo_profile_ramp", 0x8_0000, 0x80),
    ] {
        let mut profile = ServoProfile::new(0);
        profile.start(ServoMotion::Trapezoid {
            goal: 4000,
            velocity,
            acceleration,
        });
        let mut all = profile;
        let mut periods = 1;
        while !all.tick().is_done {
            periods += 1;
        }
        count(name, periods, &mut || {
            let mut profile = profile;
            while !black_box(profile.tick()).is_done {}
        });
    }
}
