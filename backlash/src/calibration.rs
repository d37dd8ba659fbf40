//! Three axes with their errors, and the angles between them.

use crate::{ErrorTable, Flank, Knot, Squareness};

/// The known errors of three axes: converts readings to positions, and back.
///
/// Readings are corrected axis by axis, then for squareness. The reverse conversion begins with Z
/// and continues with Y and X. Each coordinate uses the positions that the previous axes actually
/// reach. So every coordinate returns within 1 nm.
///
/// # Examples
/// ```
/// use husillo_backlash::{Calibration, ErrorTable, Flank, Knot, Squareness};
///
/// let scale = |ppb| ErrorTable::new(ppb, [Knot::default(); 0]);
/// let machine = Calibration {
///     axes: [scale(50_000)?, scale(0)?, scale(0)?],
///     squareness: Squareness { xy_ppb: 100_000, ..Squareness::default() },
/// };
/// let flanks = [Flank::Positive; 3];
/// assert_eq!(
///     machine.position_nm([100_000_000, 10_000_000, 0], flanks),
///     [100_006_000, 10_000_000, 0],
/// );
/// assert_eq!(
///     machine.reading_nm([100_006_000, 10_000_000, 0], flanks),
///     [100_000_000, 10_000_000, 0],
/// );
/// # Ok::<(), husillo_backlash::TableError>(())
/// ```
#[derive(Copy, Clone, Debug, PartialEq, Eq, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Calibration<T> {
    /// Errors of X, Y and Z along their own directions.
    pub axes: [ErrorTable<T>; 3],
    /// The angles between them.
    pub squareness: Squareness,
}

impl<T: AsRef<[Knot]>> Calibration<T> {
    /// Returns the true position at readings, in nanometres. `flanks` are the directions of the
    /// last motions.
    ///
    /// # Cost
    /// That of [`ErrorTable::position_nm`] three times, and [`Squareness::position_nm`].
    #[must_use]
    pub fn position_nm(&self, readings_nm: [i64; 3], flanks: [Flank; 3]) -> [i64; 3] {
        let mut along = readings_nm;
        for ((along, axis), flank) in along.iter_mut().zip(&self.axes).zip(flanks) {
            *along = axis.position_nm(*along, flank);
        }
        self.squareness.position_nm(along)
    }

    /// Returns the readings at a true position, in nanometres, that is approached in these
    /// directions. The error is at most 1 nm.
    ///
    /// # Cost
    /// That of [`ErrorTable::reading_nm`] three times, and three times
    /// [`ErrorTable::position_nm`].
    #[must_use]
    pub fn reading_nm(&self, [x, y, z]: [i64; 3], flanks: [Flank; 3]) -> [i64; 3] {
        let [x_axis, y_axis, z_axis] = &self.axes;
        let [x_flank, y_flank, z_flank] = flanks;
        let z_reading = z_axis.reading_nm(z, z_flank);
        let z = z_axis.position_nm(z_reading, z_flank);
        let y = y.wrapping_sub(self.squareness.y_shift(z));
        let y_reading = y_axis.reading_nm(y, y_flank);
        let y = y_axis.position_nm(y_reading, y_flank);
        let x = x.wrapping_sub(self.squareness.x_shift(y, z));
        [x_axis.reading_nm(x, x_flank), y_reading, z_reading]
    }
}
