//! Sines, roots, logarithms and similar functions in integers: shifts, sums and 64-bit products,
//! without floating point and without wide division.
//!
//! Fixed-point numbers here are `value * 2^62` ("Q62"). Angles are in degrees, as in programs. A
//! whole number of quarter turns is subtracted exactly, in decimals, before anything is rounded.

use super::value::{Value, power};
use crate::values::circle::of_radians;
use crate::values::wide::root;
use core::cmp::Ordering;

/// 1 in Q62.
const ONE: i64 = 1 << 62;

/// atan(2^-k) for k from 1 on, Q62. Beyond k = 31 an angle equals its tangent to 2^-93.
const ARCTANGENTS: [i64; 31] = [
    2138197195906305897,
    1129764675555192497,
    573486189672913778,
    287855953345232185,
    144068303048368715,
    72051730834756822,
    36028064038054493,
    18014306884351854,
    9007187801521084,
    4503598195715550,
    2251799634728303,
    1125899884473003,
    562949950625109,
    281474976361131,
    140737488311637,
    70368744172203,
    35184372088149,
    17592186044331,
    8796093022197,
    4398046511103,
    2199023255552,
    1099511627776,
    549755813888,
    274877906944,
    137438953472,
    68719476736,
    34359738368,
    17179869184,
    8589934592,
    4294967296,
    2147483648,
];

/// ln(1 + 2^-k) for k from 1 on, Q62.
const LOGARITHMS: [i64; 31] = [
    1869877770022570995,
    1029067995697975510,
    543178378744478074,
    279581720803300556,
    141909228037287941,
    71500440275001118,
    35888788270063140,
    17979305495762817,
    8998414598213862,
    4501402034722952,
    2251250236762820,
    1125762490254678,
    562915596478891,
    281466387125573,
    140735340915370,
    70368207312213,
    35184237871787,
    17592152490069,
    8796084633611,
    4398044413953,
    2199022731264,
    1099511496704,
    549755781120,
    274877898752,
    137438951424,
    68719476224,
    34359738240,
    17179869152,
    8589934584,
    4294967294,
    2147483648,
];

/// ln 2, Q62.
const LN_2: i64 = 3196577161300663915;

/// pi / 180 = mantissa * 2^exponent.
const DEGREE: Float = Float {
    mantissa: 10302605451487463598,
    exponent: -69,
};

/// 180 / pi, Q57.
const RADIAN: i64 = 8257192040480628450;

/// A positive number `mantissa * 2^exponent` with the top bit of the mantissa set, or zero.
/// Products have a relative error below 2^-62.
#[derive(Copy, Clone, Debug)]
struct Float {
    mantissa: u64,
    exponent: i16,
}

/// 10^-n, for n in 0..=18; the last bit is rounded down.
const INVERSE_POWERS: [Float; 19] = {
    let mut inverses = [Float {
        mantissa: 1 << 63,
        exponent: -63,
    }; 19];
    let (mut n, mut ten) = (1, 10u128);
    while n < inverses.len() {
        let quotient = (1u128 << 127) / ten;
        let shift = 64 - quotient.leading_zeros();
        inverses[n] = Float {
            mantissa: (quotient >> shift) as u64,
            exponent: shift as i16 - 127,
        };
        ten *= 10;
        n += 1;
    }
    inverses
};

impl Float {
    const ZERO: Float = Float {
        mantissa: 0,
        exponent: 0,
    };

    /// The magnitude of a value.
    fn of(value: Value) -> Float {
        let inverse = INVERSE_POWERS.get(usize::from(value.places())).copied();
        Float::normal(u128::from(value.digits().unsigned_abs()), 0)
            .times(inverse.unwrap_or(Float::ZERO))
    }

