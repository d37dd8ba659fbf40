//! Backlash, positions and corrections in units of a `fixed` type.

use fixed::traits::Fixed;
use fixed::types::I32F32;

use crate::{Backlash, Calibration, Flank, Knot};

/// Nanometres of a millimetre.
const MILLIMETRE: i64 = 1_000_000;

/// The motor steps of a length in units of the axis, rounded to nearest, halves away from 0: grid
/// positions of a [`BacklashMap`](crate::BacklashMap), load positions, backlash. `None` if they
/// have no place in 32 bits.
///
/// # Cost
/// A product of 64 bits.
///
/// # Examples
/// ```
/// use husillo_backlash::{fixed::types::I16F16, steps};
///
/// let per_millimetre = I16F16::lit("107"); // steps
/// assert_eq!(steps(I16F16::lit("-2.25"), per_millimetre), Some(-241)); // -240.75
/// ```
pub fn steps<L: Fixed, S: Fixed>(length: L, steps_per_unit: S) -> Option<i32> {
    let length = length.checked_to_num::<I32F32>()?;
    let scale = steps_per_unit.checked_to_num::<I32F32>()?;
    let [bits, scale_bits] = [length, scale].map(|value| value.to_bits().unsigned_abs());
    // At most 2^126; it has 64 binary digits after its point.
    let product = u128::from(bits).wrapping_mul(scale_bits.into());
    let magnitude = i64::try_from(product.wrapping_add(1 << 63) >> 64).ok()?;
    let is_negative = (length.to_bits() < 0) != (scale.to_bits() < 0);
    i32::try_from(if is_negative {
        magnitude.wrapping_neg()
    } else {
        magnitude
    })
    .ok()
}

/// Millimetres as nanometres, rounded to nearest.
fn nanometres<F: Fixed>(millimetres: F) -> Option<i64> {
    let bits = millimetres.checked_to_num::<I32F32>()?.to_bits();
    // The whole part times 10^6 is below 2^51, the fraction below 2^52.
    let whole = (bits >> 32).wrapping_mul(MILLIMETRE);
    let fraction = (bits & 0xffff_ffff).wrapping_mul(MILLIMETRE);
    Some(whole.wrapping_add(fraction.wrapping_add(1 << 31) >> 32))
}

/// Nanometres as millimetres, to the nearest 2^-32 mm, then down to the last digit of the type.
fn millimetres<F: Fixed>(nm: i64) -> Option<F> {
    let (whole, rest) = (nm.div_euclid(MILLIMETRE), nm.rem_euclid(MILLIMETRE));
    let whole = i64::from(i32::try_from(whole).ok()?);
    // rest < 10^6 < 2^20.
    let fraction = ((rest << 32) + MILLIMETRE / 2) / MILLIMETRE;
    F::checked_from_num(I32F32::from_bits((whole << 32).wrapping_add(fraction)))
}

/// Converts three coordinates, all or none.
fn each<A: Copy, B: Copy>(of: [A; 3], convert: impl Fn(A) -> Option<B>) -> Option<[B; 3]> {
    let [x, y, z] = of;
    Some([convert(x)?, convert(y)?, convert(z)?])
}

impl Backlash {
    /// Creates an axis from a backlash as it is measured, in the unit of the axis, rounded to the
    /// nearest step. `None` if it is negative, or has no place in 31 bits.
    ///
    /// # Examples
    /// ```
    /// use husillo_backlash::{Backlash, Flank, fixed::types::U16F16};
    ///
    /// // 0.204 mm on a screw of 7142.857 steps per millimetre.
    /// let [backlash, per_millimetre] = [U16F16::lit("0.204"), U16F16::lit("7142.857")];
    /// let x = Backlash::from_length(backlash, per_millimetre, Flank::Positive).unwrap();
    /// assert_eq!(x.backlash_steps(), 1457);
    /// ```
    pub fn from_length<L: Fixed, S: Fixed>(
        backlash: L,
        steps_per_unit: S,
        flank: Flank,
    ) -> Option<Backlash> {
        let steps = u32::try_from(steps(backlash, steps_per_unit)?).ok()?;
        Some(Backlash::new(steps, flank))
    }
}

impl Knot {
    /// A knot from millimetres, each value rounded to the nearest nanometre. `None` if a value has
    /// no place.
    ///
    /// Corrections are micrometres: a type with 16 binary digits after its point resolves 15 nm,
    /// one with 24 digits less than a nanometre.
    ///
    /// # Examples
    /// ```
    /// use husillo_backlash::{Knot, fixed::types::I32F32};
    ///
    /// let [reading, positive] = [I32F32::lit("100"), I32F32::lit("0.002")];
    /// let knot = Knot::from_millimetres(reading, positive, -positive).unwrap();
    /// assert_eq!((knot.reading_nm, knot.positive_nm), (100_000_000, 2_000));
    /// ```
    pub fn from_millimetres<F: Fixed>(reading: F, positive: F, negative: F) -> Option<Knot> {
        let correction = |length: F| i32::try_from(nanometres(length)?).ok();
        Some(Knot {
            reading_nm: nanometres(reading)?,
            positive_nm: correction(positive)?,
            negative_nm: correction(negative)?,
        })
    }
}

