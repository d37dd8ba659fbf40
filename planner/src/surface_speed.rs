//! Constant surface speed of a lathe.

/// Speed of a spindle that follows the radius at which the tool cuts.
///
/// # Examples
///
/// ```
/// use husillo_planner::SurfaceSpeed;
///
/// // 60 m/min, and at most 3000 rpm.
/// let mut speed = SurfaceSpeed::new(60_000_000_000, 3_000_000);
/// let milli_rpm = speed.at(0, 10_000_000).unwrap(); // a radius of 10 mm
/// assert_eq!(milli_rpm / 1000, 954); // 60 m / (2 pi 10 mm)
/// assert_eq!(speed.at(1, 10_010_000), None); // 0.1 % is no reason to change
/// assert_eq!(speed.at(2, 1_000_000), Some(3_000_000));
/// ```
///
/// # Cost
///
/// A division of 64 bits for each new position.
#[derive(Copy, Clone, Debug)]
pub struct SurfaceSpeed {
    nm_per_min: u64,
    most_milli_rpm: u64,
    /// The position for which the speed was computed last.
    at: Option<i32>,
    /// The speed in effect.
    milli_rpm: u64,
}

impl SurfaceSpeed {
    /// The speed in effect is kept while it is off by less than a 128th part.
    const TOLERANCE_BITS: u32 = 7;

    /// Creates the speed of a spindle that stands.
    ///
    /// `nm_per_min` is the speed of the surface, below 2^53; 0 keeps the spindle standing. The
    /// spindle never turns faster than `most_milli_rpm`.
    pub const fn new(nm_per_min: u64, most_milli_rpm: u64) -> Self {
        SurfaceSpeed {
            nm_per_min,
            most_milli_rpm,
            at: None,
            milli_rpm: 0,
        }
    }

    /// Returns the new speed of the spindle in thousandths of a turn per minute, if it has to
    /// change. `at` is the position of the tool in any unit: a position that is not new changes
    /// nothing. `radius_nm` is its distance from the axis of the spindle.
    pub fn at(&mut self, at: i32, radius_nm: u64) -> Option<u64> {
        if self.at == Some(at) {
            return None;
        }
        self.at = Some(at);
        let wanted = if self.nm_per_min == 0 {
            0
        } else {
            // speed / (2 pi r), with 355 / 113 for pi (8e-8 off). Speeds are below 2^53 nm/min, so
            // the product may saturate only beyond the highest speed.
            let turn = radius_nm.saturating_mul(710);
            let most = self.nm_per_min.saturating_mul(113).saturating_mul(1000);
            most.checked_div(turn)
                .map_or(self.most_milli_rpm, |rpm| rpm.min(self.most_milli_rpm))
        };
        let is_limit = wanted == self.most_milli_rpm || wanted == 0;
        let off = wanted.abs_diff(self.milli_rpm);
        if off == 0 || (!is_limit && off <= self.milli_rpm >> Self::TOLERANCE_BITS) {
            return None;
        }
        self.milli_rpm = wanted;
        Some(wanted)
    }
}
