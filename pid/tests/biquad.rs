//! Filters of second order: their response, rounding, limits, and a controller behind one.

use fixed::types::{I16F16, I32F32};
use husillo_pid::{
    Biquad, BiquadState, Coefficients, FilterError, Gains, Integration, Limits, Number, Pid,
    SecondOrder, State,
};
use proptest::prelude::*;
use std::f64::consts::TAU;

/// A complex number.
#[derive(Clone, Copy, Debug)]
struct Complex(f64, f64);

impl Complex {
    fn times(self, other: Complex) -> Complex {
        Complex(
            self.0 * other.0 - self.1 * other.1,
            self.0 * other.1 + self.1 * other.0,
        )
    }

    fn size(self) -> f64 {
        self.0.hypot(self.1)
    }

    /// c0 + c1 x + c2 x^2.
    fn polynomial(self, [c0, c1, c2]: [f64; 3]) -> Complex {
        let inner = Complex(c2 * self.0 + c1, c2 * self.1).times(self);
        Complex(inner.0 + c0, inner.1)
    }

    fn over(self, other: Complex) -> Complex {
        let square = other.size().powi(2);
        let product = self.times(Complex(other.0, -other.1));
        Complex(product.0 / square, product.1 / square)
    }

    fn distance(self, other: Complex) -> f64 {
        Complex(self.0 - other.0, self.1 - other.1).size()
    }
}

/// H(jw) of the filter in s.
fn in_s(filter: &SecondOrder, w: f64) -> Complex {
    let s = Complex(0.0, w);
    s.polynomial(filter.numerator)
        .over(s.polynomial(filter.denominator))
}

/// The coefficients as real numbers.
fn real(coefficients: &Coefficients) -> ([f64; 3], [f64; 3]) {
    let digit = 0.5_f64.powi(coefficients.bits() as i32);
    let [a1, a2] = coefficients.denominator().map(|a| f64::from(a) * digit);
    let b = coefficients.numerator().map(|b| f64::from(b) * digit);
    (b, [1.0, a1, a2])
}

/// H(z) of the coefficients at an angle of z.
fn in_z(coefficients: &Coefficients, angle: f64) -> Complex {
    let (b, a) = real(coefficients);
    let back = Complex(angle.cos(), -angle.sin());
    back.polynomial(b).over(back.polynomial(a))
}

fn filters() -> impl Strategy<Value = SecondOrder> {
    prop_oneof![
        (20.0..900.0, 0.1..1.0)
            .prop_map(|(centre, part): (f64, f64)| SecondOrder::notch(centre, centre * part)),
        (20.0..900.0, 20.0..900.0).prop_map(|(zero, pole)| SecondOrder::lead_lag(zero, pole)),
        (20.0..900.0, 0.3..1.5)
            .prop_map(|(corner, damping)| SecondOrder::low_pass(corner, damping)),
    ]
}

/// The filter in `f64`, in direct form I, with its limited output fed back.
#[derive(Default)]
struct Model {
    inputs: [f64; 2],
    outputs: [f64; 2],
}

impl Model {
    fn update(&mut self, coefficients: &Coefficients, input: f64, limit: f64) -> f64 {
        let ([b0, b1, b2], [_, a1, a2]) = real(coefficients);
        let wanted = b0 * input + b1 * self.inputs[0] + b2 * self.inputs[1]
            - a1 * self.outputs[0]
            - a2 * self.outputs[1];
        let output = wanted.clamp(-limit, limit);
        self.inputs = [input, self.inputs[0]];
        self.outputs = [output, self.outputs[0]];
        output
    }
}

