//! How well the same touch gives the same number.

/// Statistics of repeated readings, kept as exact integer sums.
///
/// Readings in nm or counts; they are kept as differences from the first, which must be within
/// +-2^30 (farther ones count as that). Any number of readings up to 2^32 - 1; later ones are not
/// taken. A few additions and one multiplication each.
///
/// ```
/// use husillo_probe::Repeatability;
///
/// let readings: Repeatability = [1002, 998, 1000, 1000].into_iter().collect();
/// assert_eq!(readings.mean(), Some(1000));
/// assert_eq!(readings.range(), Some(4));
/// assert_eq!(readings.standard_deviation(), Some(2)); // of the sample: sqrt(8 / 3) = 1.63
/// ```
#[derive(Copy, Clone, Eq, PartialEq, Debug, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Repeatability {
    readings: u32,
    first: i64,
    sum: i64,
    squares: u128,
    least: i64,
    most: i64,
}

impl Repeatability {
    /// Nothing read yet.
    #[must_use]
    pub const fn new() -> Repeatability {
        Repeatability {
            readings: 0,
            first: 0,
            sum: 0,
            squares: 0,
            least: 0,
            most: 0,
        }
    }

    /// Takes one reading.
    pub fn push(&mut self, reading: i64) {
        let Some(readings) = self.readings.checked_add(1) else {
            return;
        };
        if self.readings == 0 {
            self.first = reading;
        }
        self.readings = readings;
        // At most 2^30 each, below 2^32 readings: the sum is below 2^62 and the squares below 2^92.
        let difference = reading
            .saturating_sub(self.first)
            .clamp(-(1 << 30), 1 << 30);
        self.sum = self.sum.saturating_add(difference);
        let square = difference
            .unsigned_abs()
            .saturating_mul(difference.unsigned_abs());
        self.squares = self.squares.wrapping_add(u128::from(square));
        self.least = self.least.min(difference);
        self.most = self.most.max(difference);
    }

    /// How many readings were taken.
    #[must_use]
    pub const fn readings(&self) -> u32 {
        self.readings
    }

    /// The mean to the nearest, halves away from zero of the difference to the first; `None`
    /// without a reading.
    #[must_use]
    pub fn mean(&self) -> Option<i64> {
        let readings = u64::from(self.readings);
        // Below 2^62 + 2^31.
        let magnitude = self
            .sum
            .unsigned_abs()
            .wrapping_add(readings >> 1)
            .checked_div(readings)?
            .cast_signed();
        Some(if self.sum < 0 {
            self.first.saturating_sub(magnitude)
        } else {
            self.first.saturating_add(magnitude)
        })
    }

    /// The largest reading less the smallest; `None` without a reading.
    #[must_use]
    pub fn range(&self) -> Option<i64> {
        // Both within +-2^30.
        (self.readings > 0).then(|| self.most.wrapping_sub(self.least))
    }

    /// The farthest reading from the mean, without sign; `None` without a reading.
    #[must_use]
    pub fn largest_deviation(&self) -> Option<u64> {
        let mean = self.mean()?;
        let ends = [self.least, self.most].map(|end| self.first.saturating_add(end).abs_diff(mean));
        ends.into_iter().max()
    }

    /// The standard deviation of the sample, with `n - 1`, to the nearest; `None` below two
    /// readings.
    ///
    /// The variance is exact, then truncated to a quarter; one 128-bit division.
    #[must_use]
    pub fn standard_deviation(&self) -> Option<u64> {
        let readings = u128::from(self.readings);
        // n sum d^2 - (sum d)^2 is not negative (Cauchy); n < 2^32 and sum d^2 < 2^92, so four of
        // it stay below 2^126.
        let sum = u128::from(self.sum.unsigned_abs());
        let numerator = readings
            .wrapping_mul(self.squares)
            .wrapping_sub(sum.wrapping_mul(sum));
        let pairs = readings.wrapping_mul(readings.checked_sub(1)?);
        // A standard deviation is at most the range / sqrt(2), so this is at most 2^63. The root of
        // four times it, halved, rounds.
        let twice = numerator.wrapping_mul(4).checked_div(pairs)?;
        let twice = u64::try_from(twice).unwrap_or(u64::MAX).isqrt();
        Some(twice.wrapping_add(1) >> 1)
    }
}

impl Extend<i64> for Repeatability {
    fn extend<I: IntoIterator<Item = i64>>(&mut self, readings: I) {
        readings.into_iter().for_each(|reading| self.push(reading));
    }
}

impl FromIterator<i64> for Repeatability {
    fn from_iter<I: IntoIterator<Item = i64>>(readings: I) -> Repeatability {
        let mut statistics = Repeatability::new();
        statistics.extend(readings);
        statistics
    }
}
