//! Positions in millimetres of a `fixed` type, for the ends of moves.

use fixed::traits::Fixed;
use fixed::types::I32F32;

use crate::Scale;

/// Nanometres of a millimetre.
const MILLIMETRE: i64 = 1_000_000;

impl Scale {
    /// The step nearest to a position in millimetres. The position is rounded to the nearest
    /// nanometre first, as in [`Scale::nearest`]. `None` outside the range of `i32`, and beyond
    /// 2^31 mm.
    ///
    /// # Cost
    /// That of [`Scale::nearest`], and two products of 64 bits.
    ///
    /// # Examples
    /// ```
    /// use husillo_interp::{Line, Scale, fixed::types::I16F16};
    ///
    /// // 400 steps per millimetre on X and Y.
    /// let scale = Scale::new(2_500, 1).unwrap();
    /// let end = ["1.25", "-0.5"].map(|mm| I16F16::from_str(mm).unwrap());
    /// let [x, y] = end.map(|mm| scale.nearest_millimetres(mm).unwrap());
    /// assert_eq!((x, y), (500, -200));
    /// assert_eq!(Line::new([x, y]).count(), 500);
    /// ```
    pub fn nearest_millimetres<F: Fixed>(self, millimetres: F) -> Option<i32> {
        let bits = millimetres.checked_to_num::<I32F32>()?.to_bits();
        // The whole part times 10^6 is below 2^51, the fraction below 2^52.
        let whole = (bits >> 32).wrapping_mul(MILLIMETRE);
        let fraction = (bits & 0xffff_ffff).wrapping_mul(MILLIMETRE);
        self.nearest(whole.wrapping_add(fraction.wrapping_add(1 << 31) >> 32))
    }

    /// The position of a step in millimetres: to the nearest nanometre and 2^-32 mm, then down to
    /// the last digit of the type. `None` when it does not fit, or beyond 2^31 mm.
    ///
    /// # Cost
    /// That of [`Scale::position`], and two divisions of 64 bits.
    ///
    /// # Examples
    /// ```
    /// use husillo_interp::{Scale, fixed::types::I16F16};
    ///
    /// let scale = Scale::new(2_500, 1).unwrap();
    /// assert_eq!(scale.millimetres(-500), Some(I16F16::lit("-1.25")));
    /// ```
    pub fn millimetres<F: Fixed>(self, step: i32) -> Option<F> {
        let nm = self.position(step);
        let (whole, rest) = (nm.div_euclid(MILLIMETRE), nm.rem_euclid(MILLIMETRE));
        let whole = i64::from(i32::try_from(whole).ok()?);
        // rest < 10^6 < 2^20.
        let fraction = ((rest << 32) + MILLIMETRE / 2) / MILLIMETRE;
        F::checked_from_num(I32F32::from_bits((whole << 32).wrapping_add(fraction)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use fixed::types::{I8F8, I48F16};
    use proptest::prelude::*;

    proptest! {
        /// The nearest step, up to the half nanometre of the first rounding.
        #[test]
        fn positions_become_the_nearest_step(
            bits: i64,
            nm in 1_u32..10_000_000,
            steps in 1_u32..10_000,
        ) {
            let scale = Scale::new(nm, steps).unwrap();
            // In 2^-32 nm, times the steps of the scale.
            let exact = i128::from(bits) * 1_000_000 * i128::from(steps);
            let step = i128::from(nm) << 32;
            match scale.nearest_millimetres(I32F32::from_bits(bits)) {
                Some(nearest) => {
                    let error = (i128::from(nearest) * step - exact).abs();
                    prop_assert!(error * 2 <= step + (i128::from(steps) << 32));
                }
                None => prop_assert!(exact.abs() / step >= i128::from(i32::MAX) - 1),
            }
        }

        /// Where a step is at least a nanometre long, every step comes back.
        #[test]
        fn steps_come_back(step: i32, nm in 1_u32..10_000_000, steps in 1_u32..10_000) {
            prop_assume!(nm >= steps);
            let scale = Scale::new(nm, steps).unwrap();
            if let Some(millimetres) = scale.millimetres::<I32F32>(step) {
                prop_assert_eq!(scale.nearest_millimetres(millimetres), Some(step));
            }
        }
    }

    #[test]
    fn what_has_no_place_is_none() {
        let scale = Scale::new(2_500, 1).unwrap();
        assert_eq!(
            scale.nearest_millimetres(I48F16::from_num(1_i64 << 31)),
            None
        );
        assert_eq!(scale.nearest_millimetres(I48F16::from_num(6_000_000)), None);
        assert_eq!(scale.millimetres::<I8F8>(400 * 128), None);
        let long = Scale::new(u32::MAX, 1).unwrap();
        assert_eq!(long.millimetres::<I48F16>(i32::MAX), None);
    }
}
