//! The errors of one axis: a scale, and a table of the remaining errors for both directions.

use core::fmt;

use crate::Flank;

/// Readings and targets beyond this many nanometres, 34 m, get the correction at this limit.
pub(crate) const REACH_NM: i64 = 1 << 35;

/// Largest correction of a [`Knot`], nanometres: 2.1 mm.
const MOST_NM: i32 = 1 << 21;

/// Largest error of the scale, parts in 10^9: 1 %.
const MOST_SCALE_PPB: i32 = 10_000_000;

/// Corrections are added in this fraction of a nanometre.
const PARTS: i64 = 16;

/// Passes of the inverse. Each pass reduces the error to at most 0.0725 of itself plus one. The
/// error begins below 2^29.
const PASSES: u8 = 16;

/// The correction of a reading at one position of the travel.
#[derive(Copy, Clone, Debug, PartialEq, Eq, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Knot {
    /// The reading there, nanometres.
    pub reading_nm: i64,
    /// True position less reading after motion in the positive direction, nanometres.
    pub positive_nm: i32,
    /// The same after motion in the negative direction.
    pub negative_nm: i32,
}

/// Why a table is not valid.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum TableError {
    /// The error of the scale is more than 1 %.
    Scale,
    /// This knot, counted from 0, corrects by more than 2.1 mm or is more than 34 m away.
    Range(usize),
    /// The reading of this knot is not above that of the previous one.
    Order(usize),
    /// From the previous knot to this one the correction changes by more than a sixteenth of the
    /// distance.
    Steep(usize),
}

impl fmt::Display for TableError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Scale => f.write_str("the scale is off by more than 1 %"),
            Self::Range(knot) => write!(f, "entry {knot} is beyond 2.1 mm or 34 m"),
            Self::Order(knot) => write!(f, "the readings do not rise at entry {knot}"),
            Self::Steep(knot) => write!(f, "the correction is too steep at entry {knot}"),
        }
    }
}

impl core::error::Error for TableError {}

/// The errors of an axis. [`position_nm`](Self::position_nm) converts a reading to a position, and
/// [`reading_nm`](Self::reading_nm) a position to the reading to move to.
///
/// The correction is `scale_ppb` of the reading and the straight line between the two knots around
/// it, rounded once, to the nearest nanometre. Before the first knot and after the last one it is
/// that of the knot. [`Flank::Positive`] is a position that was reached in the positive direction.
/// If the direction is unknown, the correction is the mean of both.
///
/// Conversion and reverse conversion agree within 1 nm. A position computed from a reading returns
/// exactly. The reason is that corrections change by less than 0.0725 of the distance (1 % of scale
/// and a sixteenth), so positions never fall when readings rise.
///
/// Deviations are taken as in ISO 230-2 (true less target, means of each direction). A knot takes
/// 24 bytes.
///
/// # Examples
/// ```
/// use husillo_backlash::{ErrorTable, Flank, Knot};
///
/// // 50 um/m too short, 2 um of backlash in the middle.
/// let knot = |reading_nm, positive_nm, negative_nm| Knot { reading_nm, positive_nm, negative_nm };
/// let x = ErrorTable::new(
///     50_000,
///     [knot(0, 0, 0), knot(100_000_000, 1000, -1000), knot(200_000_000, 0, 0)],
/// )?;
/// assert_eq!(x.position_nm(100_000_000, Flank::Positive), 100_006_000);
/// assert_eq!(x.position_nm(100_000_000, Flank::Negative), 100_004_000);
/// assert_eq!(x.reading_nm(100_006_000, Flank::Positive), 100_000_000);
/// # Ok::<(), husillo_backlash::TableError>(())
/// ```
#[derive(Copy, Clone, Debug, PartialEq, Eq, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct ErrorTable<T> {
    scale_ppb: i32,
    knots: T,
}

