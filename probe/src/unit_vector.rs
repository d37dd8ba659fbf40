//! Directions.

use fixed::types::I2F30;

/// A vector of length 1: a direction of travel or a normal.
///
/// Each component of a vector made of integers below 2^31 in magnitude is within 0.63 x 2^-30
/// (5.9e-10) of the true one; of larger integers it is within 2 x 2^-30. Over a tip radius of 10 mm
/// that is less than 0.01 nm, over 1 m it is 0.6 nm.
#[derive(Copy, Clone, Eq, PartialEq, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct UnitVector(#[cfg_attr(feature = "defmt", defmt(Debug2Format))] [I2F30; 3]);

const ONE: I2F30 = I2F30::from_bits(1 << 30);
const ZERO: I2F30 = I2F30::from_bits(0);

impl UnitVector {
    /// Along +X.
    pub const X: UnitVector = UnitVector([ONE, ZERO, ZERO]);
    /// Along +Y.
    pub const Y: UnitVector = UnitVector([ZERO, ONE, ZERO]);
    /// Along +Z.
    pub const Z: UnitVector = UnitVector([ZERO, ZERO, ONE]);

    /// Returns the direction of `vector`, which has any length and unit. Returns `None` for the
    /// zero vector.
    ///
    /// # Cost
    /// One 64-bit root and four 64-bit divisions: for use once per touch, not in each tick.
    #[must_use]
    pub fn new(vector: [i64; 3]) -> Option<UnitVector> {
        let [x, y, z] = vector.map(i64::unsigned_abs);
        let bits = (x | y | z).checked_ilog2()?.wrapping_add(1);
        // Scales the largest magnitude m to 2^30 ..= 2^31.
        let scaled = [x, y, z].map(|component| match bits.checked_sub(31) {
            // Adds half of the last lost bit to round. The result is below 2^31, so + 1 fits.
            Some(over @ 1..) => {
                let half = component.wrapping_shr(over.wrapping_sub(1)) & 1;
                component.wrapping_shr(over).wrapping_add(half)
            }
            _ => component.wrapping_shl(31_u32.wrapping_sub(bits)),
        });
        // At most 3 x 2^62.
        let square = scaled
            .iter()
            .fold(0_u64, |sum, m| sum.wrapping_add(m.wrapping_mul(*m)));
        // The root is in 2^30 .. 2^31.8, so the divisor is not zero. The remainder is at most 2
        // roots.
        let root = square.isqrt();
        let rest = square.wrapping_sub(root.wrapping_mul(root));
        // Length with two more bits: root + remainder / 2 root, minus at most 1 / 2 root.
        let fraction = (rest.wrapping_shl(1))
            .wrapping_add(root >> 1)
            .checked_div(root)?;
        let length = (root << 2).wrapping_add(fraction);
        // m 2^32 / 4 length; m 2^32 <= 2^63 and length / 2 < 2^34.
        let component = |magnitude: u64| {
            (magnitude << 32)
                .wrapping_add(length >> 1)
                .checked_div(length)
                // At most 2^30.
                .map(|bits| (bits & 0x7fff_ffff) as u32)
        };
        let [sx, sy, sz] = vector.map(|component| component < 0);
        let [x, y, z] = scaled;
        let signed = |magnitude: u32, negative: bool| {
            let bits = magnitude.cast_signed();
            I2F30::from_bits(if negative { bits.wrapping_neg() } else { bits })
        };
        Some(UnitVector([
            signed(component(x)?, sx),
            signed(component(y)?, sy),
            signed(component(z)?, sz),
        ]))
    }

    /// Returns the components.
    #[must_use]
    pub const fn components(&self) -> [I2F30; 3] {
        self.0
    }

    /// Returns the opposite direction.
    #[must_use]
    pub fn reversed(&self) -> UnitVector {
        UnitVector(
            self.0
                .map(|component| I2F30::from_bits(component.to_bits().wrapping_neg())),
        )
    }

    /// Returns the cosine of the angle to `other`, within 3 x 2^-30 and never outside -1..=1.
    #[must_use]
    pub fn cosine(&self, other: &UnitVector) -> I2F30 {
        // The three products are below 2^60.
        let dot = self.0.iter().zip(&other.0).fold(0_i64, |sum, (a, b)| {
            sum.wrapping_add(i64::from(a.to_bits()).wrapping_mul(i64::from(b.to_bits())))
        });
        let one = i64::from(ONE.to_bits());
        I2F30::from_bits(round_30(dot).clamp(one.wrapping_neg(), one) as i32)
    }