    /// `value * 2^exponent`, rounded down to 64 bits. Exponents here stay within a few hundred.
    fn normal(value: u128, exponent: i16) -> Float {
        if value == 0 {
            return Float::ZERO;
        }
        let shift = value.leading_zeros();
        Float {
            mantissa: (value.wrapping_shl(shift) >> 64) as u64,
            exponent: exponent.wrapping_add(64).wrapping_sub(shift as i16),
        }
    }

    fn times(self, other: Float) -> Float {
        let product = u128::from(self.mantissa).wrapping_mul(u128::from(other.mantissa));
        Float::normal(product, self.exponent.wrapping_add(other.exponent))
    }

    /// `value * 2^bits`, rounded to the nearest integer. The caller guarantees that it is below
    /// 2^126.
    fn fixed(self, bits: i16) -> u128 {
        let shift = self.exponent.wrapping_add(bits);
        let wide = u128::from(self.mantissa);
        match u32::try_from(shift) {
            Ok(left) => wide.wrapping_shl(left.min(63)),
            Err(_) if shift < -64 => 0,
            Err(_) => {
                let right = u32::from(shift.unsigned_abs());
                let half = 1u128.wrapping_shl(right.wrapping_sub(1));
                wide.wrapping_add(half).wrapping_shr(right)
            }
        }
    }

    /// The number as a value with at most `places` places and as many digits as fit; `None` when it
    /// is too large.
    fn value(self, negative: bool, places: u8) -> Option<Value> {
        if self.exponent >= 0 {
            return (self.mantissa == 0).then_some(Value::ZERO.marked_rounded());
        }
        let mut places = places;
        loop {
            let scaled = u128::from(self.mantissa).wrapping_mul(u128::from(power(places)));
            let right = u32::from(self.exponent.unsigned_abs());
            // scaled < 2^124; a shift by more than 127 gives zero.
            let digits = match right {
                128.. => 0,
                _ => scaled.wrapping_shr(right),
            };
            let half = match right {
                1..=128 => scaled.wrapping_shr(right.wrapping_sub(1)) & 1,
                _ => 0,
            };
            if let Ok(digits) = i64::try_from(digits.wrapping_add(half)) {
                let digits = if negative {
                    digits.wrapping_neg()
                } else {
                    digits
                };
                return Some(Value::new(digits, places)?.marked_rounded());
            }
            places = places.checked_sub(1)?;
        }
    }
}

/// A Q62 number as a value of this many places, in 128 bits for those beyond 2.
fn value_of(fixed: i128, places: u8) -> Option<Value> {
    // Magnitudes are below 2^68 with up to 15 places: below 2^118.
    let scaled = fixed.unsigned_abs().wrapping_mul(u128::from(power(places)));
    let digits = scaled.wrapping_add(1 << 61) >> 62;
    Some(Value::fitted(digits, places, fixed < 0, true)?.limited(places))
}

/// Sine and cosine of an angle in degrees, Q62, within 2^-59, and whether both are exact (at
/// quarter turns).
fn sine_and_cosine(angle: Value) -> Option<(i64, i64, bool)> {
    let quarter = Value::from(90);
    let turn = angle.modulo(Value::from(360))?;
    // Rounded angles within 10^-9 of a quarter turn belong to the next quarter, with a slightly
    // negative rest.
    let quarters = [90, 180, 270].into_iter().fold(0i32, |quarters, quarter| {
        let is_passed = turn.compare(Value::from(quarter)) != Ordering::Less;
        quarters.wrapping_add(i32::from(is_passed))
    });
    // From 0 up to 90, exact when the angle is; rounding may give a whole turn, which counts as
    // none.
    let rest = turn.plus(Value::from(quarters.wrapping_mul(90)).negated())?;
    let folded = match rest.compare(Value::from(45)) {
        Ordering::Greater => quarter.plus(rest.negated())?,
        _ => rest,
    };
    // At most pi / 4 plus about 10^-9.
    let radians = Float::of(folded).times(DEGREE).fixed(62) as i64;
    let radians = if folded.is_negative() {
        radians.wrapping_neg()
    } else {
        radians
    };
    let (sine, cosine) = of_radians(radians);
    let (sine, cosine) = match rest.compare(Value::from(45)) {
        Ordering::Greater => (cosine, sine),
        _ => (sine, cosine),
    };
    let (sine, cosine) = match quarters {
        0 => (sine, cosine),
        1 => (cosine, sine.wrapping_neg()),
        2 => (sine.wrapping_neg(), cosine.wrapping_neg()),
        _ => (cosine.wrapping_neg(), sine),
    };
    Some((sine, cosine, rest.is_zero() && angle.is_exact()))
}

