//! A move as the look-ahead sees it.

/// Longer moves are cut to this (17 km), so that nothing overflows.
const MAX_LENGTH_NM: u64 = 1 << 44;
/// Higher accelerations are cut to this (1100 m/s^2).
const MAX_ACCELERATION: u64 = 1 << 40;

/// Length of one move, and its limits of speed and acceleration.
///
/// Speeds are along the path in nm/s, up to 4.29 m/s. A length above 2^44 nm and an acceleration
/// above 2^40 nm/s^2 are taken as these values; an acceleration of 0 is taken as 1.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Stretch {
    /// Length of the path in nm.
    pub length_nm: u64,
    /// Programmed speed, scaled by the override. 0 is taken as 1.
    pub top_nm_per_s: u32,
    /// Limit of the machine in this direction, whatever the override.
    pub ceiling_nm_per_s: u32,
    /// Whether the override of the feed applies, and not that of the rapids.
    pub obeys_override: bool,
    /// Acceleration along the path in nm/s^2.
    pub acceleration_nm_per_s2: u64,
    /// Start/stop speed: needs no ramp.
    pub start_nm_per_s: u32,
    /// Highest speed at the junction with the move before (see [`Junction`](crate::Junction)); 0
    /// stops there.
    pub entry_limit_nm_per_s: u32,
}

/// Overrides in percent.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub(crate) struct Percents {
    pub(crate) feed: u8,
    pub(crate) rapid: u8,
}

impl Percents {
    pub(crate) const FULL: Percents = Percents {
        feed: 100,
        rapid: 100,
    };
}

impl Stretch {
    /// Top speed at a feed override of `percent`, at least 1 nm/s.
    pub fn top_at(&self, percent: u8) -> u32 {
        self.top_under(Percents {
            feed: percent,
            ..Percents::FULL
        })
    }

    /// Top speed under the overrides, at least 1 nm/s.
    pub(crate) fn top_under(&self, percents: Percents) -> u32 {
        let programmed = u64::from(self.top_nm_per_s);
        let percent = if self.obeys_override {
            percents.feed
        } else {
            percents.rapid
        };
        // Below 2^32 2^8.
        let scaled = match percent {
            100 => programmed,
            percent => programmed.wrapping_mul(percent.into()) / 100,
        };
        // At most the ceiling, which has 32 bits.
        scaled.min(self.ceiling_nm_per_s.into()).max(1) as u32
    }

    /// Largest change of the square of the speed over the whole move: 2 a L, at most 2^85.
    pub(crate) fn gain(&self) -> u128 {
        u128::from(self.length()).wrapping_mul(u128::from(self.double_acceleration()))
    }

    pub(crate) fn length(&self) -> u64 {
        self.length_nm.min(MAX_LENGTH_NM)
    }

    /// 2 a, at most 2^41.
    pub(crate) fn double_acceleration(&self) -> u64 {
        self.acceleration_nm_per_s2
            .clamp(1, MAX_ACCELERATION)
            .wrapping_mul(2)
    }
}

/// A speed squared, exactly.
pub(crate) fn square(speed_nm_per_s: u32) -> u64 {
    // (2^32 - 1)^2 < 2^64
    u64::from(speed_nm_per_s).wrapping_mul(speed_nm_per_s.into())
}
