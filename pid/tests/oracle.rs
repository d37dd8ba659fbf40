//! Tests of the three integration rules against exact responses.

use fixed::traits::Fixed;
use fixed::types::{I10F22, I16F16, I24F8, I32F0};
use husillo_pid::{Gains, Integration, Limits, Number, Pid, State};
use serde_json::Value;

/// A rational number as in the file, `-7/3`.
#[derive(Clone, Copy)]
struct Ratio(i128, i128);

impl Ratio {
    fn parse(text: &Value) -> Self {
        let text = text.as_str().unwrap();
        let (numerator, denominator) = text.split_once('/').unwrap_or((text, "1"));
        Self(numerator.parse().unwrap(), denominator.parse().unwrap())
    }

    fn value(self) -> f64 {
        self.0 as f64 / self.1 as f64
    }

    fn times(self, other: Self) -> Self {
        Self(self.0 * other.0, self.1 * other.1)
    }

    fn over(self, other: Self) -> Self {
        let sign = other.0.signum();
        Self(self.0 * other.1 * sign, self.1 * other.0.abs())
    }
}

struct Case {
    gains: [Ratio; 3],
    rule: Integration,
    errors: Vec<i32>,
    outputs: Vec<Ratio>,
}

fn cases() -> Vec<Case> {
    let file: Value = serde_json::from_str(include_str!("data/pid.json")).unwrap();
    let noise: Vec<i32> = file["inputs"]["random"]
        .as_array()
        .unwrap()
        .iter()
        .map(|error| error.as_str().unwrap().parse().unwrap())
        .collect();
    file["cases"]
        .as_array()
        .unwrap()
        .iter()
        .map(|case| {
            let [kp, ki, kd, period] = ["Kp", "Ki", "Kd", "T"].map(|key| Ratio::parse(&case[key]));
            let outputs: Vec<Ratio> = case["u"]
                .as_array()
                .unwrap()
                .iter()
                .map(Ratio::parse)
                .collect();
            let samples = outputs.len() as i32;
            let errors = match case["input"].as_str().unwrap() {
                "impulse" => (0..samples).map(|k| i32::from(k == 0)).collect(),
                "step" => vec![1; outputs.len()],
                "ramp" => (0..samples).collect(),
                "random" => noise.clone(),
                other => panic!("{other}"),
            };
            let rule = match case["form"].as_str().unwrap() {
                "T/(z-1)" => Integration::T_OVER_Z_MINUS_1,
                "Tz/(z-1)" => Integration::TZ_OVER_Z_MINUS_1,
                "tustin" => Integration::HALF_T_Z_PLUS_1_OVER_Z_MINUS_1,
                other => panic!("{other}"),
            };
            // The file has the velocity form: b0 + b1 + b2 = Ki T.
            let b: Vec<f64> = case["b"]
                .as_array()
                .unwrap()
                .iter()
                .map(|b| Ratio::parse(b).value())
                .collect();
            assert!((b.iter().sum::<f64>() - ki.times(period).value()).abs() < 1e-9);
            Case {
                gains: [kp, ki.times(period), kd.over(period)],
                rule,
                errors,
                outputs,
            }
        })
        .collect()
}

/// Runs the cases whose gains fit their type and returns the number of these cases.
fn within_one_digit<S: Fixed + Number<Word = i32>, G: Fixed + Number<Word = i32>>(
    scale: i32,
) -> usize {
    let limits = Limits {
        low: S::MIN,
        high: S::MAX,
    };
    let mut run = 0;
    for case in cases() {
        let gains = case.gains.map(|gain| G::checked_from_num(gain.value()));
        let [Some(proportional), Some(integral), Some(derivative)] = gains else {
            continue;
        };
        let gains = Gains {
            proportional,
            integral,
            derivative,
        };
        let Ok(pid) = Pid::<S, G>::new(gains, case.rule, limits) else {
            continue;
        };
        let mut state = State::default();
        for (error, Ratio(numerator, denominator)) in case.errors.iter().zip(&case.outputs) {
            let output = pid.update(&mut state, S::from_num(error * scale), S::ZERO);
            // In last digits: |output - exact * digits| <= 1.
            let digits = i128::from(scale) << <S as Number>::FRACTION_BITS;
            let off = i128::from(output.to_word()) * denominator - numerator * digits;
            assert!(
                off.abs() <= *denominator,
                "{} {:?}: {output}",
                case.rule,
                pid
            );
        }
        run += 1;
    }
    run
}

#[test]
fn whole_counts() {
    assert_eq!(within_one_digit::<I32F0, I16F16>(1), 108);
}

#[test]
fn fractions() {
    // Seven of the nine sets of gains are below 2^29 last digits of this fine type.
    assert_eq!(within_one_digit::<I24F8, I10F22>(1), 84);
}

#[test]
fn floats() {
    let limits = Limits {
        low: f32::MIN,
        high: f32::MAX,
    };
    for case in cases() {
        let [proportional, integral, derivative] = case.gains.map(|gain| gain.value() as f32);
        let gains = Gains {
            proportional,
            integral,
            derivative,
        };
        let pid = Pid::<f32>::new(gains, case.rule, limits).unwrap();
        let mut state = State::default();
        for (error, exact) in case.errors.iter().zip(&case.outputs) {
            let output = pid.update(&mut state, *error as f32, 0.0);
            let size = 1.0 + 200.0 * derivative.abs();
            assert!(
                (output - exact.value() as f32).abs() <= size * 1e-5,
                "{} {output}",
                case.rule
            );
        }
    }
}