/// A Q62 number of magnitude up to 1 with 15 places.
fn unit_value(fixed: i64, exact: bool) -> Option<Value> {
    let value = value_of(i128::from(fixed), 15)?;
    if exact {
        Some(value.rounded_half())
    } else {
        Some(value)
    }
}

/// SIN of degrees: within 10^-15; exact at quarter turns.
pub(super) fn sine(angle: Value) -> Option<Value> {
    let (sine, _, exact) = sine_and_cosine(angle)?;
    unit_value(sine, exact)
}

/// COS of degrees: within 10^-15; exact at quarter turns.
pub(super) fn cosine(angle: Value) -> Option<Value> {
    let (_, cosine, exact) = sine_and_cosine(angle)?;
    unit_value(cosine, exact)
}

/// TAN of degrees: within 10^-15 and (1 + tan^2) 10^-17; `None` where it is infinite.
pub(super) fn tangent(angle: Value) -> Option<Value> {
    let (sine, cosine, exact) = sine_and_cosine(angle)?;
    if cosine == 0 {
        return None;
    }
    if exact {
        return Some(Value::ZERO);
    }
    let quotient = Value::new(sine, 0)?.divided_by(Value::new(cosine, 0)?)?;
    Some(quotient.marked_rounded().limited(15))
}

/// The angle of a point in the plane, with magnitudes `x` and `y`, in radians from 0 to pi/2, Q62,
/// within 2^-56.
fn angle(y: Float, x: Float) -> i64 {
    let size = |side: Float| (side.mantissa != 0, side.exponent, side.mantissa);
    let is_steep = size(y) > size(x);
    let (short, long) = if is_steep { (x, y) } else { (y, x) };
    if long.mantissa == 0 {
        return 0;
    }
    // The long side has its top bit at 2^60; it grows by less than 1.2.
    let bits = (-3i16).wrapping_sub(long.exponent);
    let (mut y, mut x) = (short.fixed(bits) as i64, long.fixed(bits) as i64);
    let mut angle = 0i64;
    for (k, step) in (1u32..).zip(ARCTANGENTS) {
        let (down, across) = (x.wrapping_shr(k), y.wrapping_shr(k));
        if y >= down {
            y = y.wrapping_sub(down);
            x = x.wrapping_add(across);
            angle = angle.wrapping_add(step);
        }
    }
    // y < x / 2^31, so y * 2^31 fits, and the rest of the angle is y / x.
    let tail = (y.unsigned_abs() << 31)
        .checked_div(x.unsigned_abs() >> 31)
        .unwrap_or(0);
    angle = angle.wrapping_add(tail as i64);
    // pi / 2 < 2 in Q62
    if is_steep {
        QUARTER.wrapping_sub(angle)
    } else {
        angle
    }
}

/// pi / 2, Q62.
const QUARTER: i64 = 7244019458077122842;

/// Converts radians in the first quadrant to degrees of 14 places, mirrored into the quadrant of
/// the signs.
fn degrees(radians: i64, left: bool, below: bool) -> Option<Value> {
    // 2^63 * 2^63 >> 57 is below 2^69.
    let degrees = i128::from(radians).wrapping_mul(i128::from(RADIAN)) >> 57;
    let half_turn = 180i128 << 62;
    let degrees = if left {
        half_turn.wrapping_sub(degrees)
    } else {
        degrees
    };
    value_of(
        if below {
            degrees.wrapping_neg()
        } else {
            degrees
        },
        14,
    )
}

