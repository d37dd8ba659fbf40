//! Controllers, one sample at a time. The output stays within its limits, except in the kernels
//! with `limit` in their names.

use core::hint::black_box;

use fixed::types::{I16F16, I32F0};
use husillo_pid::{
    AntiWindup, BackCalculation, Biquad, BiquadState, Coefficients, Conditional, DeadBand,
    Derivative, FeedForward, Filter, FilterState, Gains, Integration, Limits, OfMeasurement, Pid,
    RateRule, SecondOrder, ServoGains, ServoLaw, ServoState, State, TotalLimit, error,
};

use crate::Count;

const SAMPLES: u32 = 1000;

#[inline(never)]
pub fn all(count: Count<'_>) {
    let Some((pid, saturated)) = controllers(Integration::Backward) else {
        return;
    };
    updates(count, "pid", &pid);
    if let Some((pid, _)) = controllers(Integration::Forward) {
        updates(count, "pid_forward", &pid);
    }
    if let Some((pid, _)) = controllers(Integration::Bilinear) {
        updates(count, "pid_bilinear", &pid);
    }
    updates(count, "pid_at_its_limit", &saturated);
    updates(
        count,
        "pid_of_measurement",
        &pid.with_derivative(OfMeasurement),
    );
    let conditional = pid.with_anti_windup(Conditional);
    updates(count, "pid_conditional", &conditional);
    let conditional = saturated.with_anti_windup(Conditional);
    updates(count, "pid_conditional_at_limit", &conditional);
    if let Some(back) = BackCalculation::new(I16F16::lit("0.1")) {
        updates(count, "pid_back_calculation", &pid.with_anti_windup(back));
        updates(
            count,
            "pid_back_at_limit",
            &saturated.with_anti_windup(back),
        );
    }
    pieces(count, &pid);
    filters(count);
    servo(count);
}

/// A notch in whole counts and in floats.
fn filters(count: Count<'_>) {
    const NOTCH: Option<Coefficients> =
        match SecondOrder::notch(120.0, 30.0).bilinear(2000.0, Some(120.0)) {
            Ok(coefficients) => Some(coefficients),
            Err(_) => None,
        };
    let Some(notch) = NOTCH else { return };
    let limits = Limits {
        low: -30_000,
        high: 30_000,
    };
    let Ok(filter) = Biquad::new(&notch, limits) else {
        return;
    };
    count("biquad", SAMPLES, &mut || {
        let filter = black_box(filter);
        let mut state = BiquadState::default();
        for _ in 0..SAMPLES {
            black_box(filter.update(&mut state, black_box(460)));
        }
    });
    let limits = Limits {
        low: -30_000.0,
        high: 30_000.0,
    };
    let Ok(filter) = Biquad::<f32>::new(&notch, limits) else {
        return;
    };
    count("biquad_f32", SAMPLES, &mut || {
        let filter = black_box(filter);
        let mut state = BiquadState::default();
        for _ in 0..SAMPLES {
            black_box(filter.update(&mut state, black_box(460.0)));
        }
    });
}

/// A controller that stays within its limits, and one that reaches them.
fn controllers(rule: Integration) -> Option<(Controller, Controller)> {
    let gains = Gains {
        proportional: I16F16::lit("2.5"),
        integral: I16F16::lit("0.02"),
        derivative: I16F16::lit("30"),
    };
    let within = |limit: i32| Limits {
        low: I32F0::from_bits(-limit),
        high: I32F0::from_bits(limit),
    };
    let pid = Pid::new(gains, rule, within(2000)).ok()?;
    Some((pid, Pid::new(gains, rule, within(50)).ok()?))
}

type Controller = Pid<I32F0, I16F16>;

fn updates<A: AntiWindup<i32>, D: Derivative>(
    count: Count<'_>,
    name: &str,
    pid: &Pid<I32F0, I16F16, A, D>,
) {
    count(name, SAMPLES, &mut || {
        let pid = black_box(pid);
        let mut state = State::default();
        let target = black_box(I32F0::from_bits(500));
        for _ in 0..SAMPLES {
            let measured = black_box(I32F0::from_bits(460));
            black_box(pid.update(&mut state, target, measured));
        }
    });
}

/// The controller with one additional part.
fn pieces(count: Count<'_>, pid: &Controller) {
    let target = || black_box(I32F0::from_bits(500));
    let measured = || black_box(I32F0::from_bits(460));
    count("pid_dead_band", SAMPLES, &mut || {
        let (pid, band) = black_box((pid, DeadBand::new(I32F0::from_bits(3))));
        let (mut state, target) = (State::default(), target());
        for _ in 0..SAMPLES {
            let error = band.apply(error(target, measured()));
            let slope = pid.derivative(state.difference(error));
            black_box(pid.update_with(&mut state, error, slope));
        }
    });
    count("pid_filter", SAMPLES, &mut || {
        let (pid, filter) = black_box((pid, Filter::of_time_constant(8)));
        let (mut state, mut filtered, target) =
            (State::default(), FilterState::default(), target());
        for _ in 0..SAMPLES {
            let error = error(target, measured());
            let slope = pid.derivative(state.difference(error));
            black_box(pid.update_with(&mut state, error, filter.apply(&mut filtered, slope)));
        }
    });
    let Some(ahead) = FeedForward::new(I16F16::lit("12"), I16F16::lit("100")) else {
        return;
    };
    count("pid_feed_forward", SAMPLES, &mut || {
        let (pid, ahead) = black_box((pid, ahead));
        let (mut state, target) = (State::default(), target());
        for _ in 0..SAMPLES {
            let error = error(target, measured());
            let slope = pid.derivative(state.difference(error));
            let motion = black_box((I32F0::from_bits(7), I32F0::from_bits(1)));
            let ahead = ahead.term(motion.0, motion.1);
            black_box(pid.update_with(&mut state, error, slope.plus(ahead)));
        }
    });
    count("pid_f32", SAMPLES, &mut || {
        let gains = Gains {
            proportional: 2.5_f32,
            integral: 0.02,
            derivative: 30.0,
        };
        let limits = Limits {
            low: -2000.0,
            high: 2000.0,
        };
        let Ok(pid) = black_box(Pid::<f32>::new(gains, Integration::Backward, limits)) else {
            return;
        };
        let (mut state, target) = (State::default(), black_box(500.0));
        for _ in 0..SAMPLES {
            black_box(pid.update(&mut state, target, black_box(460.0)));
        }
    });
}

/// The control law of the servo module, with every option on.
fn servo(count: Count<'_>) {
    let gains = ServoGains {
        proportional: 100,
        derivative: 1000,
        integral: 50,
        integral_limit: 1000,
        output_limit: 255,
        current_limit: 41,
        error_limit: 4000,
        rate_divisor: 1,
        dead_band: 10,
    };
    count("servo_law", SAMPLES, &mut || {
        let law = ServoLaw::new(&gains, RateRule::Loop, TotalLimit::BeforeScaling);
        let law = black_box(law);
        let mut axis = ServoState::on();
        for _ in 0..SAMPLES {
            let (command, actual, current) = black_box((500, 460, 20));
            black_box(law.tick(&mut axis, command, actual, current));
        }
    });
}
