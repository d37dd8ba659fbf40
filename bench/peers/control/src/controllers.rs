//! PID control of an error with limits: Kp 2.5, Ki 0.02 and Kd 30 per sample, output within +-2000.

use core::hint::black_box;

use dsp_fixedpoint::Q32;
use dsp_process::SplitProcess;
use fixed::types::{I16F16, I32F0};
use husillo_pid::{Gains, Integration, Limits, OfMeasurement, Pid, State};
use idsp::iir::{BiquadClamp, DirectForm1};

use crate::Count;

const SAMPLES: u32 = 1000;
/// The output unit of idsp in fixed point is 2^-16. Its integral is its last output, which in whole
/// units would stop at small errors.
const OUTPUT_BITS: i32 = 1 << 16;
/// The coefficient of 32.52 units then needs 22 bits before the point.
type Coefficient = Q32<9>;

/// The controller of husillo in fixed point.
pub fn fixed() -> Option<Pid<I32F0, I16F16>> {
    let gains = Gains {
        proportional: I16F16::lit("2.5"),
        integral: I16F16::lit("0.02"),
        derivative: I16F16::lit("30"),
    };
    let limits = Limits {
        low: I32F0::from_bits(-2000),
        high: I32F0::from_bits(2000),
    };
    Pid::new(gains, Integration::Backward, limits).ok()
}

/// The controller of husillo in floating point.
pub fn floating() -> Option<Pid<f32>> {
    let gains = Gains {
        proportional: 2.5_f32,
        integral: 0.02,
        derivative: 30.0,
    };
    let limits = Limits {
        low: -2000.0,
        high: 2000.0,
    };
    Pid::new(gains, Integration::Backward, limits).ok()
}

/// b0, b1, b2, a1, a2 of the same controller in direct form: `b0 + b1 + b2 = Ki`.
const FORM: [f64; 5] = [2.5 + 0.02 + 30.0, -2.5 - 60.0, 30.0, 1.0, 0.0];

/// The controller of idsp in fixed point; its input is the error.
pub fn idsp_fixed() -> BiquadClamp<Coefficient, i32> {
    let scales = [65_536.0, 65_536.0, 65_536.0, 1.0, 1.0];
    let mut form = [0.0; 5];
    for ((scaled, coefficient), scale) in form.iter_mut().zip(FORM).zip(scales) {
        *scaled = coefficient * scale;
    }
    let mut biquad = BiquadClamp::from(form.map(Coefficient::from_f64));
    biquad.min = -2000 * OUTPUT_BITS;
    biquad.max = 2000 * OUTPUT_BITS;
    biquad
}

/// The controller of idsp in floating point.
pub fn idsp_floating() -> BiquadClamp<f32> {
    let mut biquad = BiquadClamp::from(FORM.map(|coefficient| coefficient as f32));
    (biquad.min, biquad.max) = (-2000.0, 2000.0);
    biquad
}

/// The controller of the crate pid; its derivative is that of the measurement.
pub fn textbook(target: f32) -> pid::Pid<f32> {
    let mut pid = pid::Pid::new(target, 2000.0_f32);
    pid.p(2.5_f32, f32::MAX);
    pid.i(0.02_f32, 2000.0_f32);
    pid.d(30.0_f32, f32::MAX);
    pid
}

