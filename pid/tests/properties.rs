//! Properties for all gains and all signals.

use fixed::types::{I8F0, I12F4, I16F0, I16F16, I24F8, I32F0};
use husillo_pid::{
    AntiWindup, BackCalculation, Clamp, Conditional, DeadBand, Derivative, FeedForward, Filter,
    FilterState, Gains, Integration, Limits, OfError, OfMeasurement, Pid, SettingsError, State,
    Term, error,
};
use proptest::prelude::*;

type Law<A = Clamp, D = OfError> = Pid<I32F0, I16F16, A, D>;

const RULES: [Integration; 3] = [
    Integration::Forward,
    Integration::Backward,
    Integration::Bilinear,
];
const WIDEST: Limits<I32F0> = Limits {
    low: I32F0::MIN,
    high: I32F0::MAX,
};
const ZERO: I32F0 = I32F0::ZERO;

fn counts(count: i32) -> I32F0 {
    I32F0::from_bits(count)
}

/// Any gains that a controller accepts.
fn gains() -> impl Strategy<Value = Gains<I16F16>> {
    let third = (1 << 29) / 3;
    prop_oneof![
        [-third..third, -third..third, -third..third],
        [-0x40000..0x40000, -0x40000..0x40000, -0x40000..0x40000]
    ]
    .prop_map(|bits| of(bits.map(I16F16::from_bits)))
}

/// Gains of a useful controller: all of one sign, the first two not 0.
fn sane_gains() -> impl Strategy<Value = Gains<I16F16>> {
    (0x8000..0x80_0000, 0x100..0x8_0000, 0..0x80_0000)
        .prop_map(|(p, i, d)| of([p, i, d].map(I16F16::from_bits)))
}

fn of([proportional, integral, derivative]: [I16F16; 3]) -> Gains<I16F16> {
    Gains {
        proportional,
        integral,
        derivative,
    }
}

fn rule() -> impl Strategy<Value = Integration> {
    prop_oneof![Just(RULES[0]), Just(RULES[1]), Just(RULES[2])]
}

fn any_signal() -> impl Strategy<Value = i32> {
    prop_oneof![any::<i32>(), -1000i32..1000, Just(i32::MIN), Just(i32::MAX)]
}

fn limits() -> impl Strategy<Value = Limits<I32F0>> {
    (any_signal(), any_signal()).prop_map(|(a, b)| Limits {
        low: counts(a.min(b)),
        high: counts(a.max(b)),
    })
}

fn run<A: AntiWindup<i32>, D: Derivative>(pid: &Law<A, D>, errors: &[i32]) -> Vec<i32> {
    let mut state = State::default();
    errors
        .iter()
        .map(|error| pid.update(&mut state, counts(*error), ZERO).to_bits())
        .collect()
}

/// The law in 128 bits, as numerators over 2^17.
fn exact(gains: &Gains<I16F16>, rule: Integration, errors: &[i32]) -> Vec<i128> {
    let [p, i, d] = [gains.proportional, gains.integral, gains.derivative]
        .map(|gain| i128::from(gain.to_bits()));
    let (mut sum, mut previous) = (0, 0);
    errors
        .iter()
        .map(|error| {
            let error = i128::from(*error);
            let twice = match rule {
                Integration::Forward => 2 * sum,
                Integration::Backward => 2 * (sum + error),
                Integration::Bilinear => 2 * sum + error,
            };
            sum += error;
            let output = 2 * p * error + i * twice + 2 * d * (error - previous);
            previous = error;
            output
        })
        .collect()
}

