//! One PID controller by the bilinear rule, in `i32`, in `I16F16` and in `f32`.

use husillo_pid::fixed::types::I16F16;
use husillo_pid::{Gains, Integration, Limits, Pid, SettingsError, State};

// ANCHOR: gains
/// Gains per sample: Kp, Ki T, Kd / T. They are exact in binary.
const GAINS: Gains<f64> = Gains {
    proportional: 1.5,
    integral: 0.0625,
    derivative: 2.0,
};

/// The controllers. Signals of the first are plain counts, its gains are `I16F16`.
#[derive(Debug)]
struct Controllers {
    counts: Pid<i32, I16F16>,
    fixed: Pid<I16F16>,
    float: Pid<f32>,
}

impl Controllers {
    fn new() -> Result<Self, SettingsError> {
        let gains: Gains<I16F16> = GAINS.to_fixed().expect("small gains");
        let Gains {
            proportional,
            integral,
            derivative,
        } = GAINS;
        let floats = Gains {
            proportional: proportional as f32,
            integral: integral as f32,
            derivative: derivative as f32,
        };
        let rule = Integration::Bilinear;
        Ok(Controllers {
            counts: Pid::new(
                gains,
                rule,
                Limits {
                    low: -255,
                    high: 255,
                },
            )?,
            fixed: Pid::new(
                gains,
                rule,
                Limits {
                    low: I16F16::from_num(-255),
                    high: I16F16::from_num(255),
                },
            )?,
            float: Pid::new(
                floats,
                rule,
                Limits {
                    low: -255.0,
                    high: 255.0,
                },
            )?,
        })
    }
}
// ANCHOR_END: gains

fn main() -> Result<(), SettingsError> {
    let pids = Controllers::new()?;
    step_response(&pids);
    closed_loop(&pids);
    Ok(())
}

/// A step of the error by 16: `u[k] = Kp e + Ki T e (k + 1/2)`, and `Kd / T e` in the first sample.
fn step_response(pids: &Controllers) {
    // ANCHOR: step
    let (mut a, mut b, mut c) = (State::default(), State::default(), State::default());
    println!("step of 16:    i32     I16F16        f32    formula");
    for k in 0..6 {
        let counts = pids.counts.update(&mut a, 16, 0);
        let fixed = pids
            .fixed
            .update(&mut b, I16F16::from_num(16), I16F16::ZERO);
        let float = pids.float.update(&mut c, 16.0, 0.0);
        let first = if k == 0 { GAINS.derivative } else { 0.0 };
        let sum = GAINS.integral * (f64::from(k) + 0.5);
        let formula = 16.0 * (GAINS.proportional + sum + first);
        println!("{k:10}  {counts:7}  {fixed:9.3}  {float:9.3}  {formula:9.3}");
        assert_eq!(fixed, formula);
        assert_eq!(f64::from(float), formula);
        assert!((f64::from(counts) - formula).abs() <= 0.5); // rounded to a count once
    }
    // ANCHOR_END: step
}

/// A motor whose speed follows the drive: the position after a sample.
fn moved(position: f64, speed: &mut f64, drive: f64) -> f64 {
    *speed += (drive / 16.0 - *speed) / 4.0;
    position + *speed
}

/// Each controller moves a motor of its own from 0 to 1000 counts.
fn closed_loop(pids: &Controllers) {
    // ANCHOR: loop
    let (mut a, mut b, mut c) = (State::default(), State::default(), State::default());
    let (mut positions, mut speeds) = ([0.0_f64; 3], [0.0; 3]);
    println!("closed loop:   i32     I16F16        f32");
    for sample in 0..=400 {
        let [counts, fixed, float] = positions.map(f64::round);
        let drives = [
            f64::from(pids.counts.update(&mut a, 1000, counts as i32)),
            pids.fixed
                .update(&mut b, I16F16::from_num(1000), I16F16::from_num(fixed))
                .to_num(),
            f64::from(pids.float.update(&mut c, 1000.0, float as f32)),
        ];
        if sample % 80 == 0 {
            println!("{sample:10}  {counts:7}  {fixed:9}  {float:9}");
        }
        for (axis, drive) in drives.into_iter().enumerate() {
            positions[axis] = moved(positions[axis], &mut speeds[axis], drive);
        }
    }
    // ANCHOR_END: loop
    assert_eq!(positions.map(f64::round), [1000.0; 3]);
}
