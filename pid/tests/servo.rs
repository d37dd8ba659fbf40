//! Tests of the law of the module: traces bit by bit, other behaviour by properties.

use husillo_pid::{Drive, RateRule, ServoGains, ServoLaw, ServoState, TotalLimit};
use proptest::prelude::*;
use serde_json::Value;

fn integers(value: &Value) -> Vec<i64> {
    value
        .as_array()
        .unwrap()
        .iter()
        .map(|number| number.as_i64().unwrap())
        .collect()
}

#[test]
fn traces() {
    let file: Value = serde_json::from_str(include_str!("data/picservo.json")).unwrap();
    let cases = file["cases"].as_array().unwrap();
    assert_eq!(cases.len(), 8);
    for case in cases {
        let number = |key: &str| case[key].as_u64().unwrap() as u16;
        // The file assumes a reading that increases with the current. By the rule of the module
        // this is an odd limit.
        let current_limit = match number("CL") {
            0 => 0,
            limit => limit as u8 | 1,
        };
        let gains = ServoGains {
            proportional: number("Kp"),
            derivative: number("Kd"),
            integral: number("Ki"),
            integral_limit: number("IL"),
            output_limit: number("OL") as u8,
            current_limit,
            error_limit: number("EL"),
            rate_divisor: 1,
            dead_band: 0,
        };
        let law = ServoLaw::new(&gains, RateRule::Loop, TotalLimit::BeforeScaling);
        let mut axis = ServoState::on();
        let errors = integers(&case["error"]);
        let currents = match &case["current"] {
            Value::Null => vec![0; errors.len()],
            readings => integers(readings),
        };
        let [outputs, pwm, totals, directions] =
            ["output", "pwm", "integral", "dir"].map(|key| integers(&case[key]));
        for (k, (error, current)) in errors.iter().zip(currents).enumerate() {
            let drive = law.tick(&mut axis, *error as i32, 0, current as u8);
            assert_eq!(i64::from(axis.output()), outputs[k], "output {k} of {case}");
            assert_eq!(i64::from(drive.pwm), pwm[k], "pwm {k} of {case}");
            assert_eq!(
                i64::from(axis.total_counts()),
                totals[k],
                "total {k} of {case}"
            );
            assert_eq!(
                i64::from(drive.is_reverse),
                directions[k],
                "direction {k} of {case}"
            );
            assert_eq!(
                axis.is_on(),
                !case["off"][k].as_bool().unwrap(),
                "off {k} of {case}"
            );
        }
    }
}

fn gains() -> impl Strategy<Value = ServoGains> {
    let words = (0u16..0x8000, 0u16..0x8000, 0u16..0x8000, 0u16..0x8000);
    (words, any::<u8>(), 1u8..40, any::<u8>()).prop_map(
        |(
            (proportional, derivative, integral, integral_limit),
            output_limit,
            rate_divisor,
            dead_band,
        )| ServoGains {
            proportional,
            derivative,
            integral,
            integral_limit,
            output_limit,
            current_limit: 0,
            error_limit: 0x3fff,
            rate_divisor,
            dead_band,
        },
    )
}

fn errors() -> impl Strategy<Value = Vec<i32>> {
    proptest::collection::vec(-300i32..300, 1..200)
}

fn run(law: &ServoLaw, errors: impl IntoIterator<Item = i32>) -> Vec<Drive> {
    let mut axis = ServoState::on();
    errors
        .into_iter()
        .map(|error| law.tick(&mut axis, error, 0, 0))
        .collect()
}

