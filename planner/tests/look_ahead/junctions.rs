//! Directions and corners compared with floating point.

use husillo_planner::{ArcLimits, Junction, Tangent};
use proptest::prelude::*;

const UNIT: f64 = (1 << 30) as f64;

fn vector() -> impl Strategy<Value = [i64; 3]> {
    // Vectors of all magnitudes.
    (prop::array::uniform3(any::<i64>()), 0_u32..62)
        .prop_map(|(vector, shift)| vector.map(|component| component >> shift))
}

fn float(direction: &Tangent<3>) -> [f64; 3] {
    direction
        .components()
        .map(|component| f64::from(component) / UNIT)
}

fn size(vector: [f64; 3]) -> f64 {
    vector
        .iter()
        .map(|component| component * component)
        .sum::<f64>()
        .sqrt()
}

proptest! {
    /// A direction is the vector divided by its length, to 2 units of 2^-30.
    #[test]
    fn directions_are_right(vector in vector()) {
        let exact = vector.map(|component| component as f64);
        let Some(direction) = Tangent::new(vector) else {
            prop_assert_eq!(vector, [0; 3]);
            return Ok(());
        };
        for (component, exact_component) in float(&direction).into_iter().zip(exact) {
            let error = (component - exact_component / size(exact)).abs();
            prop_assert!(error <= 2.5 / UNIT, "{error}");
        }
    }

    /// No axis exceeds its limit along a direction, and one axis reaches it.
    #[test]
    fn limits_along_a_direction(
        vector in vector(),
        axes in prop::array::uniform3(1_000_u64..1 << 32),
    ) {
        let Some(direction) = Tangent::new(vector) else { return Ok(()) };
        let parts = float(&direction).map(f64::abs);
        let exact = axes
            .iter()
            .zip(parts)
            .map(|(axis, part)| *axis as f64 / part)
            .fold(f64::MAX, f64::min);
        let acceleration = direction.acceleration_limit(&axes) as f64;
        prop_assert!((acceleration - exact).abs() <= 1.0 + exact * 1e-12, "{acceleration} {exact}");
        let speed = f64::from(direction.speed_limit(&axes.map(|axis| axis as u32)));
        let exact = exact.min(f64::from(u32::MAX));
        prop_assert!((speed - exact).abs() <= 1.0 + exact * 1e-12, "{speed} {exact}");
    }

    /// Junction speeds match the formulas to 1e-6 from a tenth of a milliradian on.
    #[test]
    fn corners_are_right(
        from in vector(), turn in prop::array::uniform3(-1.0..1.0_f64), angle in -4.0..0.5_f64,
        jumps in prop::array::uniform3(1_000_u32..100_000_000),
        deviation in 10_u32..1_000_000,
        accelerations in prop::array::uniform3(1_000_000_u64..100_000_000_000),
    ) {
        let Some(before) = Tangent::new(from) else { return Ok(()) };
        let turn = turn.map(|component| component * 10_f64.powf(angle));
        let to: Vec<i64> = float(&before)
            .iter()
            .zip(turn)
            .map(|(from, turn)| ((from + turn) * 1e15) as i64)
            .collect();
        let Some(after) = Tangent::new([to[0], to[1], to[2]]) else { return Ok(()) };
        let [a, b] = [float(&before), float(&after)];
        let change: [f64; 3] = std::array::from_fn(|axis| b[axis] - a[axis]);
        let sum: [f64; 3] = std::array::from_fn(|axis| b[axis] + a[axis]);
        prop_assume!(size(change) > 1e-4);
        let jump = change.iter().zip(jumps)
            .map(|(change, jump)| {
                if change.abs() > 4.5 / UNIT {
                    f64::from(jump) / change.abs()
                } else {
                    f64::MAX
                }
            })
            .fold(f64::MAX, f64::min);
        let sine = size(sum) / 2.0;
        let acceleration = change.iter().zip(accelerations)
            .map(|(part, limit)| limit as f64 * size(change) / part.abs())
            .fold(f64::MAX, f64::min);
        // 1 - s = h^2 / (1 + s), with h half the change.
        let half = size(change) / 2.0;
        let circle =
            (acceleration * f64::from(deviation) * sine * (1.0 + sine) / (half * half)).sqrt();
        let expect = |speed: u32, exact: f64| {
            let exact = exact.min(f64::from(u32::MAX));
            (f64::from(speed) - exact).abs() <= 1.0 + exact * 1e-6
        };
        let mut corner = Junction {
            jump_nm_per_s: Some(jumps),
            deviation_nm: None,
            acceleration_nm_per_s2: accelerations,
        };
        prop_assert!(
            expect(corner.speed(&before, &after), jump),
            "{} {jump}",
            corner.speed(&before, &after)
        );
        corner.deviation_nm = Some(deviation);
        let both = corner.speed(&before, &after);
        prop_assert!(expect(both, jump.min(circle)), "{both} {jump} {circle}");
        corner.jump_nm_per_s = None;
        let speed = corner.speed(&before, &after);
        prop_assert!(expect(speed, circle), "{speed} {circle}");
        corner.deviation_nm = None;
        prop_assert_eq!(corner.speed(&before, &after), u32::MAX);
    }

    /// Straight on has no limit, whatever the lengths of the two moves; a reversal stops under
    /// junction deviation.
    #[test]
    fn straight_on_and_back(
        vector in prop::array::uniform3(-1_000_000_i64..1_000_000),
        times in 1_i64..1000,
        jump in any::<u32>(),
    ) {
        let Some(before) = Tangent::new(vector) else { return Ok(()) };
        let after = Tangent::new(vector.map(|component| component * times)).unwrap();
        let corner = Junction {
            jump_nm_per_s: Some([jump; 3]),
            deviation_nm: Some(20_000),
            acceleration_nm_per_s2: [500_000_000; 3],
        };
        prop_assert_eq!(corner.speed(&before, &after), u32::MAX);
        prop_assert!(corner.speed(&before, &after.reversed()) == 0);
    }

    /// The two parts of the acceleration on an arc do not exceed the whole. An arc that is always
    /// slow has nearly what is left of it at its highest speed.
    #[test]
    fn arcs_stay_within_their_acceleration(
        acceleration in 1_000_u64..1 << 40,
        radius in 1_000_u64..1 << 40,
        share in 0.0..2.0_f64,
    ) {
        let lower = (acceleration as f64 / 2.0 * radius as f64).sqrt();
        let highest = (lower * share) as u32;
        let limits = ArcLimits::new(acceleration, radius, highest);
        let lower = lower.floor().min(f64::from(u32::MAX));
        let expected = lower.min(f64::from(highest));
        prop_assert!((f64::from(limits.speed_nm_per_s[0]) - expected).abs() <= 1.0);
        if f64::from(highest) < lower && u128::from(acceleration) * u128::from(radius) < 1 << 64 {
            let part = f64::from(highest).powi(2) / radius as f64 / acceleration as f64;
            let left = (1.0 - part * part).sqrt() * acceleration as f64;
            let along = limits.acceleration_nm_per_s2[0] as f64;
            prop_assert!(along >= left * (1.0 - 2e-3) - 1.0, "{along} {left}");
        }
        for (level, least) in [0.8659, 0.1979].into_iter().enumerate() {
            let speed = f64::from(limits.speed_nm_per_s[level]);
            let centre = speed * speed / radius as f64;
            let along = limits.acceleration_nm_per_s2[level] as f64;
            prop_assert!(centre.hypot(along) <= acceleration as f64);
            prop_assert!(along >= acceleration as f64 * least - 1.0);
        }
    }
}
