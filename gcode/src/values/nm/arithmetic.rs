//! Sums of lengths, and lengths in millimetres of a `fixed` type.

use super::Nm;
use core::iter::Sum;
use core::ops::{Add, AddAssign, Div, Mul, Neg, Rem, Sub, SubAssign};
use fixed::traits::Fixed;
use fixed::types::I32F32;

/// Nanometres of a millimetre.
const MILLIMETRE: i64 = 1_000_000;

/// Saturates. Coordinates are within [`Nm::LIMIT`], so 8191 of them have room.
impl Add for Nm {
    type Output = Nm;

    fn add(self, other: Nm) -> Nm {
        Nm(self.0.saturating_add(other.0))
    }
}

/// Saturates.
impl Sub for Nm {
    type Output = Nm;

    fn sub(self, other: Nm) -> Nm {
        Nm(self.0.saturating_sub(other.0))
    }
}

/// Saturates.
impl Neg for Nm {
    type Output = Nm;

    fn neg(self) -> Nm {
        Nm(self.0.saturating_neg())
    }
}

/// Saturates.
impl Mul<i64> for Nm {
    type Output = Nm;

    fn mul(self, factor: i64) -> Nm {
        Nm(self.0.saturating_mul(factor))
    }
}

/// How many times a length contains the other one, rounded towards 0; `None` for a length of 0.
impl Div for Nm {
    type Output = Option<i64>;

    fn div(self, other: Nm) -> Option<i64> {
        self.0.checked_div(other.0)
    }
}

/// What is left of a length after the whole number of the other one in it; `None` for a length of
/// 0.
impl Rem for Nm {
    type Output = Option<Nm>;

    fn rem(self, other: Nm) -> Option<Nm> {
        self.0.checked_rem(other.0).map(Nm)
    }
}

impl AddAssign for Nm {
    fn add_assign(&mut self, other: Nm) {
        *self = *self + other;
    }
}

impl SubAssign for Nm {
    fn sub_assign(&mut self, other: Nm) {
        *self = *self - other;
    }
}

impl Sum for Nm {
    fn sum<I: Iterator<Item = Nm>>(lengths: I) -> Nm {
        lengths.fold(Nm(0), Nm::add)
    }
}

impl Nm {
    /// The length without its sign. Saturates.
    pub const fn abs(self) -> Nm {
        Nm(self.0.saturating_abs())
    }

    /// A length in millimetres of a `fixed` type, rounded to the nearest nanometre. `None` beyond
    /// 2^31 mm.
    ///
    /// # Examples
    /// ```
    /// use husillo_gcode::{Nm, fixed::types::{I16F16, I32F32}};
    ///
    /// assert_eq!(Nm::from_millimetres(I16F16::lit("-2.5")), Some(Nm(-2_500_000)));
    /// assert_eq!(Nm(1_250_000).millimetres::<I32F32>(), Some(I32F32::lit("1.25")));
    /// ```
    pub fn from_millimetres<F: Fixed>(length: F) -> Option<Nm> {
        let bits = length.checked_to_num::<I32F32>()?.to_bits();
        // The whole part times 10^6 is below 2^51, the fraction below 2^52.
        let whole = (bits >> 32).wrapping_mul(MILLIMETRE);
        let fraction = (bits & 0xffff_ffff).wrapping_mul(MILLIMETRE);
        Some(Nm(whole.wrapping_add(fraction.wrapping_add(1 << 31) >> 32)))
    }

    /// The length in millimetres of a `fixed` type: to the nearest 2^-32 mm, then down to the last
    /// digit of the type. `None` when it does not fit, or beyond 2^31 mm.
    pub fn millimetres<F: Fixed>(self) -> Option<F> {
        let (whole, rest) = (self.0.div_euclid(MILLIMETRE), self.0.rem_euclid(MILLIMETRE));
        let whole = i64::from(i32::try_from(whole).ok()?);
        // rest < 10^6 < 2^20.
        let fraction = ((rest << 32) + MILLIMETRE / 2) / MILLIMETRE;
        F::checked_from_num(I32F32::from_bits((whole << 32).wrapping_add(fraction)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use fixed::types::{I16F16, I48F16};
    use proptest::prelude::*;

    proptest! {
        /// Every length within the range comes back from its millimetres.
        #[test]
        fn lengths_come_back(nm in -(1_i64 << 50)..1 << 50) {
            let millimetres: I32F32 = Nm(nm).millimetres().unwrap();
            prop_assert_eq!(Nm::from_millimetres(millimetres), Some(Nm(nm)));
            let exact = i128::from(nm) << 32;
            let given = i128::from(millimetres.to_bits()) * 1_000_000;
            prop_assert!((given - exact).abs() <= 500_000);
        }

        /// Millimetres become the nearest nanometre.
        #[test]
        fn millimetres_are_rounded_to_nearest(bits: i64) {
            let Nm(nm) = Nm::from_millimetres(I32F32::from_bits(bits)).unwrap();
            let error = (i128::from(nm) << 32) - i128::from(bits) * 1_000_000;
            prop_assert!(error.abs() <= 1 << 31);
        }
    }

    #[test]
    fn sums_saturate() {
        let mut length = Nm(3) - Nm(5);
        length += Nm(10);
        length -= Nm(1);
        assert_eq!((length, -length, length * 3), (Nm(7), Nm(-7), Nm(21)));
        assert_eq!((length / Nm(2), length % Nm(2)), (Some(3), Some(Nm(1))));
        assert_eq!((length / Nm(0), length % Nm(0)), (None, None));
        assert_eq!(Nm(i64::MAX) + Nm(1), Nm(i64::MAX));
        assert_eq!(-Nm(i64::MIN), Nm(i64::MAX));
        assert_eq!(Nm(i64::MIN).abs(), Nm(i64::MAX));
        assert_eq!([Nm(1), Nm(2)].into_iter().sum::<Nm>(), Nm(3));
        assert_eq!(Nm(40_000_000_000).millimetres::<I16F16>(), None);
        assert_eq!(Nm::from_millimetres(I48F16::MAX), None);
    }
}
