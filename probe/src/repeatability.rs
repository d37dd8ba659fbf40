//! Repeatability of readings.

/// Statistics of repeated readings, stored as exact integer sums.
///
/// Readings are in nm or counts, up to 2^32 - 1 of them; later readings are ignored. They are
/// stored as differences from the first reading, limited to +-2^30.
///
/// # Cost
/// A few additions and one multiplication per reading.
///
/// # Examples
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
    /// Creates statistics without readings.
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

    /// Adds one reading.
    pub fn push(&mut self, reading: i64) {
        let Some(readings) = self.readings.checked_add(1) else {
            return;
        };
        if self.readings == 0 {
            self.first = reading;
        }
        self.readings = readings;
        // Each difference is at most 2^30, and there are fewer than 2^32 readings. The sum is below
        // 2^62, and the sum of squares below 2^92.
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

    /// Returns the number of readings.
    #[must_use]
    pub const fn readings(&self) -> u32 {
        self.readings
    }

    /// Returns the mean, rounded to the nearest; halves of the difference to the first reading are
    /// rounded away from zero. Returns `None` without a reading.
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

    /// Returns the largest reading minus the smallest. Returns `None` without a reading.
    #[must_use]
    pub fn range(&self) -> Option<i64> {
        // Both are within +-2^30.
        (self.readings > 0).then(|| self.most.wrapping_sub(self.least))
    }

    /// Returns the largest unsigned deviation from the mean. Returns `None` without a reading.
    #[must_use]
    pub fn largest_deviation(&self) -> Option<u64> {
        let mean = self.mean()?;
        let ends = [self.least, self.most].map(|end| self.first.saturating_add(end).abs_diff(mean));
        ends.into_iter().max()
    }

    /// Returns the standard deviation of the sample, with `n - 1`, rounded to the nearest. Returns
    /// `None` for fewer than two readings.
    ///
    /// The variance is exact, then truncated to a quarter.
    ///
    /// # Cost
    /// One 128-bit division.
    #[must_use]
    pub fn standard_deviation(&self) -> Option<u64> {
        let readings = u128::from(self.readings);
        // n sum d^2 - (sum d)^2 is not negative (Cauchy). With n < 2^32 and sum d^2 < 2^92, four
        // times it is below 2^126.
        let sum = u128::from(self.sum.unsigned_abs());
        let numerator = readings
            .wrapping_mul(self.squares)
            .wrapping_sub(sum.wrapping_mul(sum));
        let pairs = readings.wrapping_mul(readings.checked_sub(1)?);
        // A standard deviation is at most the range / sqrt(2), so four times the variance is at
        // most 2^63. Half of its root, rounded, is the nearest integer.
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
