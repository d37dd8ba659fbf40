//! Numbers of every kind give the same outputs.

use fixed::types::{I8F8, I16F16, I24F8, I32F0, I32F32, I56F8, I64F0};
use husillo_pid::{
    BackCalculation, Conditional, DeadBand, Drive, FeedForward, Filter, FilterState, Gains,
    Integration, Limits, OfMeasurement, Pid, Regulator, SettingsError, State, error,
};
use proptest::prelude::*;

const RULES: [Integration; 3] = [
    Integration::Forward,
    Integration::Backward,
    Integration::Bilinear,
];

proptest! {
    /// A controller of 64 bits gives the outputs of one of 32 bits, in every part.
    #[test]
    fn registers_of_64_bits_change_no_output(
        gains: [i16; 3],
        rule in 0_usize..3,
        high in 1_i32..100_000,
        samples in prop::collection::vec((-100_000_i32..100_000, -100_000_i32..100_000), 1..100),
    ) {
        let [proportional, integral, derivative] = gains.map(|gain| I16F16::from_bits(gain.into()));
        let narrow = Gains { proportional, integral, derivative };
        // Gains of 64 bits with the same last digit.
        let wide = Gains {
            proportional: fixed::types::I48F16::from(proportional),
            integral: integral.into(),
            derivative: derivative.into(),
        };
        let low = -high / 2;
        let of_32 = Limits { low: I24F8::from_bits(low), high: I24F8::from_bits(high) };
        let [low, high] = [low, high].map(i64::from).map(I56F8::from_bits);
        let of_64 = Limits { low, high };
        let one = Pid::new(narrow, RULES[rule], of_32).unwrap();
        let other = Pid::new(wide, RULES[rule], of_64).unwrap();
        let (clamped, clamped_wide) = (one, other);
        let (conditional, conditional_wide) =
            (one.with_anti_windup(Conditional), other.with_anti_windup(Conditional));
        let (back, back_wide) = (
            one.with_anti_windup(BackCalculation::new(integral).unwrap()),
            other.with_anti_windup(BackCalculation::new(wide.integral).unwrap()),
        );
        let mut states = [State::default(); 4];
        let mut wide_states = [State::default(); 4];
        let band = DeadBand::new(I24F8::from_bits(30));
        let band_wide = DeadBand::new(I56F8::from_bits(30));
        let forward = FeedForward::new(proportional, integral).unwrap();
        let forward_wide = FeedForward::new(wide.proportional, wide.integral).unwrap();
        let filter = Filter::of_time_constant(3);
        let (mut filtered, mut filtered_wide) = (FilterState::default(), FilterState::default());
        for (target, measured) in samples {
            let [target, measured] = [target, measured].map(I24F8::from_bits);
            let [long_target, long_measured] = [target, measured].map(I56F8::from);
            let same = |one: I24F8, other: I56F8| i64::from(one.to_bits()) == other.to_bits();
            prop_assert!(same(
                clamped.update(&mut states[0], target, measured),
                clamped_wide.update(&mut wide_states[0], long_target, long_measured)
            ));
            prop_assert!(same(
                conditional.update(&mut states[1], target, measured),
                conditional_wide.update(&mut wide_states[1], long_target, long_measured)
            ));
            prop_assert!(same(
                back.update(&mut states[2], target, measured),
                back_wide.update(&mut wide_states[2], long_target, long_measured)
            ));
            let error_32 = band.apply(error(target, measured));
            let error_64 = band_wide.apply(error(long_target, long_measured));
            prop_assert!(same(error_32, error_64));
            let slope = one.derivative(states[3].difference(error_32));
            let slope_wide = other.derivative(wide_states[3].difference(error_64));
            let added = filter.apply(&mut filtered, slope).plus(forward.term(target, measured));
            let added_wide = filter
                .apply(&mut filtered_wide, slope_wide)
                .plus(forward_wide.term(long_target, long_measured));
            prop_assert!(same(
                one.update_with(&mut states[3], error_32, added),
                other.update_with(&mut wide_states[3], error_64, added_wide)
            ));
        }
    }

    /// The whole range of 64 bits stays within the limits, and panics nowhere.
    #[test]
    fn any_numbers_of_64_bits(
        gains: [i64; 3],
        shifts: [u8; 3],
        ends: [i64; 2],
        samples: Vec<(i64, i64)>,
        rule in 0_usize..3,
    ) {
        let [proportional, integral, derivative] =
            std::array::from_fn(|index| I32F32::from_bits(gains[index] >> (shifts[index] % 64)));
        let gains = Gains { proportional, integral, derivative };
        let limits = Limits { low: ends[0], high: ends[1] };
        let Ok(pid) = Pid::new(gains, RULES[rule], limits) else { return Ok(()) };
        let pid = pid.with_derivative(OfMeasurement);
        let mut state = State::default();
        for (target, measured) in samples.into_iter().chain([(i64::MAX, i64::MIN); 5]) {
            let output = pid.update(&mut state, target, measured);
            prop_assert!((ends[0]..=ends[1]).contains(&output));
            pid.follow(&mut state, target, measured, output);
        }
    }

    /// Plain integers are `fixed` numbers without a fraction.
    #[test]
    fn plain_integers_are_whole_numbers(samples: Vec<(i32, i32)>, gains: [i16; 3]) {
        let [proportional, integral, derivative] = gains.map(|gain| I16F16::from_bits(gain.into()));
        let gains = Gains { proportional, integral, derivative };
        let plain = Limits { low: -255, high: 255 };
        let fixed = Limits { low: I32F0::from_num(-255), high: I32F0::from_num(255) };
        let plain = Pid::new(gains, Integration::Bilinear, plain).unwrap();
        let fixed = Pid::new(gains, Integration::Bilinear, fixed).unwrap();
        let (mut one, mut other) = (State::<i32>::default(), State::default());
        let (mut drive, mut drive_fixed) = (plain.begin(), fixed.begin());
        for (target, measured) in samples {
            let given = plain.update(&mut one, target, measured);
            let [target_fixed, measured_fixed] = [target, measured].map(I32F0::from_bits);
            prop_assert_eq!(given, fixed.update(&mut other, target_fixed, measured_fixed));
            let drives: [Drive; 2] = [
                plain.regulate(&mut drive, target, measured, 0),
                fixed.regulate(&mut drive_fixed, target, measured, 0),
            ];
            prop_assert_eq!(drives[0], drives[1]);
        }
    }

    /// Gains per second become gains per sample, to half of their last digit.
    #[test]
    fn gains_per_second(integral: i32, derivative: i32, period_ns in 1_u32..) {
        let gains = Gains {
            proportional: I16F16::ONE,
            integral: I16F16::from_bits(integral),
            derivative: I16F16::from_bits(derivative),
        };
        let exact_integral = f64::from(integral) * f64::from(period_ns) / 1e9;
        let exact_derivative = f64::from(derivative) * 1e9 / f64::from(period_ns);
        match gains.per_sample_ns(period_ns) {
            Ok(scaled) => {
                prop_assert_eq!(scaled.proportional, I16F16::ONE);
                let given = f64::from(scaled.integral.to_bits());
                prop_assert!((given - exact_integral).abs() <= 0.501);
                let given = f64::from(scaled.derivative.to_bits());
                prop_assert!((given - exact_derivative).abs() <= 0.501);
            }
            Err(error) => {
                prop_assert_eq!(error, SettingsError::GainsTooLarge);
                let largest = exact_integral.abs().max(exact_derivative.abs());
                prop_assert!(largest > f64::from(i32::MAX) - 1.0);
            }
        }
    }
}

