//! Tests against the exact cases of compensation and the table of the cosine error.

use husillo_probe::{PreTravel, Tip, UnitVector};
use serde_json::Value;

/// Units per millimetre. The number is a multiple of every denominator of the cases, so positions
/// and results are integers. It is coarse enough that the errors of the unit vectors (42e6 x 0.63 x
/// 2^-30) stay below half a unit.
const SCALE: i64 = 21_000_000;

fn oracle() -> Value {
    serde_json::from_str(include_str!("data/probe.json")).unwrap()
}

/// A fraction as numerator and denominator.
fn fraction(value: &Value) -> (i64, i64) {
    let text = value.as_str().unwrap();
    let (numerator, denominator) = text.split_once('/').unwrap_or((text, "1"));
    (numerator.parse().unwrap(), denominator.parse().unwrap())
}

fn scaled(value: &Value) -> i64 {
    let (numerator, denominator) = fraction(value);
    assert_eq!(numerator * SCALE % denominator, 0, "{value}");
    numerator * SCALE / denominator
}

fn point(value: &Value) -> [i64; 3] {
    [0, 1, 2].map(|axis| scaled(&value[axis]))
}

fn direction(value: &Value) -> UnitVector {
    // Uses the common denominator, so that the direction is exact before it is normalised.
    UnitVector::new(point(value)).unwrap()
}

fn tip(case: &Value) -> Tip<1> {
    Tip {
        radius_nm: scaled(&case["r"]) as i32,
        pre_travel: PreTravel::uniform(scaled(&case["ed"]) as i32),
    }
}

#[test]
fn compensation_is_exact() {
    let oracle = oracle();
    let cases = oracle["cases"].as_array().unwrap();
    assert_eq!(cases.len(), 22);
    for case in cases {
        let (position, travel, normal) = (
            point(&case["p"]),
            direction(&case["d"]),
            direction(&case["n"]),
        );
        let tip = tip(case);
        let surface = tip.surface_nm(position, &travel, &normal);
        assert_eq!(surface, point(&case["M"]), "{case}");
        assert_eq!(tip.position_nm(surface, &travel, &normal), position);
        if let Some(naive) = case.get("naive_normal_assumption") {
            let surface = tip.surface_nm(position, &travel, &travel.reversed());
            assert_eq!(surface, point(naive), "{case}");
        }
    }
}

#[test]
fn cosine_error_is_the_tables() {
    let oracle = oracle();
    let rows = oracle["cosine"].as_array().unwrap();
    assert_eq!(rows.len(), 9);
    for row in rows {
        let angle = row["alpha_deg"].as_f64().unwrap().to_radians();
        let normal = [-angle.cos(), angle.sin(), 0.0].map(|component| (component * 1e15) as i64);
        let radius_nm = 100_000_000;
        let tip = Tip {
            radius_nm,
            pre_travel: PreTravel::uniform(0),
        };
        let normal = UnitVector::new(normal).unwrap();
        let error = tip.cosine_error_nm(&UnitVector::X, &normal).unwrap();
        // The table has eight decimals. Their unit is a nanometre here.
        let table = row["err_over_r"].as_f64().unwrap() * f64::from(radius_nm);
        assert!((error as f64 - table).abs() <= 1.0, "{row}: {error}");
        // The cosine error is the distance along the travel between the true surface and the result
        // of compensation with the wrong normal. The point lies outside the work piece, which seems
        // larger. (The note in the vectors says "too far along d"; its numbers are right.)
        let naive = tip.surface_nm([0; 3], &UnitVector::X, &UnitVector::X.reversed());
        let surface = tip.surface_nm([0; 3], &UnitVector::X, &normal);
        let above: f64 = (0..3)
            .map(|axis| {
                (naive[axis] - surface[axis]) as f64 * normal.components()[axis].to_num::<f64>()
            })
            .sum();
        assert!((above / angle.cos() - table).abs() <= 2.0, "{row}");
    }
    let along = Tip {
        radius_nm: 1,
        pre_travel: PreTravel::uniform(0),
    };
    assert_eq!(along.cosine_error_nm(&UnitVector::X, &UnitVector::Y), None);
}
