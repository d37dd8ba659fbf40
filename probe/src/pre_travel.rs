//! Pre-travel: the distance the probe travels between touch and signal.

use crate::UnitVector;

/// Table of the pre-travel in nm by direction of travel.
///
/// A stylus bends before the contact opens, and a tripod of contacts bends more in some directions
/// than in others. The distance from touch to signal therefore depends on the direction of
/// approach: in `M = p - ed d - r n`, `ed` must be looked up by `d`.
///
/// Between its `K` directions the table is interpolated with weights `1 / (chord distance)^4`. The
/// result is exact in the directions of the table and continuous. It is never outside the smallest
/// and largest entry, and it does not depend on the order of the entries. The directions need no
/// grid: one entry serves a probe that is equal in all directions, five +-X +-Y -Z, twelve a ring.
///
/// # Source
/// D. Shepard, "A two-dimensional interpolation function for irregularly-spaced data", ACM 1968, on
/// the unit sphere, with power 4.
#[derive(Copy, Clone, Eq, PartialEq, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct PreTravel<const K: usize> {
    /// Unused entries are all equal, so that tables with the same entries compare equal.
    entries: [(UnitVector, i32); K],
    /// Number of used entries, at most `K`.
    used: usize,
}

impl PreTravel<1> {
    /// Creates a table with the same pre-travel in all directions.
    #[must_use]
    pub const fn uniform(nm: i32) -> PreTravel<1> {
        PreTravel::new([(UnitVector::X, nm)])
    }
}

impl<const K: usize> PreTravel<K> {
    /// Creates a table from directions of travel and the pre-travel in nm along each.
    #[must_use]
    pub const fn new(entries: [(UnitVector, i32); K]) -> PreTravel<K> {
        PreTravel { entries, used: K }
    }

    /// Creates a table of a length that is known only at run time. Returns `None` for more than `K`
    /// entries.
    #[must_use]
    pub fn of(entries: &[(UnitVector, i32)]) -> Option<PreTravel<K>> {
        let mut table = PreTravel {
            entries: [(UnitVector::X, 0); K],
            used: entries.len(),
        };
        let places = table.entries.get_mut(..entries.len())?;
        places
            .iter_mut()
            .zip(entries)
            .for_each(|(to, from)| *to = *from);
        Some(table)
    }

    /// Returns the entries.
    #[must_use]
    pub fn entries(&self) -> &[(UnitVector, i32)] {
        self.entries.get(..self.used).unwrap_or(&self.entries)
    }

    /// Returns the pre-travel in nm along `direction`; 0 for an empty table.
    ///
    /// The weights have 24 bits, so the last digit is right within 1 + 2^-23 of the table's range.
    ///
    /// # Cost
    /// `K + 1` 64-bit divisions; none if the direction is in the table or all its entries are the
    /// same.
    #[must_use]
    pub fn along(&self, direction: &UnitVector) -> i32 {
        let mut nearest = u64::MAX;
        for (entry, nm) in self.entries() {
            let square = square_distance(entry, direction);
            if square <= SAME {
                return *nm;
            }
            nearest = nearest.min(square);
        }
        let ends = self.entries().iter().fold(None, |ends, &(_, nm)| {
            ends.map_or(Some((nm, nm)), |(low, high): (i32, i32)| {
                Some((low.min(nm), high.max(nm)))
            })
        });
        let Some((low, high)) = ends else { return 0 };
        if low == high {
            return low;
        }
        let (mut weights, mut sum) = (0_u64, 0_u64);
        for (entry, nm) in self.entries() {
            // nearest <= 2^32, and the divisor is not smaller, so the ratio is at most 2^12.
            let ratio = (nearest << 12)
                .checked_div(square_distance(entry, direction))
                .unwrap_or(0);
            let weight = ratio.wrapping_mul(ratio);
            // Differences to the lowest entry are not negative. Each product is at most 2^24 x
            // 2^32, so 128 entries fit; more saturate.
            let above = u64::from(nm.abs_diff(low));
            sum = sum.saturating_add(weight.wrapping_mul(above));
            weights = weights.saturating_add(weight);
        }
        let above = sum
            .saturating_add(weights >> 1)
            .checked_div(weights)
            .unwrap_or(0);
        // It is a mean, so it is at most high - low.
        low.saturating_add_unsigned(u32::try_from(above).unwrap_or(u32::MAX))
            .min(high)
    }
}

/// Largest square distance of two directions that differ only by rounding. Cosines are within 3 x
/// 2^-30, so these squares are within 6.
const SAME: u64 = 8;

/// Returns the square of the chord between two directions, `2 - 2 cos`, in units of 2^-30:
/// 0..=2^32.
fn square_distance(a: &UnitVector, b: &UnitVector) -> u64 {
    // The cosine is within -1..=1.
    let short = i64::from(1_i32 << 30).wrapping_sub(i64::from(a.cosine(b).to_bits()));
    short.wrapping_mul(2).unsigned_abs()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exact_in_its_own_directions_and_between_them_elsewhere() {
        let minus_x = UnitVector::X.reversed();
        let table = PreTravel::new([
            (UnitVector::X, 8000),
            (minus_x, 4000),
            (UnitVector::Y, 6000),
        ]);
        assert_eq!(table.along(&UnitVector::X), 8000);
        assert_eq!(table.along(&minus_x), 4000);
        assert_eq!(table.along(&UnitVector::Y), 6000);
        // Equally far from each of the three.
        assert_eq!(table.along(&UnitVector::Z), 6000);
        // Halfway between two directions, with 1/34 of their weight on the third: (8000 + 6000 +
        // 4000 / 34) / (2 + 1 / 34).
        let between = UnitVector::new([1, 1, 0]).unwrap();
        assert_eq!(table.along(&between), 6957);
        assert_eq!(PreTravel::uniform(-7).along(&between), -7);
        assert_eq!(PreTravel::new([]).along(&between), 0);
        let roomy = PreTravel::<9>::of(table.entries()).unwrap();
        assert_eq!(
            (roomy.along(&between), roomy.entries()),
            (6957, table.entries())
        );
        assert_eq!(PreTravel::<2>::of(table.entries()), None);
        let wide = PreTravel::new([(UnitVector::X, i32::MIN), (UnitVector::Y, i32::MAX)]);
        assert_eq!(wide.along(&between), 0);
    }
}