/// ATAN[y]/[x]: degrees from -180 to 180, within 10^-14; exact on the axes. `None` at the origin.
pub(super) fn arc_tangent(y: Value, x: Value) -> Option<Value> {
    let exact = y.is_exact() && x.is_exact();
    let on_axis = match (y.is_zero(), x.is_zero()) {
        (true, true) => return None,
        (true, false) => Some(if x.is_negative() { 180 } else { 0 }),
        (false, true) => Some(if y.is_negative() { -90 } else { 90 }),
        _ => None,
    };
    if let Some(angle) = on_axis.filter(|_| exact) {
        return Some(Value::from(angle));
    }
    degrees(
        angle(Float::of(y), Float::of(x)),
        x.is_negative(),
        y.is_negative(),
    )
}

/// The root of `1 - v^2`; `None` for a magnitude above 1. A rounded value up to 10^-9 above 1
/// counts as 1.
fn leg(value: Value) -> Option<Float> {
    let unit = power(value.places());
    let digits = value.digits().unsigned_abs();
    if digits > unit {
        let is_one = value.magnitude().compare(Value::ONE) == Ordering::Equal;
        return is_one.then_some(Float::ZERO);
    }
    // unit <= 10^18 < 2^60: sum below 2^61, product below 2^121.
    let square =
        u128::from(unit.wrapping_sub(digits)).wrapping_mul(u128::from(unit.wrapping_add(digits)));
    if square == 0 {
        return Some(Float::ZERO);
    }
    // Room for a root of 62 bits; the square is below 2^122.
    let shift = square.leading_zeros().saturating_sub(4) & !1;
    let scaled = root(square.wrapping_shl(shift));
    let half = (shift >> 1) as i16;
    let inverse = INVERSE_POWERS.get(usize::from(value.places())).copied();
    Some(
        Float::normal(u128::from(scaled), half.wrapping_neg())
            .times(inverse.unwrap_or(Float::ZERO)),
    )
}

/// ASIN: degrees from -90 to 90, within 10^-14.
pub(super) fn arc_sine(value: Value) -> Option<Value> {
    degrees(
        angle(Float::of(value), leg(value)?),
        false,
        value.is_negative(),
    )
}

/// ACOS: degrees from 0 to 180, within 10^-14.
pub(super) fn arc_cosine(value: Value) -> Option<Value> {
    degrees(
        angle(leg(value)?, Float::of(value)),
        value.is_negative(),
        false,
    )
}

/// SQRT: the nearest number of up to 18 places and 18 digits; exact where there is an exact one.
/// `None` below zero.
pub(super) fn square_root(value: Value) -> Option<Value> {
    if value.is_negative() {
        return None;
    }
    let digits = u128::from(value.digits().unsigned_abs());
    let mut places = Value::MAX_PLACES;
    loop {
        // digits / 10^p = digits * 10^(2k - p) / 10^2k; 2k - p <= 36, in two factors.
        let shift = places.wrapping_mul(2).checked_sub(value.places())?;
        let (low, high) = (shift.min(18), shift.saturating_sub(18));
        let scaled = digits
            .checked_mul(u128::from(power(low)))
            .and_then(|scaled| scaled.checked_mul(u128::from(power(high))))
            .filter(|&scaled| scaled >> 124 == 0);
        if let Some(scaled) = scaled {
            let floor = root(scaled);
            let rest = scaled.wrapping_sub(u128::from(floor).wrapping_mul(u128::from(floor)));
            // Above one half where the rest exceeds the root; floor < 2^62.
            let nearest = u128::from(floor).wrapping_add(u128::from(rest > u128::from(floor)));
            let result = Value::fitted(nearest, places, false, !value.is_exact() || rest != 0)?;
            return Some(if rest == 0 { result.stripped() } else { result });
        }
        places = places.checked_sub(1)?;
    }
}

