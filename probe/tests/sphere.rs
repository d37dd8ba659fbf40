//! A simulated measuring machine with 2 um scales and 0.5 um of noise calibrates its probe on a
//! reference and measures a sphere.
//!
//! The simulation is independent of the crate: positions are floats, touches follow from the
//! geometry alone, and every latched coordinate is a count of its scale. Its noise is the sum of
//! twelve uniform random numbers.

use husillo_probe::{
    Calibration, FitError, PreTravel, Reference, Repeatability, Sphere, Tip, Touch, UnitVector,
};
use oorandom::Rand64;

/// Noise of standard deviation 1: the sum of twelve uniform numbers.
fn normal(random: &mut Rand64) -> f64 {
    (0..12).map(|_| random.rand_float()).sum::<f64>() - 6.0
}

const SCALE_NM: f64 = 2_000.0;
const NOISE_NM: f64 = 500.0;
const TIP_NM: f64 = 1_000_000.0;

/// Pre-travel of a tripod of contacts: 6 um, with 2 um more and less three times per turn, and 3 um
/// along the stylus.
fn pre_travel_nm([x, y, z]: [f64; 3]) -> f64 {
    let round = 6_000.0 + 2_000.0 * (3.0 * y.atan2(x)).cos();
    round * (1.0 - z * z) + 3_000.0 * z * z
}

fn floats(direction: &UnitVector) -> [f64; 3] {
    direction.components().map(|component| component.to_num())
}

/// Touches with the errors of a real machine: scales, noise along the travel, pre-travel by
/// direction.
struct Prober {
    random: Rand64,
    scale_nm: f64,
    noise_nm: f64,
}

impl Prober {
    /// Returns the latched position at which the ball's centre is at `reach` from `centre`, on a
    /// travel through `centre + aside`.
    fn touch(
        &mut self,
        centre: [f64; 3],
        reach: f64,
        aside: [f64; 3],
        direction: UnitVector,
    ) -> Touch {
        let d = floats(&direction);
        let along: f64 = (0..3).map(|i| aside[i] * d[i]).sum();
        let across: f64 = (0..3).map(|i| (aside[i] - along * d[i]).powi(2)).sum();
        let beyond = pre_travel_nm(d) + self.noise_nm * normal(&mut self.random);
        // The probe meets a ball before the centre and a ring (negative reach) beyond it.
        let way = beyond - reach.signum() * (reach * reach - across).sqrt();
        let position = [0, 1, 2].map(|i| {
            let coordinate = centre[i] + aside[i] - along * d[i] + way * d[i];
            ((coordinate / self.scale_nm).round() * self.scale_nm) as i64
        });
        Touch {
            position,
            direction,
        }
    }

    /// The mean of four touches, as in the probing cycle.
    fn mean_touch(&mut self, centre: [f64; 3], reach: f64, direction: UnitVector) -> Touch {
        let touches: Vec<Touch> = (0..4)
            .map(|_| self.touch(centre, reach, [0.0; 3], direction))
            .collect();
        let position = [0, 1, 2].map(|axis| {
            let readings: Repeatability =
                touches.iter().map(|touch| touch.position[axis]).collect();
            readings.mean().unwrap()
        });
        Touch {
            position,
            direction,
        }
    }
}

/// Directions of travel to the pole and to rings of 4, 8, 4 and 8 points down to the equator, as in
/// ISO 10360-5.
fn directions() -> [UnitVector; 25] {
    let ring = |polar: f64, n: u32, from: f64| {
        (0..n).map(move |k| {
            let (polar, round) = (
                polar.to_radians(),
                (from + 360.0 / f64::from(n) * f64::from(k)).to_radians(),
            );
            [
                -polar.sin() * round.cos(),
                -polar.sin() * round.sin(),
                -polar.cos(),
            ]
        })
    };
    let all: Vec<UnitVector> = ring(0.0, 1, 0.0)
        .chain(ring(22.5, 4, 22.5))
        .chain(ring(45.0, 8, 0.0))
        .chain(ring(67.5, 4, 22.5))
        .chain(ring(90.0, 8, 0.0))
        .map(|d| UnitVector::new(d.map(|c| (c * 1e9).round() as i64)).unwrap())
        .collect();
    all.try_into().unwrap()
}

/// Calibrates on a ball of 12.5 mm in four passes and returns the tip.
fn calibrated(prober: &mut Prober) -> Tip<25> {
    let centre = [100e6, 200e6, 50e6].map(|c: f64| c + 5e4 * prober.random.rand_float());
    let touches: Vec<Touch> = (0..4)
        .flat_map(|_| directions())
        .map(|direction| prober.mean_touch(centre, 12.5e6 + TIP_NM, direction))
        .collect();
    let reference = Reference::Sphere {
        radius_nm: 12_500_000,
    };
    let calibration =
        Calibration::fit(touches, &reference, Some(TIP_NM as i32), directions()).unwrap();
    assert!(calibration.residuals.rms_nm < 1_000);
    calibration.tip
}

/// Returns the error of the radius of a ball of 10 mm, measured once in each of 25 directions.
fn radius_error_nm(prober: &mut Prober, tip: &Tip<25>) -> i64 {
    let centre = [37e6, -12e6, 5e6].map(|c: f64| c + 5e4 * prober.random.rand_float());
    let surface = directions().map(|direction| {
        let touch = prober.mean_touch(centre, 10e6 + TIP_NM, direction);
        tip.surface_nm(touch.position, &direction, &direction.reversed())
    });
    Sphere::fit(surface).unwrap().radius_nm - 10_000_000
}