proptest! {
    /// The response of the rounded coefficients is that of the filter in s, at the frequency that
    /// the bilinear rule maps it to.
    #[test]
    fn responses_are_those_in_s(filter in filters(), angle in 0.01_f64..3.1) {
        let sample_hz = 2_000.0;
        let coefficients = filter.bilinear(sample_hz, None).unwrap();
        let exact = in_s(&filter, 2.0 * sample_hz * (angle / 2.0).tan());
        let given = in_z(&coefficients, angle);
        prop_assert!(given.distance(exact) < 2e-5, "{given:?} {exact:?}");
    }

    /// With pre-warping it is exact at the matched frequency.
    #[test]
    fn a_matched_frequency_is_exact(filter in filters(), matched in 20.0_f64..900.0) {
        let coefficients = filter.bilinear(2_000.0, Some(matched)).unwrap();
        let given = in_z(&coefficients, TAU * matched / 2_000.0);
        let exact = in_s(&filter, TAU * matched);
        prop_assert!(given.distance(exact) < 2e-5, "{given:?} {exact:?}");
    }

    /// Every type gives the output of the model, limits included, rounded once.
    #[test]
    fn outputs_are_those_of_the_model(
        filter in filters(),
        inputs in prop::collection::vec(-20_000_i32..20_000, 1..300),
    ) {
        let coefficients = filter.bilinear(2_000.0, None).unwrap();
        let mut model = Model::default();
        let whole = run(&coefficients, &inputs, |input| input, f64::from);
        let fixed = run(&coefficients, &inputs, I16F16::from_num::<i32>, I16F16::to_num);
        let long = run(&coefficients, &inputs, I32F32::from_num::<i32>, I32F32::to_num);
        let float = run(&coefficients, &inputs, |input| input as f32, f64::from);
        for (at, input) in inputs.iter().enumerate() {
            let exact = model.update(&coefficients, f64::from(*input), 9_000.0);
            prop_assert!((whole[at] - exact).abs() <= 0.501, "{at}: {} {exact}", whole[at]);
            prop_assert!((fixed[at] - exact).abs() < 1e-4, "{at}: {} {exact}", fixed[at]);
            prop_assert!((long[at] - exact).abs() < 1e-4, "{at}: {} {exact}", long[at]);
            prop_assert!((float[at] - exact).abs() < 2.0, "{at}: {} {exact}", float[at]);
        }
    }

    /// A constant input leaves the filter exactly, in whole counts, whatever came before.
    #[test]
    fn a_constant_comes_out_exactly(
        filter in filters(),
        before in prop::collection::vec(-2_000_i32..2_000, 0..50),
        constant in -2_000_i32..2_000,
    ) {
        let coefficients = filter.bilinear(2_000.0, None).unwrap();
        let filter = Biquad::new(&coefficients, Limits { low: i32::MIN, high: i32::MAX }).unwrap();
        let mut state = BiquadState::default();
        for input in before {
            filter.update(&mut state, input);
        }
        let last = (0..3_000).map(|_| filter.update(&mut state, constant)).last();
        prop_assert_eq!(last, Some(constant));
        let mut other = BiquadState::default();
        filter.follow(&mut other, constant, constant);
        for _ in 0..10 {
            prop_assert_eq!(filter.update(&mut other, constant), constant);
        }
    }

    /// No numbers panic, and what is made stays within its limits.
    #[test]
    fn any_numbers(
        numerator: [f64; 3],
        denominator: [f64; 3],
        rate: f64,
        matched: Option<f64>,
        inputs: Vec<i32>,
        floats: Vec<f32>,
    ) {
        let filter = SecondOrder { numerator, denominator };
        for (rate, matched) in [(rate, matched), (1_000.0, None), (1_000.0, Some(100.0))] {
            let Ok(coefficients) = filter.bilinear(rate, matched) else { continue };
            for high in [i32::MAX, 100] {
                let limits = Limits { low: -100, high };
                let filter = Biquad::new(&coefficients, limits).unwrap();
                let mut state = BiquadState::default();
                for input in inputs.iter().chain(&[i32::MAX, i32::MIN, i32::MAX]) {
                    prop_assert!((-100..=high).contains(&filter.update(&mut state, *input)));
                }
            }
            let filter = Biquad::new(&coefficients, Limits { low: -1.0, high: 1.0 }).unwrap();
            let mut state = BiquadState::default();
            for input in floats.iter().chain(&[f32::NAN, 1.0]) {
                filter.update(&mut state, *input);
            }
        }
    }
}

/// Runs a filter with limits of 9000 on inputs.
fn run<S: Number>(
    coefficients: &Coefficients,
    inputs: &[i32],
    into: impl Fn(i32) -> S,
    out: impl Fn(S) -> f64,
) -> Vec<f64> {
    let limits = Limits {
        low: into(-9_000),
        high: into(9_000),
    };
    let filter = Biquad::new(coefficients, limits).unwrap();
    let mut state = BiquadState::default();
    let update = |input: &i32| out(filter.update(&mut state, into(*input)));
    inputs.iter().map(update).collect()
}

/// The largest output of a sine of 10 000 counts, after it has settled.
fn amplitude(coefficients: &Coefficients, hz: f64) -> i32 {
    let limits = Limits {
        low: i32::MIN,
        high: i32::MAX,
    };
    let filter = Biquad::new(coefficients, limits).unwrap();
    let mut state = BiquadState::default();
    let outputs = (0..20_000).map(|sample| {
        let angle = TAU * hz / 2_000.0 * f64::from(sample);
        filter.update(&mut state, (10_000.0 * angle.sin()).round() as i32)
    });
    outputs.skip(18_000).map(i32::abs).max().unwrap()
}