/// Passes every controller to `count`.
#[inline(never)]
pub fn all(count: Count<'_>) {
    let (Some(fixed), Some(floating)) = (fixed(), floating()) else {
        return;
    };
    count("husillo_pid", SAMPLES, &mut || {
        let (pid, mut state) = (black_box(&fixed), State::default());
        let target = black_box(I32F0::from_bits(500));
        for _ in 0..SAMPLES {
            let measured = black_box(I32F0::from_bits(460));
            black_box(pid.update(&mut state, target, measured));
        }
    });
    let biquad = idsp_fixed();
    count("idsp_q32_i32", SAMPLES, &mut || {
        let (biquad, mut state) = (black_box(&biquad), DirectForm1::default());
        let target = black_box(500);
        for _ in 0..SAMPLES {
            let measured = black_box(460);
            black_box(biquad.process(&mut state, target - measured));
        }
    });
    count("husillo_pid_f32", SAMPLES, &mut || {
        let (pid, mut state) = (black_box(&floating), State::default());
        let target = black_box(500.0);
        for _ in 0..SAMPLES {
            black_box(pid.update(&mut state, target, black_box(460.0)));
        }
    });
    let biquad = idsp_floating();
    count("idsp_f32", SAMPLES, &mut || {
        let (biquad, mut state) = (black_box(&biquad), DirectForm1::default());
        let target = black_box(500.0);
        for _ in 0..SAMPLES {
            black_box(biquad.process(&mut state, target - black_box(460.0)));
        }
    });
    let of_measurement = floating.with_derivative(OfMeasurement);
    count("husillo_pid_f32_meas", SAMPLES, &mut || {
        let (pid, mut state) = (black_box(&of_measurement), State::default());
        let target = black_box(500.0);
        for _ in 0..SAMPLES {
            black_box(pid.update(&mut state, target, black_box(460.0)));
        }
    });
    count("pid_f32", SAMPLES, &mut || {
        let mut pid = black_box(textbook(500.0));
        for _ in 0..SAMPLES {
            black_box(pid.next_control_output(black_box(460.0)));
        }
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Errors of a walk within the limits, as measured positions around 500.
    fn walk() -> impl Iterator<Item = i32> {
        (0..2000_i32).map(|k| 500 - (k * 7919 % 23 - 11))
    }

    /// Exact, with the derivative of the error.
    fn exact() -> std::vec::Vec<f64> {
        let (mut sum, mut before) = (0.0, 0.0);
        walk()
            .map(|measured| {
                let error = f64::from(500 - measured);
                sum += error;
                let output = 2.5 * error + 0.02 * sum + 30.0 * (error - before);
                before = error;
                output
            })
            .collect()
    }

    fn farthest(found: impl Iterator<Item = f64>) -> f64 {
        let pairs = found.zip(exact());
        pairs
            .map(|(found, exact)| (found - exact).abs())
            .fold(0.0, f64::max)
    }

    /// All controllers have the same output as accurately as they can, in units of the output; ours
    /// is a whole one.
    #[test]
    fn outputs_are_the_same() {
        let (pid, mut state) = (fixed().unwrap(), State::default());
        let target = I32F0::from_bits(500);
        let ours = farthest(walk().map(|measured| {
            pid.update(&mut state, target, I32F0::from_bits(measured))
                .into()
        }));
        let (biquad, mut state) = (idsp_fixed(), DirectForm1::default());
        let idsp = farthest(walk().map(|measured| {
            f64::from(biquad.process(&mut state, 500 - measured)) / f64::from(OUTPUT_BITS)
        }));
        let (pid, mut state) = (floating().unwrap(), State::default());
        let floating =
            farthest(walk().map(|measured| pid.update(&mut state, 500.0, measured as f32).into()));
        let (biquad, mut state) = (idsp_floating(), DirectForm1::default());
        let idsp_floating = farthest(
            walk().map(|measured| biquad.process(&mut state, 500.0 - measured as f32).into()),
        );
        let mut pid = textbook(500.0);
        // It omits the first derivative.
        let kick = 30.0 * (500.0 - f64::from(walk().next().unwrap()));
        let textbook = walk().enumerate().map(|(k, measured)| {
            let output = f64::from(pid.next_control_output(measured as f32).output);
            if k == 0 { output + kick } else { output }
        });
        let textbook = farthest(textbook);
        std::println!(
            "farthest from exact: husillo {ours:.4}, idsp {idsp:.4}, f32: \
             husillo {floating:.4}, idsp {idsp_floating:.4}, pid {textbook:.4}"
        );
        assert!(ours <= 0.51 && idsp < 1.0, "{ours} {idsp}");
        assert!(floating < 0.01 && idsp_floating < 0.1 && textbook < 0.01);
    }

    /// Samples of an error of the other sign until the output leaves the limit, after 1000 samples
    /// at it.
    #[test]
    fn windup() {
        let until = |mut update: std::boxed::Box<dyn FnMut(i32) -> f64>| {
            for _ in 0..1000 {
                update(0);
            }
            (0..20_000).take_while(|_| update(600) >= 2000.0).count()
        };
        let (pid, mut state) = (fixed().unwrap(), State::default());
        let ours = until(std::boxed::Box::new(move |measured| {
            let (target, measured) = (I32F0::from_bits(500), I32F0::from_bits(measured));
            pid.update(&mut state, target, measured).into()
        }));
        let (biquad, mut state) = (idsp_fixed(), DirectForm1::default());
        let idsp = until(std::boxed::Box::new(move |measured| {
            f64::from(biquad.process(&mut state, 500 - measured)) / f64::from(OUTPUT_BITS)
        }));
        let mut pid = textbook(500.0);
        let textbook = until(std::boxed::Box::new(move |measured| {
            pid.next_control_output(measured as f32).output.into()
        }));
        std::println!(
            "samples at the limit after the error has changed sign: \
             husillo {ours}, idsp {idsp}, pid {textbook}"
        );
        assert_eq!((ours, idsp), (0, 0));
    }
}