impl<T: AsRef<[Knot]>> ErrorTable<T> {
    /// Creates the table of an axis whose true distance is longer than its readings by `scale_ppb`
    /// parts in 10^9 (1 um/m is 1000). The knots have the remaining errors; there may be none.
    ///
    /// # Errors
    /// [`TableError`], in the order of its variants.
    pub fn new(scale_ppb: i32, knots: T) -> Result<Self, TableError> {
        if scale_ppb.unsigned_abs() > MOST_SCALE_PPB.unsigned_abs() {
            return Err(TableError::Scale);
        }
        let mut before: Option<&Knot> = None;
        for (index, knot) in (0..).zip(knots.as_ref()) {
            let corrections = [knot.positive_nm, knot.negative_nm];
            let is_near = |nm: i32| nm.unsigned_abs() <= MOST_NM.unsigned_abs();
            if knot.reading_nm.unsigned_abs() > REACH_NM.unsigned_abs()
                || !corrections.into_iter().all(is_near)
            {
                return Err(TableError::Range(index));
            }
            if let Some(before) = before {
                // Both within 2^35.
                let distance = knot.reading_nm.wrapping_sub(before.reading_nm);
                if distance <= 0 {
                    return Err(TableError::Order(index));
                }
                let changes = [
                    knot.positive_nm.abs_diff(before.positive_nm),
                    knot.negative_nm.abs_diff(before.negative_nm),
                ];
                let is_steep = |change: u32| i64::from(change).wrapping_mul(16) > distance;
                if changes.into_iter().any(is_steep) {
                    return Err(TableError::Steep(index));
                }
            }
            before = Some(knot);
        }
        Ok(Self { scale_ppb, knots })
    }

    /// Returns the true position at a reading, both in nanometres. Saturates at the ends of `i64`.
    ///
    /// # Cost
    /// A binary search of the knots and two 64-bit divisions.
    #[must_use]
    pub fn position_nm(&self, reading_nm: i64, flank: Flank) -> i64 {
        reading_nm.saturating_add(self.correction_nm(reading_nm, flank))
    }

    /// Returns the reading at a true position, both in nanometres. The error is at most 1 nm.
    ///
    /// # Cost
    /// That of [`position_nm`](Self::position_nm) for each pass: three passes for errors
    /// below 1 mm/m, at most 16.
    #[must_use]
    pub fn reading_nm(&self, position_nm: i64, flank: Flank) -> i64 {
        let mut reading_nm = position_nm;
        for _ in 0..PASSES {
            let correction_nm = self.correction_nm(reading_nm, flank);
            let next = position_nm.saturating_sub(correction_nm);
            if next == reading_nm {
                break;
            }
            reading_nm = next;
        }
        reading_nm
    }

    /// The correction of [`position_nm`](Self::position_nm), nanometres.
    #[must_use]
    pub fn correction_nm(&self, reading_nm: i64, flank: Flank) -> i64 {
        let reading_nm = reading_nm.clamp(-REACH_NM, REACH_NM);
        // Below 2^35 and 2^24; 10^9 parts by 16.
        let scale = reading_nm
            .wrapping_mul(self.scale_ppb.into())
            .div_euclid(1_000_000_000 / PARTS);
        let table = self.table(reading_nm, flank);
        // The scale's part is below 2^33, the table's below 2^26.
        scale
            .wrapping_add(table)
            .wrapping_add(PARTS / 2)
            .div_euclid(PARTS)
    }

    /// Returns the error of the scale, in parts in 10^9.
    pub const fn scale_ppb(&self) -> i32 {
        self.scale_ppb
    }

    /// Returns the knots.
    pub fn knots(&self) -> &[Knot] {
        self.knots.as_ref()
    }

    /// The table's part of the correction, in parts of a nanometre, rounded down.
    fn table(&self, reading_nm: i64, flank: Flank) -> i64 {
        let knots = self.knots.as_ref();
        let above = knots.partition_point(|knot| knot.reading_nm <= reading_nm);
        let high = knots.get(above);
        let low = above.checked_sub(1).and_then(|below| knots.get(below));
        let (low, high) = match (low, high) {
            (Some(low), Some(high)) => (low, high),
            (Some(only), None) | (None, Some(only)) => (only, only),
            (None, None) => return 0,
        };
        // Readings within 2^35 of zero, corrections within 2^21: the product is below 2^(36 + 22 +
        // 4).
        let distance = high.reading_nm.wrapping_sub(low.reading_nm);
        let done = reading_nm.wrapping_sub(low.reading_nm);
        let between = |low_nm: i32, high_nm: i32| {
            let change = i64::from(high_nm).wrapping_sub(low_nm.into());
            let risen = change.wrapping_mul(done).wrapping_mul(PARTS);
            // The distance is 0 only beyond the ends.
            let risen = risen.checked_div_euclid(distance).unwrap_or(0);
            i64::from(low_nm).wrapping_mul(PARTS).wrapping_add(risen)
        };
        let positive = || between(low.positive_nm, high.positive_nm);
        let negative = || between(low.negative_nm, high.negative_nm);
        match flank {
            Flank::Positive => positive(),
            Flank::Negative => negative(),
            Flank::Unknown => positive().wrapping_add(negative()).div_euclid(2),
        }
    }
}