proptest! {
    /// While no limit is reached, the output is the exact law rounded once, for any number of
    /// samples.
    #[test]
    fn output_is_the_law_rounded_once(
        gains in gains(),
        rule in rule(),
        errors in proptest::collection::vec(-1000i32..1000, 1..300),
    ) {
        let exact = exact(&gains, rule, &errors);
        prop_assume!(exact.iter().all(|output| output.abs() < 1 << 47));
        let pid = Law::new(gains, rule, WIDEST).unwrap();
        for (output, exact) in run(&pid, &errors).into_iter().zip(exact) {
            prop_assert_eq!(i128::from(output), (exact + (1 << 16)) >> 17);
        }
    }

    /// The sum is exact: any order of the same errors gives the same integral.
    #[test]
    fn order_of_errors_does_not_matter(
        gains in gains(),
        mut errors in proptest::collection::vec(-30_000i32..30_000, 1..200),
        seed in any::<u64>(),
    ) {
        let gains = Gains { integral: gains.integral / 4096, ..gains };
        let pid = Law::new(gains, Integration::Forward, WIDEST).unwrap();
        let integral = |errors: &[i32]| {
            let mut state = State::default();
            for error in errors {
                pid.update(&mut state, counts(*error), ZERO);
            }
            pid.integral(&state)
        };
        let one = integral(&errors);
        let length = errors.len();
        for k in 0..length {
            errors.swap(k, (seed.wrapping_mul(k as u64 + 1) >> 20) as usize % length);
        }
        prop_assert_eq!(integral(&errors), one);
        let back: Vec<i32> = errors.iter().chain(
            &errors.iter().map(|error| -error).collect::<Vec<_>>()
        ).copied().collect();
        prop_assert_eq!(integral(&back), ZERO);
    }

    /// The bilinear rule is the mean of forward and backward, except for the three roundings.
    #[test]
    fn bilinear_is_the_mean(
        gains in sane_gains(),
        errors in proptest::collection::vec(-1000i32..1000, 1..200),
    ) {
        let [forward, backward, bilinear] = RULES.map(
            |rule| run(&Law::new(gains, rule, WIDEST).unwrap(), &errors)
        );
        for ((forward, backward), bilinear) in forward.into_iter().zip(backward).zip(bilinear) {
            prop_assert!((2 * bilinear - forward - backward).abs() <= 2);
        }
    }

    /// The output is within the limits for all gains, limits and signals.
    #[test]
    fn limits_hold(
        gains in gains(),
        rule in rule(),
        limits in limits(),
        inner in limits(),
        lead in 0..(1 << 29),
        parts in any::<[i32; 2]>(),
        signals in proptest::collection::vec((any_signal(), any_signal()), 1..50),
    ) {
        let pid = Law::new(gains, rule, limits).unwrap().with_integral_limits(inner).unwrap();
        let back = BackCalculation::new(I16F16::from_bits(lead)).unwrap();
        let ahead = FeedForward::new(
            I16F16::from_bits(lead / 2),
            I16F16::from_bits(-lead / 2),
        ).unwrap();
        let mut states = [State::default(); 5];
        let mut filtered = FilterState::default();
        for (target, measured) in signals {
            let (target, measured) = (counts(target), counts(measured));
            let [a, b, c, d, e] = &mut states;
            let slope = pid.derivative(e.difference(error(target, measured)));
            let added = Filter::of_time_constant(3).apply(&mut filtered, slope)
                .plus(ahead.term(counts(parts[0]), counts(parts[1])))
                .plus(Term::constant(target));
            for output in [
                pid.update(a, target, measured),
                pid.with_anti_windup(Conditional).update(b, target, measured),
                pid.with_anti_windup(back).update(c, target, measured),
                pid.with_derivative(OfMeasurement).update(d, target, measured),
                pid.update_with(e, error(target, measured), added),
            ] {
                prop_assert!(limits.low <= output && output <= limits.high);
            }
            for state in &states {
                prop_assert!(inner.low <= pid.integral(state) && pid.integral(state) <= inner.high);
            }
        }
    }

    /// The output leaves its limit in the sample in which the error changes sign, however long it
    /// was there, with every anti-windup method.
    #[test]
    fn leaves_the_limit_with_the_sign(
        gains in sane_gains(),
        rule in rule(),
        limit in 10i32..100_000,
        ticks in 1usize..2000,
        drive in 1i32..10_000,
        pull in 2i32..10_000,
    ) {
        let limits = Limits { low: counts(-limit), high: counts(limit) };
        let pid = Law::new(gains, rule, limits).unwrap();
        let back = BackCalculation::new(I16F16::lit("0.125")).unwrap();
        for sign in [1, -1] {
            let leaves = |outputs: Vec<i32>| {
                // An error of 2 pulls by at least one count in every rule, because Kp is at least
                // 1/2.
                outputs.last().is_some_and(
                    |output| output.abs() < limit || output.signum() == -sign
                )
            };
            let mut errors = vec![sign * drive; ticks];
            errors.push(-sign * pull);
            prop_assert!(leaves(run(&pid, &errors)));
            prop_assert!(leaves(run(&pid.with_anti_windup(Conditional), &errors)));
            prop_assert!(leaves(run(&pid.with_anti_windup(back), &errors)));
        }
    }

    /// Conditional integration does not integrate while the output is cut off in the direction of
    /// the error.
    #[test]
    fn conditional_holds_still(
        gains in sane_gains(),
        errors in proptest::collection::vec(-5000i32..5000, 1..100),
    ) {
        let gains = Gains { derivative: I16F16::ZERO, ..gains };
        let limits = Limits { low: counts(-1000), high: counts(1000) };
        let pid = Law::new(
            gains,
            Integration::Forward,
            limits,
        ).unwrap().with_anti_windup(Conditional);
        let mut state = State::default();
        for error in errors {
            let before = pid.integral(&state);
            let output = pid.update(&mut state, counts(error), ZERO);
            let p = (i64::from(gains.proportional.to_bits()) * i64::from(error)) >> 16;
            // The unlimited output is the previous integral plus P, with room for the roundings.
            if i64::from(before.to_bits()) + p > 1002 && error > 0 {
                prop_assert_eq!(output, 1000);
                prop_assert_eq!(pid.integral(&state), before);
            }
        }
    }

    /// Back-calculation moves the integral until exactly step / gain of the output is cut off.
    #[test]
    fn back_calculation_settles(error in 25i32..2000) {
        let gains = of([I16F16::ONE, I16F16::lit("0.01"), I16F16::ZERO]);
        let limits = Limits { low: counts(-1000), high: counts(1000) };
        let back = BackCalculation::new(I16F16::lit("0.25")).unwrap();
        let pid = Law::new(gains, Integration::Forward, limits).unwrap().with_anti_windup(back);
        let mut state = State::default();
        for _ in 0..20_000 {
            pid.update(&mut state, counts(error), ZERO);
        }
        let wanted = pid.integral(&state).to_bits() + error;
        let integral_is_free = (-999..=999).contains(&pid.integral(&state).to_bits());
        prop_assert!(!integral_is_free || (wanted - 1000 - error / 25).abs() <= 2, "{}", wanted);
    }

    /// After `follow` the next output for the same signals equals the followed output to the last
    /// digit, as far as the limits of the integral allow.
    #[test]
    fn following_is_bumpless(
        gains in sane_gains(),
        other in sane_gains(),
        rule in rule(),
        target in -1000i32..1000,
        measured in -1000i32..1000,
        manual in -9000i32..9000,
    ) {
        let limits = Limits { low: counts(-10_000), high: counts(10_000) };
        let inner = Limits { low: counts(i32::MIN / 2), high: counts(i32::MAX / 2) };
        let (target, measured) = (counts(target), counts(measured));
        let pid = Law::new(gains, rule, limits).unwrap().with_integral_limits(inner).unwrap();
        let next = Law::new(other, rule, limits).unwrap().with_integral_limits(inner).unwrap();
        // Manual to automatic.
        let mut state = State::default();
        pid.follow(&mut state, target, measured, counts(manual));
        let automatic = pid.update(&mut state, target, measured);
        prop_assert_eq!(automatic, manual);
        // Change of gains with the last output.
        next.follow(&mut state, target, measured, automatic);
        prop_assert_eq!(next.update(&mut state, target, measured), automatic);
        // The same with the derivative of the measurement.
        let mut state = State::default();
        let pid = pid.with_derivative(OfMeasurement);
        pid.follow(&mut state, target, measured, counts(manual));
        prop_assert_eq!(pid.update(&mut state, target, measured), manual);
    }

    /// A change of the integral gain alone needs only the new settings: the sum is unchanged.
    #[test]
    fn integral_gain_may_change(
        gains in sane_gains(),
        integral in 0x100i32..0x8_0000,
        errors in proptest::collection::vec(-1000i32..1000, 1..100),
    ) {
        let pid = Law::new(gains, Integration::Forward, WIDEST).unwrap();
        let next = Law::new(
            Gains { integral: I16F16::from_bits(integral), ..gains },
            Integration::Forward,
            WIDEST,
        ).unwrap();
        let mut state = State::default();
        for error in errors {
            pid.update(&mut state, counts(error), ZERO);
        }
        let (mut one, mut other) = (state, state);
        prop_assert_eq!(
            pid.update(&mut one, counts(7), ZERO),
            next.update(&mut other, counts(7), ZERO),
        );
    }

    /// A step of the target causes a kick of the derivative of the error and none of the derivative
    /// of the measurement. A step of the measurement causes the same kick of both.
    #[test]
    fn measurement_does_not_kick(
        gains in sane_gains(),
        before in -1000i32..1000,
        after in -1000i32..1000,
    ) {
        let gains = Gains { integral: I16F16::ZERO, ..gains };
        let of_error = Law::new(gains, Integration::Backward, WIDEST).unwrap();
        let of_measurement = of_error.with_derivative(OfMeasurement);
        let p_alone = Law::new(
            Gains { derivative: I16F16::ZERO, ..gains },
            Integration::Backward,
            WIDEST,
        ).unwrap();
        let (mut one, mut other) = (State::default(), State::default());
        of_error.update(&mut one, counts(before), counts(before));
        of_measurement.update(&mut other, counts(before), counts(before));
        let p = p_alone.update(&mut State::default(), counts(after), counts(before));
        let (mut kicked, mut calm) = (one, other);
        prop_assert_eq!(of_measurement.update(&mut calm, counts(after), counts(before)), p);
        let kick = of_error.update(&mut kicked, counts(after), counts(before));
        prop_assert!(
            gains.derivative == 0 || (kick - p).to_bits().signum() * (after - before).signum() >= 0
        );
        prop_assert_eq!(
            of_error.update(&mut one, counts(before), counts(after)),
            of_measurement.update(&mut other, counts(before), counts(after)),
        );
    }

    /// The separate parts together equal the whole: without added terms they return what `update`
    /// returns.
    #[test]
    fn pieces_make_the_whole(
        gains in gains(),
        rule in rule(),
        limits in limits(),
        signals in proptest::collection::vec((any_signal(), any_signal()), 1..50),
    ) {
        let pid = Law::new(gains, rule, limits).unwrap();
        let band = DeadBand::new(ZERO);
        let (mut whole, mut pieces) = (State::default(), State::default());
        for (target, measured) in signals {
            let (target, measured) = (counts(target), counts(measured));
            let rest = band.apply(error(target, measured));
            let slope = pid.derivative(pieces.difference(rest));
            prop_assert_eq!(
                pid.update_with(&mut pieces, rest, slope.plus(Term::constant(ZERO))),
                pid.update(&mut whole, target, measured),
            );
        }
        prop_assert_eq!(whole, pieces);
    }

    /// The rest outside a dead band is never farther from 0 than the error and never has the other
    /// sign. It grows by as much as the error.
    #[test]
    fn dead_band_shortens(width in any::<i32>(), one in any::<i32>(), other in any::<i32>()) {
        let band = DeadBand::new(counts(width));
        let left = |error: i32| i64::from(band.apply(counts(error)).to_bits());
        prop_assert!(left(one).abs() <= i64::from(one).abs() && left(one) * i64::from(one) >= 0);
        prop_assert!((left(one) - left(other)).abs() <= (i64::from(one) - i64::from(other)).abs());
        let width = i64::from(width).abs().min(i64::from(i32::MAX));
        prop_assert_eq!(left(one) == 0, i64::from(one).abs() <= width);
    }

    /// A filter approaches its input and never overshoots. After its time constant roughly e^-1 of
    /// the step remains.
    #[test]
    fn filter_goes_towards_its_input(samples in 1u16..500, input in 1i32..1_000_000) {
        let (filter, mut state) = (
            Filter::of_time_constant(samples),
            FilterState::<I32F0, I16F16>::default(),
        );
        let pid = Law::new(of([I16F16::ZERO; 3]), Integration::Backward, WIDEST).unwrap();
        let mut last = 0;
        for k in 0..20 * u32::from(samples) {
            let output = pid.update_with(
                &mut State::default(),
                ZERO,
                filter.apply(&mut state, Term::constant(counts(input))),
            ).to_bits();
            prop_assert!(last <= output && output <= input);
            last = output;
            if k + 1 == u32::from(samples) {
                let part = 1.0 - (1.0 - 1.0 / (f64::from(samples) + 1.0)).powi(samples.into());
                prop_assert!(
                    (
                        f64::from(output) - part * f64::from(input)
                    ).abs() <= 1.0 + f64::from(input) * 0.01
                );
            }
        }
        prop_assert!(input - last <= 1 + input / 10_000);
    }

    /// Feed-forward equals its gains times its signals, rounded together with the other terms.
    #[test]
    fn feed_forward_is_linear(
        gains in [-0x100_0000i32..0x100_0000, -0x100_0000..0x100_0000],
        velocity in -10_000i32..10_000,
        acceleration in -10_000i32..10_000,
    ) {
        let ahead = FeedForward::new(
            I16F16::from_bits(gains[0]),
            I16F16::from_bits(gains[1]),
        ).unwrap();
        let pid = Law::new(of([I16F16::ZERO; 3]), Integration::Backward, WIDEST).unwrap();
        let output = pid.update_with(
            &mut State::default(),
            ZERO,
            ahead.term(counts(velocity), counts(acceleration)),
        );
        let exact = i64::from(gains[0]) * i64::from(velocity) + i64::from(gains[1]) * i64::from(
            acceleration
        );
        prop_assert_eq!(i64::from(output.to_bits()), (exact + (1 << 15)) >> 16);
    }

    /// Narrow types saturate at the ends of their range and agree with wide types elsewhere.
    #[test]
    fn narrow_types_agree(
        gains in sane_gains(),
        signals in proptest::collection::vec((any::<i16>(), any::<i16>()), 1..50),
    ) {
        let narrow = Limits { low: I16F0::MIN, high: I16F0::MAX };
        let wide = Limits { low: I32F0::from_num(i16::MIN), high: I32F0::from_num(i16::MAX) };
        let narrow = Pid::<I16F0, I16F16>::new(gains, Integration::Bilinear, narrow).unwrap();
        let wide = Law::new(gains, Integration::Bilinear, wide).unwrap();
        let (mut one, mut other) = (State::default(), State::default());
        for (target, measured) in signals {
            let output = narrow.update(
                &mut one,
                I16F0::from_bits(target),
                I16F0::from_bits(measured),
            );
            prop_assert_eq!(
                i32::from(output.to_bits()),
                wide.update(&mut other, counts(target.into()), counts(measured.into())).to_bits(),
            );
        }
        prop_assert_eq!(error(I8F0::MAX, I8F0::MIN), I8F0::MAX);
        prop_assert_eq!(error(I16F0::MIN, I16F0::MAX), I16F0::MIN);
    }

    /// With floats the outputs stay finite and within the limits for any sensor value.
    #[test]
    fn broken_sensors_drive_nothing(signals in proptest::collection::vec(any::<f32>(), 1..50)) {
        let gains = Gains { proportional: 2.0_f32, integral: 0.1, derivative: 3.0 };
        let pid = Pid::<f32>::new(
            gains,
            Integration::Bilinear,
            Limits { low: -10.0, high: 10.0 },
        ).unwrap();
        let mut state = State::default();
        for measured in signals {
            let output = pid.update(&mut state, 1.0, measured);
            prop_assert!((-10.0..=10.0).contains(&output));
        }
    }
}

