//! Velocity from the time of the counts.

/// Velocity by period: the time that the last `COUNTS` counts took, by a clock that wraps at 32
/// bits.
///
/// It is for low speeds, at which whole samples pass without a count. Between two counts it returns
/// the largest possible velocity: at most one count in the time since the last one. After
/// `standstill_ticks` without a count it returns 0. It also returns 0 from a change of direction to
/// the second count of the new one, so that an encoder that vibrates on an edge has no velocity.
/// With `COUNTS` = 4 (or a multiple) the counts of a line with unequal quarters are averaged.
/// Samples may contain several counts (the M/T method: Ohmae et al., A microprocessor-controlled
/// high-accuracy wide-range speed regulator for motor drives, IEEE Trans. IE-29 (3), 1982).
///
/// The error is that of the clock and of the time between samples, `sample_ticks`: at most
/// `sample_ticks` relative to the time of the counts.
///
/// # Examples
/// ```
/// use husillo_encoder::VelocityByPeriod;
///
/// let mut velocity = VelocityByPeriod::<1>::new(1_000_000, 500_000, 0);
/// // A count every 2 ms, sampled every 0.1 ms.
/// for sample in 0..100_u32 {
///     velocity.update((sample / 20) as i32, sample * 100);
/// }
/// assert_eq!(velocity.millicounts_per_s(10_000), 500_000);
/// assert_eq!(velocity.millicounts_per_s(18_000), 100_000); // no more than a count in 10 ms
/// ```
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct VelocityByPeriod<const COUNTS: usize> {
    clock_hz: u32,
    standstill_ticks: u32,
    position: i32,
    is_backward: bool,
    newest: Option<Edge>,
    /// The samples before the newest, as a ring. `known` of them are valid, `next` is the index of
    /// the next one.
    older: [Edge; COUNTS],
    known: usize,
    next: usize,
}

/// A sample with counts.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
struct Edge {
    time_ticks: u32,
    position: i32,
}

impl<const COUNTS: usize> VelocityByPeriod<COUNTS> {
    /// Longest standstill time. All stored periods together are then shorter than the range of the
    /// clock.
    const LONGEST_TICKS: u32 = {
        assert!(COUNTS > 0 && COUNTS <= 1 << 16);
        (1 << 31) / COUNTS as u32
    };

    /// Creates it at rest at this position. After `standstill_ticks` without a count the velocity
    /// is 0. They are limited to 2^31 / `COUNTS`.
    pub const fn new(clock_hz: u32, standstill_ticks: u32, position: i32) -> Self {
        Self {
            clock_hz,
            standstill_ticks: if standstill_ticks < Self::LONGEST_TICKS {
                standstill_ticks
            } else {
                Self::LONGEST_TICKS
            },
            position,
            is_backward: false,
            newest: None,
            older: [Edge {
                time_ticks: 0,
                position: 0,
            }; COUNTS],
            known: 0,
            next: 0,
        }
    }

    /// Takes the position of this sample and its time.
    ///
    /// Call it more often than every `standstill_ticks`.
    #[inline]
    pub fn update(&mut self, position: i32, now_ticks: u32) {
        let moved = position.wrapping_sub(self.position);
        if moved != 0 {
            self.position = position;
            self.turn(moved < 0);
            self.push(Edge {
                time_ticks: now_ticks,
                position,
            });
        } else if let Some(newest) = self.newest {
            if now_ticks.wrapping_sub(newest.time_ticks) >= self.standstill_ticks {
                self.forget();
            }
        }
    }

    /// Returns the velocity at this time in thousandths of a count per second, rounded to zero. It
    /// is negative in the negative direction. The product of counts, 1000 and clock frequency is
    /// limited to 64 bits.
    ///
    /// # Cost
    /// A division of 64 bits.
    pub fn millicounts_per_s(&self, now_ticks: u32) -> i64 {
        let (Some(newest), Some(oldest)) = (self.newest, self.oldest()) else {
            return 0;
        };
        let counts = newest.position.wrapping_sub(oldest.position).unsigned_abs();
        let ticks = newest.time_ticks.wrapping_sub(oldest.time_ticks);
        let age_ticks = now_ticks.wrapping_sub(newest.time_ticks);
        if age_ticks >= self.standstill_ticks {
            return 0;
        }
        // No count in `age_ticks`: at most one in that time. Products of 32 by 32 bits.
        let (counts, ticks) = if u64::from(age_ticks).wrapping_mul(counts.into()) > u64::from(ticks)
        {
            (1, age_ticks)
        } else {
            (counts, ticks)
        };
        // Below 2^42 before the last factor.
        let scale = u64::from(self.clock_hz).wrapping_mul(1000);
        let size = scale
            .saturating_mul(counts.into())
            // Two samples at the same time are a tick apart.
            .checked_div(ticks.max(1).into())
            .unwrap_or(0);
        let size = i64::try_from(size).unwrap_or(i64::MAX);
        if self.is_backward {
            size.wrapping_neg()
        } else {
            size
        }
    }

    /// Sets the position of the last sample, without a change of velocity.
    pub fn set_position(&mut self, position: i32) {
        let shift = position.wrapping_sub(self.position);
        self.position = position;
        for edge in self.older.iter_mut().chain(self.newest.as_mut()) {
            edge.position = edge.position.wrapping_add(shift);
        }
    }

    /// Registers the direction of a count. After a reversal, earlier counts are not valid.
    fn turn(&mut self, is_backward: bool) {
        if self.is_backward != is_backward {
            self.is_backward = is_backward;
            self.forget();
        }
    }

    fn forget(&mut self) {
        self.newest = None;
        self.known = 0;
        self.next = 0;
    }

    fn push(&mut self, edge: Edge) {
        let Some(before) = self.newest.replace(edge) else {
            return;
        };
        if let Some(place) = self.older.get_mut(self.next) {
            *place = before;
        }
        self.next = match self.next.wrapping_add(1) {
            next if next < COUNTS => next,
            _ => 0,
        };
        if self.known < COUNTS {
            self.known = self.known.wrapping_add(1);
        }
    }

    fn oldest(&self) -> Option<Edge> {
        let place = match self.known {
            0 => return None,
            known if known < COUNTS => 0,
            _ => self.next,
        };
        self.older.get(place).copied()
    }
}
