//! Highest speed and acceleration along an arc.

use crate::stretch::square;

/// Speeds and accelerations along an arc, at two levels.
///
/// The acceleration towards the centre, v^2 / r, and the one along the path add up by their squares
/// to what the axes allow. At the lower level half of the limit may go to the centre, and sqrt(3)/2
/// of it is left along the path. At the upper one 0.98 of it goes to the centre, and sqrt(1 -
/// 0.98^2) is left. An arc that is always slower needs one level only: the lower one then ends at
/// the highest speed of the arc, and up to the whole acceleration is left.
///
/// # Examples
/// ```
/// use husillo_planner::ArcLimits;
///
/// // 500 mm/s^2, a radius of 2 mm: the limit is sqrt(a r) = 31.62 mm/s.
/// let limits = ArcLimits::new(500_000_000, 2_000_000, u32::MAX);
/// assert_eq!(limits.speed_nm_per_s, [22_360_679, 31_304_951]);
/// assert_eq!(limits.acceleration_nm_per_s2, [433_000_000, 99_000_000]);
/// // At 10 mm/s a tenth of it goes to the centre.
/// let limits = ArcLimits::new(500_000_000, 2_000_000, 10_000_000);
/// assert_eq!(limits.speed_nm_per_s, [10_000_000, 31_304_951]);
/// assert_eq!(limits.acceleration_nm_per_s2, [497_474_670, 99_000_000]);
/// ```
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct ArcLimits {
    /// Highest speed of the lower and of the upper level.
    pub speed_nm_per_s: [u32; 2],
    /// Acceleration along the path at the two levels.
    pub acceleration_nm_per_s2: [u64; 2],
}

impl ArcLimits {
    /// `acceleration_nm_per_s2` is the smaller limit of the two axes of the plane, cut to 2^40.
    /// `highest_nm_per_s` is the highest speed that the arc may have, at any override.
    pub fn new(acceleration_nm_per_s2: u64, radius_nm: u64, highest_nm_per_s: u32) -> ArcLimits {
        let acceleration = acceleration_nm_per_s2.min(1 << 40);
        // Below 2^50.
        let share = |thousandths: u64| acceleration.wrapping_mul(thousandths) / 1000;
        // The root of 64 bits has 32 bits.
        let speed = |towards: u64| towards.saturating_mul(radius_nm).isqrt() as u32;
        // 0.866 is below sqrt(3)/2, 0.198 below sqrt(1 - 0.98^2).
        let mut limits = ArcLimits {
            speed_nm_per_s: [speed(acceleration / 2), speed(share(980))],
            acceleration_nm_per_s2: [share(866), share(198)],
        };
        let [lower, _] = &mut limits.speed_nm_per_s;
        if highest_nm_per_s < *lower {
            *lower = highest_nm_per_s;
            let [along, _] = &mut limits.acceleration_nm_per_s2;
            let whole = acceleration.saturating_mul(radius_nm);
            let more = acceleration.wrapping_mul(left(square(highest_nm_per_s), whole)) >> 16;
            *along = more.max(*along);
        }
        limits
    }
}

/// The part of the acceleration that is left along the path, in 2^-16, where the part c = `squared`
/// / `whole` of it goes to the centre. c is at most 1/2.
///
/// sqrt(1 - c^2) is at least 1 - c^2 / 2 - c^4 / 6 up to c = 1/2: 1 - c^2 / 2 - c^4 / 8 is the
/// start of its series, and the other terms are below c^4 / 24.
fn left(squared: u64, whole: u64) -> u64 {
    // Rounded up, and a half for the smallest circles. At most 2^15 and 1.
    let c = squared.checked_div(whole >> 16).unwrap_or(1 << 15);
    let c = c.min(1 << 15).wrapping_add(1);
    let second = c.wrapping_mul(c) >> 16;
    let fourth = second.wrapping_mul(second) >> 16;
    // 3 is more than what was rounded down.
    let less = (second >> 1).wrapping_add(fourth / 6).wrapping_add(3);
    (1_u64 << 16).saturating_sub(less)
}