proptest! {
    /// A loop divided by n equals the undivided loop on every n-th tick. The drive is held in
    /// between.
    #[test]
    fn divided_loop_is_the_loop_on_fewer_ticks(gains in gains(), errors in errors()) {
        let step = usize::from(gains.rate_divisor);
        let law = ServoLaw::new(&gains, RateRule::Loop, TotalLimit::BeforeScaling);
        let every = ServoLaw::new(
            &ServoGains { rate_divisor: 1, ..gains },
            RateRule::Loop,
            TotalLimit::BeforeScaling,
        );
        let sampled = run(&every, errors.iter().copied().step_by(step));
        for (k, drive) in run(&law, errors.iter().copied()).into_iter().enumerate() {
            prop_assert_eq!(drive, sampled[k / step]);
        }
    }

    /// The loop is due on the first tick and on every n-th tick after it. It is always due if only
    /// the derivative is divided.
    #[test]
    fn due_every_nth_tick(gains in gains(), ticks in 1usize..200) {
        for rule in [RateRule::Loop, RateRule::Derivative] {
            let law = ServoLaw::new(&gains, rule, TotalLimit::BeforeScaling);
            let mut axis = ServoState::on();
            for k in 0..ticks {
                let due = rule == RateRule::Derivative || k % usize::from(gains.rate_divisor) == 0;
                prop_assert_eq!(law.is_due(&axis), due);
                law.tick(&mut axis, 5, 0, 0);
            }
        }
    }

    /// If only the derivative is divided, P and I are the same as without the divisor.
    #[test]
    fn divided_derivative_leaves_p_and_i(gains in gains(), errors in errors()) {
        let gains = ServoGains { derivative: 0, ..gains };
        let law = |rate_divisor| ServoLaw::new(
            &ServoGains { rate_divisor, ..gains },
            RateRule::Derivative,
            TotalLimit::BeforeScaling,
        );
        prop_assert_eq!(run(&law(gains.rate_divisor), errors.clone()), run(&law(1), errors));
    }

    /// The divided derivative is the difference over n ticks, held for n ticks.
    #[test]
    fn divided_derivative_is_held(rate_divisor in 1u8..40, errors in errors()) {
        let gains = ServoGains {
            derivative: 100,
            rate_divisor,
            error_limit: 0x3fff,
            output_limit: 255,
            ..ServoGains::default()
        };
        let law = ServoLaw::new(&gains, RateRule::Derivative, TotalLimit::BeforeScaling);
        let mut axis = ServoState::on();
        let step = usize::from(rate_divisor);
        for (k, error) in errors.iter().enumerate() {
            law.tick(&mut axis, *error, 0, 0);
            let at = k / step * step;
            let before = at.checked_sub(step).map_or(0, |k| errors[k]);
            prop_assert_eq!(axis.output(), 100 * (errors[at] - before));
        }
    }

    /// The dead band adds its value to every drive that is not 0, up to the output limit. It does
    /// not change a drive of 0 or the direction.
    #[test]
    fn dead_band_lifts_what_is_not_zero(gains in gains(), errors in errors()) {
        let law = ServoLaw::new(&gains, RateRule::Loop, TotalLimit::BeforeScaling);
        let bare = ServoLaw::new(
            &ServoGains { dead_band: 0, output_limit: 255, ..gains },
            RateRule::Loop,
            TotalLimit::BeforeScaling,
        );
        let (mut axis, mut other) = (ServoState::on(), ServoState::on());
        for error in errors {
            let (lifted, drive) = (
                law.tick(&mut axis, error, 0, 0),
                bare.tick(&mut other, error, 0, 0),
            );
            prop_assert_eq!(lifted.is_reverse, drive.is_reverse);
            let lift = if axis.output() == 0 { 0 } else { gains.dead_band };
            prop_assert_eq!(lifted.pwm, drive.pwm.saturating_add(lift).min(gains.output_limit));
        }
    }

    /// The derivative damps: a shrinking error causes less drive than a constant one, by Kd for
    /// each count.
    #[test]
    fn derivative_damps(before in 1i32..300, by in 1i32..300, kd in 1u16..1000) {
        let gains = ServoGains {
            proportional: 100,
            derivative: kd,
            error_limit: 0x3fff,
            output_limit: 255,
            ..ServoGains::default()
        };
        let law = ServoLaw::new(&gains, RateRule::Loop, TotalLimit::BeforeScaling);
        let mut axis = ServoState::on();
        law.tick(&mut axis, before, 0, 0);
        law.tick(&mut axis, before, 0, 0);
        let still = axis.output();
        law.tick(&mut axis, before - by, 0, 0);
        prop_assert_eq!(axis.output(), still - 100 * by - i32::from(kd) * by);
    }

    /// The output equals the formula within 32 bits, for all gains and errors. The PWM is 1/256 of
    /// it, within the limit.
    #[test]
    fn output_is_the_formula(
        gains in gains(),
        errors in proptest::collection::vec(-0x3fffi32..=0x3fff, 1..100),
        after in any::<bool>(),
    ) {
        let gains = ServoGains { rate_divisor: 1, dead_band: 0, ..gains };
        let limit = if after { TotalLimit::AfterScaling } else { TotalLimit::BeforeScaling };
        let law = ServoLaw::new(&gains, RateRule::Loop, limit);
        let (mut axis, mut total, mut previous) = (ServoState::on(), 0_i64, 0_i64);
        for error in errors {
            let drive = law.tick(&mut axis, error, 0, 0);
            let error = i64::from(error);
            let bound = i64::from(gains.integral_limit) * if after { 256 } else { 1 };
            total = (total + error).clamp(-bound, bound);
            let exact = i64::from(
                gains.proportional
            ) * error + i64::from(gains.derivative) * (error - previous) + i64::from(gains
                .integral) * (total / 256);
            previous = error;
            prop_assert_eq!(drive.pwm, (exact.abs() / 256).min(gains.output_limit.into()) as u8);
            prop_assert_eq!(drive.is_reverse, exact < 0);
            prop_assert_eq!(i64::from(axis.total_counts()), total);
        }
    }

    /// For any input the drive is within the limit, it is 0 while off, and the servo stays off
    /// after an error beyond its limit.
    #[test]
    fn limits_hold(
        gains in gains(), error_limit in any::<u16>(), current_limit in any::<u8>(),
        inputs in proptest::collection::vec((any::<i32>(), any::<i32>(), any::<u8>()), 1..100),
    ) {
        let gains = ServoGains { error_limit, current_limit, ..gains };
        let law = ServoLaw::new(&gains, RateRule::Loop, TotalLimit::BeforeScaling);
        let mut axis = ServoState::on();
        let mut is_on = true;
        for (command, actual, current) in inputs {
            let is_due = law.is_due(&axis);
            let drive = law.tick(&mut axis, command, actual, current);
            is_on &= !is_due || command.wrapping_sub(actual).unsigned_abs() <= u32::from(
                error_limit.min(0x7fff)
            );
            prop_assert!(drive.pwm <= gains.output_limit);
            prop_assert_eq!(axis.is_on(), is_on);
            prop_assert!(is_on || drive.pwm == 0);
        }
    }

    /// Under a lasting overcurrent the drive decreases by one per sample to 0. Afterwards it
    /// returns by one per sample.
    #[test]
    fn current_limit_cuts_by_one(pwm in any::<u8>(), limit in 1u8.., ticks in 1usize..600) {
        let gains = ServoGains { current_limit: limit, ..ServoGains::default() };
        let law = ServoLaw::new(&gains, RateRule::Loop, TotalLimit::BeforeScaling);
        let (over, under) =
            if limit % 2 == 1 { (limit.saturating_add(1), limit) } else { (limit - 1, limit) };
        // No reading exceeds a limit of 255.
        prop_assume!(limit != 255);
        let mut axis = ServoState::off();
        let drive = Drive { pwm, is_reverse: true };
        let mut now = pwm;
        for _ in 0..ticks {
            now = now.saturating_sub(1);
            prop_assert_eq!(law.open_loop(&mut axis, drive, over).pwm, now);
            prop_assert!(axis.is_over_current());
        }
        while now < pwm {
            now += 1;
            prop_assert_eq!(
                law.open_loop(&mut axis, drive, under),
                Drive { pwm: now, is_reverse: true },
            );
            prop_assert!(!axis.is_over_current());
        }
    }
}

#[test]
fn an_integration_limit_of_zero_empties_the_total() {
    let gains = ServoGains {
        integral: 100,
        integral_limit: 1000,
        error_limit: 4000,
        output_limit: 255,
        ..ServoGains::default()
    };
    let law = |gains| ServoLaw::new(gains, RateRule::Loop, TotalLimit::BeforeScaling);
    let mut axis = ServoState::on();
    law(&gains).tick(&mut axis, 700, 0, 0);
    assert_eq!(axis.total_counts(), 700);
    law(&ServoGains {
        integral_limit: 0,
        ..gains
    })
    .tick(&mut axis, 700, 0, 0);
    assert_eq!(axis.total_counts(), 0);
}

#[test]
fn positions_may_wrap() {
    let gains = ServoGains {
        proportional: 256,
        error_limit: 4000,
        output_limit: 255,
        ..ServoGains::default()
    };
    let law = ServoLaw::new(&gains, RateRule::Loop, TotalLimit::BeforeScaling);
    let drive = law.tick(&mut ServoState::on(), i32::MIN + 4, i32::MAX - 5, 0);
    assert_eq!(drive.signed(), 10);
}