#[test]
fn gains_of_every_type_convert() {
    let gains = Gains {
        proportional: 2_i64,
        integral: 500,
        derivative: 3,
    };
    let scaled = gains.per_sample_ns(10_000_000).unwrap();
    assert_eq!((scaled.integral, scaled.derivative), (5, 300));
    let gains = Gains {
        proportional: 2.0_f32,
        integral: 500.0,
        derivative: 0.5,
    };
    let scaled = gains.per_sample_ns(1_000_000).unwrap();
    assert_eq!((scaled.integral, scaled.derivative), (0.5, 500.0));
    let short = Gains {
        proportional: I8F8::ONE,
        integral: I8F8::ONE,
        derivative: I8F8::ONE,
    };
    assert_eq!(
        short.per_sample_ns(1_000),
        Err(SettingsError::GainsTooLarge)
    );
    assert_eq!(short.per_sample_ns(0), Err(SettingsError::GainsTooLarge));
}

/// Values beyond 32 bits: positions of a nanometre over metres.
#[test]
fn long_signals_are_not_cut() {
    let gains = Gains {
        proportional: I32F32::lit("0.5"),
        ..Gains::default()
    };
    let limits = Limits {
        low: I64F0::MIN,
        high: I64F0::MAX,
    };
    let pid = Pid::new(gains, Integration::Backward, limits).unwrap();
    let (target, measured) = (I64F0::from_num(9_000_000_000_i64), I64F0::ZERO);
    let output = pid.update(&mut State::default(), target, measured);
    assert_eq!(output, 4_500_000_000_i64);
}