#[test]
fn a_notch_takes_out_its_frequency_alone() {
    const NOTCH: Result<Coefficients, FilterError> =
        SecondOrder::notch(123.0, 30.0).bilinear(2_000.0, Some(123.0));
    let notch = NOTCH.unwrap();
    assert!(amplitude(&notch, 123.0) <= 1);
    assert!(amplitude(&notch, 10.0).abs_diff(10_000) < 20);
    // The edges of its width are at 0.71.
    let half_width = (123.0_f64.powi(2) + 15.0_f64.powi(2)).sqrt() - 15.0;
    // The edge is 15 Hz off the matched frequency, so the rule shifts it by 0.3 Hz.
    assert!(amplitude(&notch, half_width).abs_diff(7_071) < 150);
}

#[test]
fn a_lead_lag_has_its_gains() {
    let lead = SecondOrder::lead_lag(10.0, 100.0)
        .bilinear(2_000.0, None)
        .unwrap();
    assert!(amplitude(&lead, 0.5).abs_diff(10_000) < 20);
    assert!(amplitude(&lead, 900.0).abs_diff(100_000) < 500);
}

/// A filter that is at its limit for long leaves it in the sample in which the model does.
#[test]
fn a_filter_does_not_wind_up() {
    let filter = SecondOrder::low_pass(50.0, 0.7)
        .bilinear(2_000.0, None)
        .unwrap();
    let limits = Limits {
        low: -255,
        high: 255,
    };
    let filter = Biquad::new(&filter, limits).unwrap();
    let mut states = [BiquadState::default(); 2];
    let [mut long, mut short] = [0, 0];
    for _ in 0..10_000 {
        long = filter.update(&mut states[0], 100_000);
    }
    filter.follow(&mut states[1], 100_000, 255);
    assert_eq!(long, 255);
    for _ in 0..50 {
        long = filter.update(&mut states[0], 0);
        short = filter.update(&mut states[1], 0);
        assert_eq!(long, short);
    }
    assert!(short < 255);
}

/// A notch before a controller leaves its anti-windup as it is: after 1000 samples at the limit,
/// the output leaves it in the same sample as without a notch.
#[test]
fn the_controller_behind_a_notch_does_not_wind_up() {
    let gains = Gains {
        proportional: I16F16::from_num(1),
        integral: I16F16::lit("0.1"),
        derivative: I16F16::ZERO,
    };
    let limits = Limits {
        low: -255,
        high: 255,
    };
    let pid: Pid<i32, I16F16> = Pid::new(gains, Integration::Bilinear, limits).unwrap();
    let notch = SecondOrder::notch(300.0, 100.0)
        .bilinear(2_000.0, Some(300.0))
        .unwrap();
    let all = Limits {
        low: i32::MIN,
        high: i32::MAX,
    };
    let notch = Biquad::new(&notch, all).unwrap();
    let [mut with, mut without] = [State::default(), State::default()];
    let mut filter = BiquadState::default();
    for _ in 0..1_000 {
        let measured = notch.update(&mut filter, 0);
        assert_eq!(pid.update(&mut with, 5_000, measured), 255);
        assert_eq!(pid.update(&mut without, 5_000, 0), 255);
    }
    notch.follow(&mut filter, 5_001, 5_001);
    let measured = notch.update(&mut filter, 5_001);
    let outputs = [
        pid.update(&mut with, 5_000, measured),
        pid.update(&mut without, 5_000, 5_001),
    ];
    assert!(outputs[0] < 255 && outputs[0] == outputs[1], "{outputs:?}");
}

#[test]
fn what_cannot_be_made_is_refused() {
    let notch = SecondOrder::notch(100.0, 10.0);
    assert_eq!(notch.bilinear(0.0, None), Err(FilterError::NotFinite));
    assert_eq!(notch.bilinear(f64::NAN, None), Err(FilterError::NotFinite));
    assert_eq!(
        notch.bilinear(200.0, Some(100.0)),
        Err(FilterError::AboveHalfTheRate)
    );
    let unstable = SecondOrder {
        numerator: [1.0, 0.0, 0.0],
        denominator: [1.0, -1.0, 0.0],
    };
    assert_eq!(unstable.bilinear(1_000.0, None), Err(FilterError::Unstable));
    let large = SecondOrder {
        numerator: [1e10, 0.0, 0.0],
        denominator: [1.0, 1.0, 0.0],
    };
    assert_eq!(large.bilinear(1.0, None), Err(FilterError::TooLarge));
    let coefficients = notch.bilinear(1_000.0, None).unwrap();
    assert!(Biquad::new(&coefficients, Limits { low: 1, high: 0 }).is_err());
    // An integrator is at the border, and its limits hold it.
    let integrator = SecondOrder {
        numerator: [1.0, 0.0, 0.0],
        denominator: [0.0, 1.0, 0.0],
    };
    assert!(integrator.bilinear(1_000.0, None).is_ok());
}
