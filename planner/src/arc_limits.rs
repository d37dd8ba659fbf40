//! Highest speed and acceleration along an arc.

/// Speeds and accelerations along an arc, at two levels.
///
/// The acceleration towards the centre, v^2 / r, and the one along the path add up by their squares
/// to what the axes allow. At the lower level half of the limit may go to the centre, and sqrt(3)/2
/// of it is left along the path. At the upper one 0.98 of it goes to the centre, and sqrt(1 -
/// 0.98^2) is left.
///
/// # Examples
/// ```
/// use husillo_planner::ArcLimits;
///
/// // 500 mm/s^2, a radius of 2 mm: the limit is sqrt(a r) = 31.62 mm/s.
/// let limits = ArcLimits::new(500_000_000, 2_000_000);
/// assert_eq!(limits.speed_nm_per_s, [22_360_679, 31_304_951]);
/// assert_eq!(limits.acceleration_nm_per_s2, [433_000_000, 99_000_000]);
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
    /// `acceleration_nm_per_s2` is the smaller limit of the two axes of the plane.
    pub fn new(acceleration_nm_per_s2: u64, radius_nm: u64) -> ArcLimits {
        // Thousandths. Dividing first keeps the product in range.
        let share = |thousandths: u64| {
            let whole = (acceleration_nm_per_s2 / 1000).wrapping_mul(thousandths);
            let rest = (acceleration_nm_per_s2 % 1000).wrapping_mul(thousandths);
            whole.wrapping_add(rest / 1000)
        };
        // The root of 64 bits has 32 bits.
        let speed = |towards: u64| towards.saturating_mul(radius_nm).isqrt() as u32;
        ArcLimits {
            speed_nm_per_s: [speed(acceleration_nm_per_s2 / 2), speed(share(980))],
            // 0.866 is below sqrt(3)/2, 0.198 below sqrt(1 - 0.98^2).
            acceleration_nm_per_s2: [share(866), share(198)],
        }
    }
}
