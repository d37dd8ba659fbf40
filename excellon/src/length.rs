//! Lengths in nanometres.

use crate::format::Units;

/// The largest magnitude of a coordinate in nanometres: 2^50, about 1126 km.
///
/// The difference of two coordinates is below 2^52, and the sum of two squares below 2^105.
pub const LIMIT_NM: i64 = 1 << 50;

/// Returns the length if its magnitude is at most [`LIMIT_NM`].
pub(crate) const fn within_limit(nm: i64) -> Option<i64> {
    if nm.unsigned_abs() <= LIMIT_NM.unsigned_abs() {
        Some(nm)
    } else {
        None
    }
}

/// Converts `digits / 10^places` of a unit to nanometres, rounded once, halves away from zero.
/// Returns `None` beyond [`LIMIT_NM`]. `places` is at most 21.
pub(crate) fn length_nm(digits: i64, places: u8, units: Units) -> Option<i64> {
    let (factor, exponent) = match units {
        Units::Millimetres => (1_u64, 6_u8),
        Units::Inches => (254, 5),
    };
    let magnitude = digits.unsigned_abs();
    let power = |exponent: u8| 10_u64.checked_pow(u32::from(exponent));
    let nm = match places.checked_sub(exponent) {
        None | Some(0) => {
            let scale = power(exponent.saturating_sub(places))?.checked_mul(factor)?;
            magnitude.checked_mul(scale)?
        }
        Some(dropped) => {
            // Converts the whole part separately: 254 times the remainder is below 254 * 10^16.
            let divisor = power(dropped)?;
            let whole = magnitude.checked_div(divisor)?.checked_mul(factor)?;
            let rest = magnitude.checked_rem(divisor)?.checked_mul(factor)?;
            let rounded = rest.checked_add(divisor >> 1)?.checked_div(divisor)?;
            whole.checked_add(rounded)?
        }
    };
    let nm = i64::try_from(nm).ok()?;
    within_limit(if digits < 0 { nm.wrapping_neg() } else { nm })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rounds_once_and_halves_away_from_zero() {
        use Units::{Inches, Millimetres};
        for (digits, places, units, nm) in [
            (12_345, 3, Millimetres, Some(12_345_000)),
            (1, 0, Inches, Some(25_400_000)),
            (1, 4, Inches, Some(2_540)),
            (5, 7, Millimetres, Some(1)),
            (-5, 7, Millimetres, Some(-1)),
            (49_999_999, 14, Millimetres, Some(0)),
            (50_000_000, 14, Millimetres, Some(1)),
            // 254 * 0.999999999999999999 inches: the product alone does not fit 64 bits.
            (999_999_999_999_999_999, 18, Inches, Some(25_400_000)),
            (999_999_999_999_999_999, 21, Inches, Some(25_400)),
            (999_999_999_999_999_999, 0, Inches, None),
            (LIMIT_NM, 6, Millimetres, Some(LIMIT_NM)),
            (-LIMIT_NM, 6, Millimetres, Some(-LIMIT_NM)),
            (LIMIT_NM + 1, 6, Millimetres, None),
        ] {
            assert_eq!(length_nm(digits, places, units), nm, "{digits} {places}");
        }
    }

    #[test]
    fn is_what_128_bits_give() {
        let powers = (0..=18).map(|exponent| 10_i64.pow(exponent));
        let digits = powers.flat_map(|power| {
            [
                power / 2 - 1,
                power / 2,
                power / 127,
                power - 1,
                power,
                -power,
                power / 3 * 2,
            ]
        });
        for digits in digits {
            for places in 0..=21 {
                for (units, nm_per_unit) in
                    [(Units::Millimetres, 1_000_000), (Units::Inches, 25_400_000)]
                {
                    let scale = 10_i128.pow(u32::from(places));
                    let product = i128::from(digits) * nm_per_unit;
                    let rounded = (2 * product.abs() + scale) / (2 * scale) * product.signum();
                    let nm = i64::try_from(rounded).ok();
                    let nm = nm.filter(|nm| (-LIMIT_NM..=LIMIT_NM).contains(nm));
                    assert_eq!(length_nm(digits, places, units), nm, "{digits} {places}");
                }
            }
        }
    }
}