    /// Returns the vector of `length` along this direction, each component rounded to the nearest,
    /// halves away from zero. Lengths beyond +-2^32 count as 2^32.
    #[must_use]
    pub fn scaled(&self, length: i64) -> [i64; 3] {
        let length = length.clamp(-(1 << 32), 1 << 32);
        // At most 2^62.
        self.0
            .map(|component| round_30(length.wrapping_mul(i64::from(component.to_bits()))))
    }

    /// Returns the length of the projection of `vector` on this direction, rounded to the nearest.
    /// Components beyond +-2^31 count as 2^31.
    #[must_use]
    pub fn length_along(&self, vector: [i64; 3]) -> i64 {
        // The three products are at most 2^61.
        round_30(self.0.iter().zip(vector).fold(0_i64, |sum, (a, b)| {
            let b = b.clamp(-(1 << 31), 1 << 31);
            sum.wrapping_add(i64::from(a.to_bits()).wrapping_mul(b))
        }))
    }

    /// Returns the components as floats, exactly.
    pub(crate) fn to_floats(self) -> [f64; 3] {
        self.0
            .map(|component| f64::from(component.to_bits()) * (1.0 / 1_073_741_824.0))
    }

    /// Returns the direction of a float vector of length about 1, to 2^-30 per component.
    pub(crate) fn from_floats(vector: [f64; 3]) -> Option<UnitVector> {
        // Casts saturate. `new` resolves no more than 2^31.
        UnitVector::new(vector.map(|component| libm::round(component * 2_147_483_648.0) as i64))
    }
}

/// Returns `value / 2^30` rounded to the nearest, halves away from zero. `|value|` is at most 2^63
/// - 2^29.
pub(crate) const fn round_30(value: i64) -> i64 {
    // The sum is below 2^63 + 2^29, so it does not wrap in u64. The quotient is below 2^34.
    let magnitude = value.unsigned_abs().wrapping_add(1 << 29) >> 30;
    let magnitude = magnitude.cast_signed();
    if value < 0 {
        magnitude.wrapping_neg()
    } else {
        magnitude
    }
}

/// Returns the sum of two vectors, saturating at the ends of `i64`.
pub(crate) fn plus(a: [i64; 3], b: [i64; 3]) -> [i64; 3] {
    let ([ax, ay, az], [bx, by, bz]) = (a, b);
    [
        ax.saturating_add(bx),
        ay.saturating_add(by),
        az.saturating_add(bz),
    ]
}

/// Returns the vector from `b` to `a`, saturating at the ends of `i64`.
pub(crate) fn minus(a: [i64; 3], b: [i64; 3]) -> [i64; 3] {
    let ([ax, ay, az], [bx, by, bz]) = (a, b);
    [
        ax.saturating_sub(bx),
        ay.saturating_sub(by),
        az.saturating_sub(bz),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn axes_are_exact() {
        assert_eq!(UnitVector::new([0, 0, 0]), None);
        assert_eq!(UnitVector::new([17, 0, 0]), Some(UnitVector::X));
        assert_eq!(UnitVector::new([0, i64::MAX, 0]), Some(UnitVector::Y));
        assert_eq!(
            UnitVector::new([0, 0, i64::MIN]),
            Some(UnitVector::Z.reversed())
        );
        let third = UnitVector::new([1, 2, -2]).unwrap().components();
        assert_eq!(
            third.map(|c| c.to_bits()),
            [357_913_941, 715_827_883, -715_827_883]
        );
    }

    #[test]
    fn lengths() {
        let oblique = UnitVector::new([3, 4, 0]).unwrap();
        assert_eq!(oblique.scaled(5_000_000), [3_000_000, 4_000_000, 0]);
        assert_eq!(oblique.length_along([3_000_000, 4_000_000, 9]), 5_000_000);
        assert!(oblique.cosine(&oblique) > I2F30::from_bits((1 << 30) - 3));
        assert_eq!(UnitVector::X.scaled(i64::MIN), [-(1 << 32), 0, 0]);
    }
}