#[test]
fn a_sphere_of_10_mm_measures_within_1_um() {
    let mut worst = 0;
    let errors: Repeatability = (0..400)
        .map(|trial| {
            let mut prober = Prober {
                random: Rand64::new(trial),
                scale_nm: SCALE_NM,
                noise_nm: NOISE_NM,
            };
            let tip = calibrated(&mut prober);
            let error = radius_error_nm(&mut prober, &tip);
            worst = worst.max(error.abs());
            error
        })
        .collect();
    println!(
        "400 calibrations and measurements: mean {} nm, standard deviation {} nm, worst {worst} nm",
        errors.mean().unwrap(),
        errors.standard_deviation().unwrap()
    );
    assert!(worst <= 1_000, "{worst} nm");
    assert!(errors.mean().unwrap().abs() < 100);
}

/// Without scales and noise the calibration is exact.
fn exact() -> Prober {
    Prober {
        random: Rand64::new(1),
        scale_nm: 1.0,
        noise_nm: 0.0,
    }
}

#[test]
fn ideal_touches_calibrate_to_the_nanometre() {
    let tip = calibrated(&mut exact());
    // A part that equals a displaced reference stays in its centre. The test therefore compares the
    // part that is even in the direction.
    let entries = tip.pre_travel.entries();
    let opposite = |direction: &UnitVector| {
        entries
            .iter()
            .find(|(other, _)| other.cosine(&direction.reversed()) > 0.999_999)
            .map(|&(_, nm)| f64::from(nm))
    };
    let mut pairs = 0;
    for (direction, nm) in entries {
        let Some(other) = opposite(direction) else {
            continue;
        };
        let (d, o) = (floats(direction), floats(&direction.reversed()));
        let sum = pre_travel_nm(d) + pre_travel_nm(o);
        assert!((f64::from(*nm) + other - sum).abs() < 250.0, "{d:?}");
        pairs += 1;
    }
    assert_eq!(pairs, 8);
    assert!(radius_error_nm(&mut exact(), &tip).abs() <= 1);
}

#[test]
fn a_ring_calibrates_as_a_ball_does() {
    let axis = UnitVector::new([1, -2, 40]).unwrap();
    let across = UnitVector::new([2, 1, 0]).unwrap();
    let n = floats(&axis);
    let u = floats(&across);
    let v = [
        n[1] * u[2] - n[2] * u[1],
        n[2] * u[0] - n[0] * u[2],
        n[0] * u[1] - n[1] * u[0],
    ];
    let directions = [0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11].map(|k| {
        let (s, c) = (f64::from(k) * 30.0_f64.to_radians()).sin_cos();
        UnitVector::new([0, 1, 2].map(|i| ((c * u[i] + s * v[i]) * 1e9) as i64)).unwrap()
    });
    let mut prober = exact();
    let touches = directions
        .map(|direction| prober.touch([5e6, 6e6, 7e6], -(20e6 - TIP_NM), [0.0; 3], direction));
    let reference = Reference::Ring {
        radius_nm: 20_000_000,
        axis,
    };
    let calibration =
        Calibration::fit(touches, &reference, Some(TIP_NM as i32), directions).unwrap();
    for (direction, nm) in calibration.tip.pre_travel.entries() {
        assert!((f64::from(*nm) - pre_travel_nm(floats(direction))).abs() < 30.0);
    }
    assert!(calibration.residuals.largest_nm <= 1);
    for (found, true_) in calibration
        .centre_nm
        .iter()
        .zip([5_000_000, 6_000_000, 7_000_000])
    {
        assert!((found - true_).abs() <= 30);
    }
}

#[test]
fn oblique_touches_tell_the_radius_from_the_pre_travel() {
    // Pre-travel is the same in all directions. The ball's centre touches on a sphere with a radius
    // of 13.5 mm. Approaches are 0, 4 and 8 mm off the middle.
    let mut random = Rand64::new(7);
    let centre = [1e6, 2e6, 3e6];
    let mut touches = Vec::new();
    for direction in directions() {
        let d = floats(&direction);
        for aside in [0.0, 4e6, 8e6] {
            let side = [d[1], -d[0], 0.3].map(|c| c * aside);
            let along: f64 = (0..3).map(|i| side[i] * d[i]).sum();
            let across: f64 = (0..3).map(|i| (side[i] - along * d[i]).powi(2)).sum();
            let way = 5_000.0 - (13.5e6_f64.powi(2) - across).sqrt() + 10.0 * normal(&mut random);
            touches.push(Touch {
                position: [0, 1, 2]
                    .map(|i| (centre[i] + side[i] + (way - along) * d[i]).round() as i64),
                direction,
            });
        }
    }
    let reference = Reference::Sphere {
        radius_nm: 12_500_000,
    };
    let both = Calibration::fit(touches.clone(), &reference, None, [UnitVector::Z]).unwrap();
    assert!(
        (f64::from(both.tip.radius_nm) - TIP_NM).abs() < 50.0,
        "{both:?}"
    );
    assert!((f64::from(both.tip.pre_travel.entries()[0].1) - 5_000.0).abs() < 50.0);

    // With approaches along the normal alone they cannot be separated.
    let straight = touches.into_iter().step_by(3);
    assert_eq!(
        Calibration::fit(straight.clone(), &reference, None, [UnitVector::Z]),
        Err(FitError::Inseparable)
    );
    let effective = Calibration::fit(straight, &reference, Some(995_000), [UnitVector::Z]).unwrap();
    assert!(
        effective.tip.pre_travel.entries()[0].1.abs() < 20,
        "{effective:?}"
    );
    let few = [Touch {
        position: [0; 3],
        direction: UnitVector::X,
    }; 3];
    assert_eq!(
        Calibration::fit(few, &reference, None, [UnitVector::X]),
        Err(FitError::TooFewPoints)
    );
    assert_eq!(PreTravel::uniform(5).along(&UnitVector::Y), 5);
}
