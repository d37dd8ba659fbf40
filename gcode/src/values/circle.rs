//! Sines and cosines in integers, and the rotation of points.
//!
//! Fixed-point numbers here are `value * 2^62` ("Q62").

#[cfg(feature = "extended")]
use crate::values::nm::Nm;
#[cfg(feature = "extended")]
use crate::values::wide::shift_rounded;

/// 1/1!, 1/3!, 1/5!, ... Q62: the series of the sine. The truncation error is below 10^-19 up to 45
/// degrees.
const SINE: [i64; 9] = [
    4611686018427387904,
    768614336404564651,
    38430716820228233,
    915017067148291,
    12708570377060,
    115532457973,
    740592679,
    3526632,
    12966,
];

/// 1/0!, 1/2!, 1/4!, ... Q62.
const COSINE: [i64; 10] = [
    4611686018427387904,
    2305843009213693952,
    192153584101141163,
    6405119470038039,
    114377133393536,
    1270857037706,
    9627704831,
    52899477,
    220414,
    720,
];

/// The product of two Q62 numbers below 2.
pub(crate) fn product(a: i64, b: i64) -> i64 {
    (i128::from(a).wrapping_mul(i128::from(b)) >> 62) as i64
}

/// Sum of an alternating series in `square`, Q62.
fn series(coefficients: &[i64], square: i64) -> i64 {
    coefficients.iter().rev().fold(0, |sum, &coefficient| {
        coefficient.wrapping_sub(product(sum, square))
    })
}

/// Sine and cosine of an angle in radians, Q62, up to 45 degrees. Within 2^-59.
pub(crate) fn of_radians(radians: i64) -> (i64, i64) {
    let square = product(radians, radians);
    let sine = product(radians, series(&SINE, square));
    (sine, series(&COSINE, square))
}

/// A rotation about the origin.
#[cfg(feature = "extended")]
#[derive(Copy, Clone, Debug)]
pub(crate) struct Turn {
    /// Q62.
    sine: i64,
    cosine: i64,
}

/// Billionths of a degree in a quarter turn.
#[cfg(feature = "extended")]
const QUARTER: i64 = 90_000_000_000;

#[cfg(feature = "extended")]
impl Turn {
    /// A rotation by billionths of a degree, counter-clockwise. Exact at quarter turns.
    pub(crate) fn of(nano_degrees: i64) -> Turn {
        let turn = nano_degrees.rem_euclid(QUARTER * 4);
        let (quarters, rest) = (turn / QUARTER, turn % QUARTER);
        let folded = rest.min(QUARTER.wrapping_sub(rest));
        // pi / 180 / 10^9 in 2^-99; times 45 * 10^9 below 2^100.
        const RADIAN: u64 = 11_062_338_369_432_492_677;
        let radians = u128::from(folded.unsigned_abs()).wrapping_mul(u128::from(RADIAN)) >> 37;
        let (sine, cosine) = of_radians(radians as i64);
        let (sine, cosine) = if folded == rest {
            (sine, cosine)
        } else {
            (cosine, sine)
        };
        let (sine, cosine) = match quarters {
            0 => (sine, cosine),
            1 => (cosine, sine.wrapping_neg()),
            2 => (sine.wrapping_neg(), cosine.wrapping_neg()),
            _ => (cosine.wrapping_neg(), sine),
        };
        Turn { sine, cosine }
    }

    /// The opposite rotation.
    pub(crate) const fn back(self) -> Turn {
        Turn {
            sine: self.sine.wrapping_neg(),
            ..self
        }
    }

    /// A rotated vector, rounded to the nanometre. Components below 2^60 give components below
    /// 2^61.
    pub(crate) fn applied(self, [x, y]: [Nm; 2]) -> [Nm; 2] {
        self.scaled([x.0, y.0], 62).map(Nm)
    }

    /// `vector * turn / 2^(bits - 62)`, rounded; components below 2^62.
    pub(crate) fn scaled(self, vector: [i64; 2], bits: u32) -> [i64; 2] {
        let [x, y] = vector.map(i128::from);
        let (sine, cosine) = (i128::from(self.sine), i128::from(self.cosine));
        // Products below 2^124.
        let across = cosine.wrapping_mul(x).wrapping_sub(sine.wrapping_mul(y));
        let along = sine.wrapping_mul(x).wrapping_add(cosine.wrapping_mul(y));
        [across, along].map(|sum| shift_rounded(sum, bits) as i64)
    }
}

#[cfg(all(test, feature = "extended"))]
mod tests {
    extern crate std;
    use super::*;

    #[test]
    fn quarter_turns_are_exact() {
        let point = [Nm(3), Nm(-4)];
        for (degrees, turned) in [
            (0, [3, -4]),
            (90, [4, 3]),
            (180, [-3, 4]),
            (270, [-4, -3]),
            (-90, [-4, -3]),
            (720, [3, -4]),
        ] {
            let turn = Turn::of(degrees * 1_000_000_000);
            assert_eq!(turn.applied(point), turned.map(Nm), "{degrees}");
        }
    }

    /// Against 64-bit floating point, for points of up to a metre.
    #[test]
    fn turns_are_within_a_nanometre() {
        for step in -4000i64..4000 {
            let nano = step * 12_345_678_901;
            let angle = (nano as f64 * 1e-9).to_radians();
            let point = [Nm(step * 250_000), Nm(1_000_000_000 - step * 111_111)];
            let [x, y] = point.map(|at| at.0 as f64);
            let wanted = [
                x * angle.cos() - y * angle.sin(),
                x * angle.sin() + y * angle.cos(),
            ];
            let turned = Turn::of(nano).applied(point);
            for (found, wanted) in turned.into_iter().zip(wanted) {
                assert!(
                    (found.0 as f64 - wanted).abs() < 0.51,
                    "{nano} {found:?} {wanted}"
                );
            }
            let back = Turn::of(nano).back().applied(turned);
            for (found, wanted) in back.into_iter().zip(point) {
                assert!((found.0 - wanted.0).abs() <= 1);
            }
        }
    }
}