impl<T: AsRef<[Knot]>> Calibration<T> {
    /// The true position in millimetres at readings in millimetres:
    /// [`position_nm`](Calibration::position_nm). `None` if a coordinate has no place in the type.
    ///
    /// # Examples
    /// ```
    /// use husillo_backlash::{Calibration, ErrorTable, Flank, Knot, Squareness};
    /// use husillo_backlash::fixed::types::I32F32;
    ///
    /// // A scale that is 50 um/m too long, on X.
    /// let scale = |ppb| ErrorTable::new(ppb, [Knot::default(); 0]);
    /// let axes = [scale(50_000)?, scale(0)?, scale(0)?];
    /// let machine = Calibration { axes, squareness: Squareness::default() };
    /// let readings = [I32F32::lit("1000"), I32F32::ONE, I32F32::ZERO];
    /// let truth = machine.position_millimetres(readings, [Flank::Positive; 3]).unwrap();
    /// assert_eq!(truth[0], I32F32::lit("1000.05"));
    /// # Ok::<(), husillo_backlash::TableError>(())
    /// ```
    pub fn position_millimetres<F: Fixed>(
        &self,
        readings: [F; 3],
        flanks: [Flank; 3],
    ) -> Option<[F; 3]> {
        let position_nm = self.position_nm(each(readings, nanometres)?, flanks);
        each(position_nm, millimetres)
    }

    /// The readings in millimetres at a true position in millimetres:
    /// [`reading_nm`](Calibration::reading_nm). `None` if a coordinate has no place in the type.
    pub fn reading_millimetres<F: Fixed>(
        &self,
        position: [F; 3],
        flanks: [Flank; 3],
    ) -> Option<[F; 3]> {
        let reading_nm = self.reading_nm(each(position, nanometres)?, flanks);
        each(reading_nm, millimetres)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{ErrorTable, Squareness};
    use fixed::types::{I8F8, I16F16, I48F16};
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn steps_are_nearest(length: i64, scale: i64) {
            let [length, scale] = [length, scale].map(I32F32::from_bits);
            let exact = i128::from(length.to_bits()) * i128::from(scale.to_bits());
            match steps(length, scale) {
                Some(given) => {
                    let error = (i128::from(given) << 64) - exact;
                    prop_assert!(error.abs() <= 1 << 63);
                }
                None => prop_assert!(exact.unsigned_abs() >> 63 >= (1 << 32) - 1),
            }
        }

        /// Rates at which nothing overflows are common, and their signs as well.
        #[test]
        fn short_lengths_are_nearest(length: i32, scale: i32) {
            let [length, scale] = [length, scale].map(I16F16::from_bits);
            let exact = i128::from(length.to_bits()) * i128::from(scale.to_bits());
            let given = i128::from(steps(length, scale).unwrap());
            prop_assert!(((given << 32) - exact).abs() <= 1 << 31);
        }

        #[test]
        fn nanometres_come_back(nm in -(1_i64 << 50)..1 << 50) {
            let length: I32F32 = millimetres(nm).unwrap();
            prop_assert_eq!(nanometres(length), Some(nm));
        }

        /// In millimetres as in nanometres.
        #[test]
        fn calibrations_agree(x in -500_000_000_i64..500_000_000, ppb in -100_000..100_000) {
            let scale = |ppb| ErrorTable::new(ppb, [] as [Knot; 0]).unwrap();
            let squareness = Squareness { xy_ppb: ppb, ..Squareness::default() };
            let axes = [scale(ppb), scale(-ppb), scale(0)];
            let machine = Calibration { axes, squareness };
            let flanks = [Flank::Positive; 3];
            let readings = each([x, -x, 7], millimetres::<I32F32>).unwrap();
            let position = machine.position_millimetres(readings, flanks).unwrap();
            let position_nm = machine.position_nm([x, -x, 7], flanks);
            prop_assert_eq!(each(position, nanometres), Some(position_nm));
            let back = machine.reading_millimetres(position, flanks).unwrap();
            let reading_nm = machine.reading_nm(position_nm, flanks);
            prop_assert_eq!(each(back, nanometres), Some(reading_nm));
        }
    }

    #[test]
    fn what_has_no_place_is_none() {
        assert_eq!(
            steps(I16F16::from_num(30_000), I32F32::from_num(100_000)),
            None
        );
        assert_eq!(steps(I48F16::from_num(1_i64 << 40), I16F16::ONE), None);
        assert_eq!(steps(I32F32::MIN, I32F32::ONE), Some(i32::MIN));
        let backlash = |length| Backlash::from_length(length, I16F16::ONE, Flank::Positive);
        assert_eq!(backlash(I16F16::NEG_ONE), None);
        assert!(backlash(I16F16::ZERO).is_some());
        let long = I32F32::from_num(3_000);
        assert_eq!(
            Knot::from_millimetres(I32F32::ZERO, long, I32F32::ZERO),
            None
        );
        assert_eq!(millimetres::<I8F8>(128_000_000), None);
        assert_eq!(millimetres::<I48F16>(i64::MAX), None);
    }
}