/// The natural logarithm of a positive number, Q62, within 2^-56. The number is multiplied by
/// factors 1 + 2^-k up to the next power of two.
fn logarithm_of(number: Float) -> i128 {
    let (mut y, mut sum) = (number.mantissa >> 1, 0i64);
    let top = 1u64 << 63;
    for (k, step) in (1u32..).zip(LOGARITHMS) {
        // y <= 2^63, so the sum is below 2^64.
        let next = y.wrapping_add(y.wrapping_shr(k));
        if next <= top {
            y = next;
            sum = sum.wrapping_add(step);
        }
    }
    // The remaining factor to 2 is below 1 + 2^-31.
    let tail = top.wrapping_sub(y) >> 1;
    let powers = i128::from(number.exponent).wrapping_add(64);
    powers
        .wrapping_mul(i128::from(LN_2))
        .wrapping_sub(i128::from(sum))
        .wrapping_sub(i128::from(tail))
}

/// LN: within 10^-15. `None` for zero and below.
pub(super) fn logarithm(value: Value) -> Option<Value> {
    if value.is_zero() || value.is_negative() {
        return None;
    }
    if value.is_exact() && value.compare(Value::ONE) == Ordering::Equal {
        return Some(Value::ZERO);
    }
    value_of(logarithm_of(Float::of(value)), 15)
}

/// e to a power given in Q62; `None` when it is too large.
fn exponential_of(power: i128) -> Option<Value> {
    // Above 44 the result exceeds 2^63 (63 ln 2); below -44 it has no digit within 15 places.
    if power >= 44 << 62 {
        return None;
    }
    if power <= -(44 << 62) {
        return Some(Value::ZERO.marked_rounded());
    }
    // Off by at most one, which the loops below correct: 64 ln 2 > 44.
    let estimate = ((power >> 40) as i64).checked_div(LN_2 >> 40).unwrap_or(0);
    let mut halvings = estimate;
    let mut rest = power.wrapping_sub(i128::from(halvings).wrapping_mul(i128::from(LN_2)));
    while rest < 0 {
        rest = rest.wrapping_add(i128::from(LN_2));
        halvings = halvings.wrapping_sub(1);
    }
    while rest >= i128::from(LN_2) {
        rest = rest.wrapping_sub(i128::from(LN_2));
        halvings = halvings.wrapping_add(1);
    }
    let (mut rest, mut y) = (rest as i64, ONE.unsigned_abs());
    for (k, step) in (1u32..).zip(LOGARITHMS) {
        if rest >= step {
            rest = rest.wrapping_sub(step);
            y = y.wrapping_add(y.wrapping_shr(k)); // stays below 2
        }
    }
    // rest < 2^-31, so its square is below the last bit.
    let tail = (u128::from(y).wrapping_mul(u128::from(rest.unsigned_abs())) >> 62) as u64;
    let exponent = (halvings as i16).wrapping_sub(62);
    Float::normal(u128::from(y.wrapping_add(tail)), exponent).value(false, 15)
}

/// EXP: within 10^-15 or 10^-16 of itself. `None` when it is too large.
pub(super) fn exponential(value: Value) -> Option<Value> {
    if value.is_zero() && value.is_exact() {
        return Some(Value::ONE);
    }
    exponential_of(signed_fixed(Float::of(value), value.is_negative())?)
}

/// The number in Q62 if its magnitude is below 64; otherwise 63 with its sign.
fn signed_fixed(number: Float, negative: bool) -> Option<i128> {
    let fixed = match number.exponent.wrapping_add(64) {
        7.. if number.mantissa != 0 => 63 << 62,
        _ => i128::try_from(number.fixed(62)).ok()?,
    };
    Some(if negative {
        fixed.wrapping_neg()
    } else {
        fixed
    })
}

