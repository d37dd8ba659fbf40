//! A move as the look-ahead sees it.

use core::num::NonZeroU16;

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
    /// The level of speed at which less acceleration is left along the path; `None` if there is
    /// none.
    pub upper: Option<Upper>,
    /// Start/stop speed: needs no ramp.
    pub start_nm_per_s: u32,
    /// Highest speed at the junction with the move before (see [`Junction`](crate::Junction)); 0
    /// stops there.
    pub entry_limit_nm_per_s: u32,
}

/// The upper of two levels of speed, as an arc has them: the faster it is, the more of the
/// acceleration changes its direction, and the less is left along the path.
///
/// [`ArcLimits`](crate::ArcLimits) computes both levels of an arc. Both values are kept as parts of
/// those of the [`Stretch`], so that a place in the queue is small.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Upper {
    /// Part of the ceiling at which it begins, in 2^-16.
    from: u16,
    /// Part of the acceleration that is left in it, in 2^-16.
    share: NonZeroU16,
}

impl Upper {
    /// The upper level of a stretch with this ceiling. It begins at the speed `from_nm_per_s`, and
    /// in it the acceleration falls from the first to the second of these, both in nm/s^2. Parts
    /// are rounded down, so no limit is exceeded.
    ///
    /// Returns `None` for a stretch with one level: if it never reaches the speed, or if the
    /// acceleration does not fall.
    pub fn new(
        ceiling_nm_per_s: u32,
        from_nm_per_s: u32,
        accelerations_nm_per_s2: [u64; 2],
    ) -> Option<Upper> {
        let [below, above] = accelerations_nm_per_s2.map(|limit| limit.min(MAX_ACCELERATION));
        if from_nm_per_s >= ceiling_nm_per_s || above >= below {
            return None;
        }
        // Both quotients are below 2^16.
        let from = (u64::from(from_nm_per_s) << 16).checked_div(ceiling_nm_per_s.into())?;
        let share = (above << 16).checked_div(below)?;
        Some(Upper {
            from: from as u16,
            share: NonZeroU16::new(share as u16).unwrap_or(NonZeroU16::MIN),
        })
    }
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

    /// With this override of the feed, or the nearest one that is possible.
    pub(crate) fn with_feed(self, percent: u8) -> Percents {
        Percents {
            feed: percent.clamp(1, 200),
            ..self
        }
    }

    /// With this override of the rapids, or the nearest one that is possible.
    pub(crate) fn with_rapid(self, percent: u8) -> Percents {
        Percents {
            rapid: percent.clamp(1, 100),
            ..self
        }
    }
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

    /// Accelerations along the path below and in the upper level, and the speed at which this level
    /// begins; `u32::MAX` and twice the same acceleration without an upper level.
    pub fn levels(&self) -> ([u64; 2], u32) {
        let doubles = [self.double_acceleration(), self.double_upper()];
        (doubles.map(|double| double >> 1), self.knee())
    }

    /// Top speed under the overrides, below the upper level.
    pub(crate) fn lower_top(&self, percents: Percents) -> u32 {
        self.top_under(percents).min(self.knee())
    }

    /// Largest change of the square of the speed over the whole move: 2 a L, at most 2^85.
    pub(crate) fn gain(&self) -> u128 {
        self.gain_by(self.double_acceleration())
    }

    /// The same with the acceleration of the upper level.
    pub(crate) fn upper_gain(&self) -> u128 {
        self.gain_by(self.double_upper())
    }

    /// The length in two halves needs no product of 128 bits.
    fn gain_by(&self, double: u64) -> u128 {
        let length = self.length();
        let [high, low] = [length >> 22, length & ((1 << 22) - 1)];
        // At most 22 and 41 bits.
        let [high, low] = [high, low].map(|half| u128::from(half.wrapping_mul(double)));
        (high << 22).wrapping_add(low)
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

    /// 2 a at the upper level.
    pub(crate) fn double_upper(&self) -> u64 {
        let double = self.double_acceleration();
        match &self.upper {
            None => double,
            // 41 and 16 bits. An even number of at least 2, so that half of it is exact.
            Some(upper) => {
                let share = u64::from(upper.share.get());
                double.wrapping_mul(share).wrapping_shr(17).max(1) << 1
            }
        }
    }

    /// The highest speed below the upper level.
    pub(crate) fn knee(&self) -> u32 {
        match &self.upper {
            None => u32::MAX,
            // Below the ceiling.
            Some(upper) => {
                let product = u64::from(self.ceiling_nm_per_s).wrapping_mul(upper.from.into());
                (product >> 16).max(1) as u32
            }
        }
    }
}

/// A speed squared, exactly.
pub(crate) fn square(speed_nm_per_s: u32) -> u64 {
    // (2^32 - 1)^2 < 2^64
    u64::from(speed_nm_per_s).wrapping_mul(speed_nm_per_s.into())
}
