//! Steps in millimetres, degrees or any other unit.

use core::fmt;

use fixed::{traits::FixedSigned, types::I32F32};

/// How many steps make how many units: the fixed-point positions and rates of an axis.
///
/// The ratio is exact, so a position converted to steps and back is the nearest step.
///
/// # Examples
/// ```
/// use husillo_machine::StepUnits;
/// use husillo_machine::fixed::types::{I16F16, I32F32};
///
/// // 200 full steps of 16 microsteps, on a screw of 8 mm.
/// let millimetres = StepUnits::new(3200, 8).unwrap();
/// assert_eq!(millimetres.steps(I16F16::lit("12.5"))?, 5000);
/// assert_eq!(millimetres.position::<I32F32>(-5001)?, I32F32::lit("-12.5025"));
/// # Ok::<(), husillo_machine::UnitsError>(())
/// ```
#[derive(Copy, Clone, PartialEq, Eq, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct StepUnits {
    /// At least 1.
    steps: u32,
    /// At least 1.
    units: u32,
}

/// The result has no place in its type.
#[derive(Copy, Clone, PartialEq, Eq, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct UnitsError;

impl fmt::Display for UnitsError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("the position or rate is out of range")
    }
}

impl core::error::Error for UnitsError {}

impl StepUnits {
    /// `steps` steps are `units` units. `None` if one of them is 0.
    #[must_use]
    pub const fn new(steps: u32, units: u32) -> Option<StepUnits> {
        if steps == 0 || units == 0 {
            None
        } else {
            Some(StepUnits { steps, units })
        }
    }

    /// The step nearest to a position in units; halves round away from 0. Rates convert in the same
    /// way, from units per second to steps per second.
    ///
    /// # Errors
    /// [`UnitsError`]: it does not fit in 32 bits.
    ///
    /// # Cost
    /// Two divisions of 64 bits.
    pub fn steps<F: FixedSigned>(&self, position: F) -> Result<i32, UnitsError> {
        let position = position.checked_to_num::<I32F32>().ok_or(UnitsError)?;
        let bits = position.to_bits().unsigned_abs();
        let steps = u64::from(self.steps);
        // Below 2^63, and below 2^64: the product of 95 bits in digits of 32.
        let high = (bits >> 32).wrapping_mul(steps);
        let low = (bits & 0xffff_ffff).wrapping_mul(steps);
        let (whole, rest) = divide(high.wrapping_add(low >> 32), self.units)?;
        let (fraction, _) = divide(rest << 32 | low & 0xffff_ffff, self.units)?;
        let nearest = whole.wrapping_add(fraction >> 31);
        let nearest = i64::try_from(nearest).map_err(|_| UnitsError)?;
        let signed = if position.is_negative() {
            nearest.wrapping_neg()
        } else {
            nearest
        };
        i32::try_from(signed).map_err(|_| UnitsError)
    }

    /// The position of a step in units, rounded to the nearest 2^-32, then down to the last digit
    /// of its type. Rates convert in the same way.
    ///
    /// # Errors
    /// [`UnitsError`]: it does not fit in the type, or in `I32F32`.
    ///
    /// # Cost
    /// Two divisions of 64 bits.
    pub fn position<F: FixedSigned>(&self, steps: i32) -> Result<F, UnitsError> {
        // Below 2^63.
        let product = u64::from(steps.unsigned_abs()).wrapping_mul(self.units.into());
        let (whole, rest) = divide(product, self.steps)?;
        // rest < 2^32.
        let (fraction, left) = divide(rest << 32, self.steps)?;
        let up = u64::from(left >= u64::from(self.steps).wrapping_sub(left));
        if whole >> 31 != 0 {
            return Err(UnitsError);
        }
        // Below 2^63 + 1.
        let bits = (whole << 32).wrapping_add(fraction).wrapping_add(up);
        let bits = i64::try_from(bits).map_err(|_| UnitsError)?;
        let bits = if steps < 0 { bits.wrapping_neg() } else { bits };
        F::checked_from_num(I32F32::from_bits(bits)).ok_or(UnitsError)
    }
}

fn divide(numerator: u64, denominator: u32) -> Result<(u64, u64), UnitsError> {
    let denominator = u64::from(denominator);
    let quotient = numerator.checked_div(denominator).ok_or(UnitsError)?;
    let rest = numerator.checked_rem(denominator).ok_or(UnitsError)?;
    Ok((quotient, rest))
}

#[cfg(test)]
mod tests {
    use super::*;
    use fixed::types::{I16F16, I48F16};
    use proptest::prelude::*;

    proptest! {
        /// The nearest step, and back, against 128 bits.
        #[test]
        fn conversions_are_nearest(steps in 1_u32.., units in 1_u32.., bits: i64, at: i32) {
            let scale = StepUnits::new(steps, units).unwrap();
            let exact = i128::from(bits) * i128::from(steps);
            let divisor = i128::from(units) << 32;
            match scale.steps(I32F32::from_bits(bits)) {
                Ok(nearest) => {
                    prop_assert!((i128::from(nearest) * divisor - exact).abs() * 2 <= divisor);
                }
                Err(UnitsError) => prop_assert!(exact.abs() / divisor >= i128::from(i32::MAX)),
            }
            let exact = (i128::from(at) * i128::from(units)) << 32;
            match scale.position::<I32F32>(at) {
                Ok(position) => {
                    let given = i128::from(position.to_bits()) * i128::from(steps);
                    prop_assert!((given - exact).abs() * 2 <= i128::from(steps));
                }
                Err(UnitsError) => {
                    prop_assert!(exact.abs() / i128::from(steps) >= i128::from(i64::MAX));
                }
            }
        }

        /// Where a unit has fewer steps than the type has digits, every step comes back.
        #[test]
        fn steps_come_back(
            steps in 1_u32..100_000,
            units in 1_u32..100,
            at in -200_000_i32..200_000,
        ) {
            let scale = StepUnits::new(steps, units).unwrap();
            let position = scale.position::<I32F32>(at).unwrap();
            prop_assert_eq!(scale.steps(position), Ok(at));
        }
    }

    #[test]
    fn what_has_no_place_is_an_error() {
        let scale = StepUnits::new(1, 100_000).unwrap();
        assert_eq!(scale.position::<I16F16>(1), Err(UnitsError));
        assert_eq!(scale.position::<I48F16>(i32::MAX), Err(UnitsError));
        let scale = StepUnits::new(100_000, 1).unwrap();
        assert_eq!(scale.steps(I16F16::MAX), Err(UnitsError));
        assert_eq!(StepUnits::new(0, 1), None);
        assert_eq!(StepUnits::new(1, 0), None);
    }
}