#[test]
fn one_setting_serves_many_axes() {
    let gains = of([I16F16::ONE, I16F16::lit("0.5"), I16F16::ZERO]);
    let limits = Limits {
        low: I24F8::from_num(-100),
        high: I24F8::from_num(100),
    };
    let pid = Pid::<I24F8, I16F16>::new(gains, Integration::Backward, limits).unwrap();
    let mut axes = [State::default(); 2];
    let mut drive = |axis: usize, target: i32| {
        pid.update(&mut axes[axis], I24F8::from_num(target), I24F8::ZERO)
    };
    assert_eq!(
        [drive(0, 10), drive(1, -4), drive(0, 10), drive(1, -4)],
        [15, -6, 20, -8]
    );
}

#[test]
fn settings_that_cannot_be() {
    let limits = Limits {
        low: counts(-1),
        high: counts(1),
    };
    let new = |gains, limits| Law::new(gains, Integration::Forward, limits).map(|_| ());
    let large = I16F16::from_num(4096);
    assert_eq!(new(of([large, large, I16F16::ZERO]), limits), Ok(()));
    assert_eq!(
        new(of([large, -large, I16F16::DELTA]), limits),
        Err(SettingsError::GainsTooLarge)
    );
    let crossed = Limits {
        low: counts(1),
        high: counts(0),
    };
    assert_eq!(
        new(Gains::default(), crossed),
        Err(SettingsError::LimitsCrossed)
    );
    type Fine = fixed::types::I2F30;
    let fine = Pid::<I32F0, Fine>::new(Gains::default(), Integration::Forward, limits);
    assert_eq!(fine, Err(SettingsError::FractionTooFine));
    let narrow = Limits {
        low: I12F4::MIN,
        high: I12F4::MAX,
    };
    assert!(Pid::<I12F4>::new(Gains::default(), Integration::Forward, narrow).is_ok());
    let nan = Limits {
        low: f32::NAN,
        high: 1.0,
    };
    assert_eq!(
        Pid::<f32>::new(Gains::default(), Integration::Forward, nan),
        Err(SettingsError::LimitsCrossed)
    );
    let infinite = Gains {
        proportional: f32::INFINITY,
        ..Gains::default()
    };
    assert_eq!(
        Pid::<f32>::new(
            infinite,
            Integration::Forward,
            Limits {
                low: 0.0,
                high: 1.0
            }
        ),
        Err(SettingsError::GainsTooLarge)
    );
    assert_eq!(
        SettingsError::LimitsCrossed.to_string(),
        "low limit above high limit"
    );
    assert_eq!(
        RULES.map(Integration::formula),
        ["T/(z-1)", "Tz/(z-1)", "T/2 (z+1)/(z-1)"]
    );
    assert_eq!(RULES[2].to_string(), "T/2 (z+1)/(z-1)");
}