/// A positive number to a power that is not whole: within 10^-15, or (1 + |ln|) 10^-16 of the
/// result. `None` when it is too large.
pub(super) fn general_power(base: Value, exponent: Value) -> Option<Value> {
    let logarithm = logarithm_of(Float::of(base));
    let factor = Float::normal(logarithm.unsigned_abs(), -62).times(Float::of(exponent));
    exponential_of(signed_fixed(
        factor,
        (logarithm < 0) != exponent.is_negative(),
    )?)
}

#[cfg(test)]
mod tests {
    extern crate std;

    use super::*;
    use std::borrow::ToOwned;
    use std::string::ToString;

    const HALF: u64 = 1 << 63;

    fn float(mantissa: u64, exponent: i16) -> Float {
        Float { mantissa, exponent }
    }

    fn value(digits: i64, places: u8) -> Value {
        Value::new(digits, places).expect("a value")
    }

    /// The nearest integer, for arbitrarily small numbers: 1.5 units down to 1.5 * 2^-140.
    #[test]
    fn small_numbers_become_the_nearest_unit() {
        for (shift, expected) in [(0, 2), (1, 1), (2, 0), (3, 0), (65, 0), (66, 0), (127, 0)] {
            assert_eq!(float(3 << 62, -125 - shift).fixed(62), expected, "{shift}");
        }
        assert_eq!(float(3 << 62, -125 - 140).fixed(62), 0);
        assert_eq!(float(HALF, -126).fixed(62), 1);
        assert_eq!(float(HALF - 1, -126).fixed(62), 0);
    }

    #[test]
    fn numbers_become_values() {
        let shown = |value: Option<Value>| value.map(|value| (value.to_string(), value.is_exact()));
        let some = |text: &str| Some((text.to_owned(), false));
        assert_eq!(shown(Float::ZERO.value(false, 15)), some("0"));
        assert_eq!(shown(float(HALF, 0).value(false, 15)), None);
        assert_eq!(shown(float(3 << 62, -63).value(false, 0)), some("2"));
        assert_eq!(shown(float(5 << 61, -63).value(true, 0)), some("-1"));
        for exponent in [-128, -129, -200, -256] {
            let least = float(HALF, exponent).value(false, 15);
            assert_eq!(shown(least), some("0.000000000000000"), "{exponent}");
        }
    }

    /// A root is exact where its square is, and rounded down below the half.
    #[test]
    fn roots_are_the_nearest() {
        let root = |value| square_root(value).map(|root| (root.to_string(), root.is_exact()));
        let some = |text: &str, is_exact| Some((text.to_owned(), is_exact));
        assert_eq!(root(value(2, 0)), some("1.414213562373095049", false));
        assert_eq!(root(value(4, 0)), some("2", true));
        assert_eq!(root(value(4, 0).marked_rounded()), some("2", false));
        // f * (f + 1): the root is just below f + 1/2.
        assert_eq!(
            root(value(65_669_145_682_477_392, 18)),
            some("0.256259918212890624", false)
        );
    }

    /// A rounded zero is zero, and its power is one; only exact arguments give exact results.
    #[test]
    fn rounded_arguments() {
        let zero = Value::ZERO.marked_rounded();
        let shown = |value: Option<Value>| value.map(|value| value.to_string());
        assert_eq!(
            shown(exponential(zero)).as_deref(),
            Some("1.000000000000000")
        );
        let one = Value::ONE.marked_rounded();
        for (y, x, expected) in [
            (Value::ZERO, one, "0.00000000000000"),
            (zero, Value::ONE, "0.00000000000000"),
            (Value::ONE, zero, "90.00000000000000"),
            (Value::ONE, Value::ZERO, "90"),
        ] {
            assert_eq!(shown(arc_tangent(y, x)).as_deref(), Some(expected));
        }
    }
}
