//! Results of the two-line test, and the table of backlash by position that they give.

use super::table::{BacklashTable, Map};

/// Largest error of the reading of a mark, um. A measured backlash that is negative by at most this
/// much counts as zero.
const NOISE_UM: f64 = 10.0;

/// Positions that are less than this apart are the same, mm.
const SAME_MM: f64 = 0.001;

/// Two lines of the two-line test, and the measured distance between them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LinePair {
    /// The axis: 0 for X, 1 for Y.
    pub axis: usize,
    /// Position of the line that was reached from above, mm. `None` on an axis along which the
    /// backlash counts as constant.
    pub position_mm: [Option<f64>; 2],
    /// Programmed signed distance from the line that was reached from below to the one that was
    /// reached from above, nm.
    pub programmed_nm: f64,
    /// The same distance as measured, nm.
    pub measured_nm: f64,
}

impl LinePair {
    /// Backlash at the position, nm. The controller took up `taken_up_nm` of it during the test.
    #[must_use]
    pub fn backlash_nm(&self, taken_up_nm: f64) -> f64 {
        taken_up_nm + self.measured_nm - self.programmed_nm
    }

    /// Take-up of a map at the position of the pair, nm. On an axis without a position this is in
    /// the middle of the travel.
    #[must_use]
    pub fn taken_up_nm(&self, map: &Map, step_nm: [f64; 3], travel_mm: [[f64; 2]; 2]) -> f64 {
        let at = map.axes().map(|axis| {
            let position = self.position_mm.get(axis).copied().flatten();
            let middle = travel_mm
                .get(axis)
                .map_or(0.0, |[low, high]| (low + high) / 2.0);
            (position.unwrap_or(middle) * 1e6 / step_nm[axis]).round() as i32
        });
        f64::from(map.steps(at)) * step_nm[self.axis]
    }

    /// Checks that the pair lies within the travel.
    ///
    /// # Errors
    ///
    /// A sentence with the position and the travel.
    pub fn within(&self, travel_mm: [[f64; 2]; 2]) -> Result<(), String> {
        for ((position, [low, high]), letter) in
            self.position_mm.iter().zip(travel_mm).zip(["X", "Y"])
        {
            if position.is_some_and(|mm| !(low..=high).contains(&mm)) {
                let mm = position.unwrap_or_default();
                return Err(format!(
                    "a reading at {letter}{mm}, and the travel is {low} to {high} mm"
                ));
            }
        }
        Ok(())
    }
}

/// Makes the table of an axis from its readings, each with the backlash that it shows, in nm.
/// Several readings at a position are averaged. `None` without readings.
///
/// # Errors
///
/// A sentence: a position of the grid has no reading, or the readings have different axes.
pub fn backlash_table(
    axis: usize,
    pairs: &[(LinePair, f64)],
) -> Result<Option<BacklashTable>, String> {
    let own: Vec<_> = pairs.iter().filter(|(pair, _)| pair.axis == axis).collect();
    let Some((first, _)) = own.first() else {
        return Ok(None);
    };
    let letter = if axis == 0 { "X" } else { "Y" };
    let has = first.position_mm.map(|position| position.is_some());
    if own
        .iter()
        .any(|(reading, _)| reading.position_mm.map(|position| position.is_some()) != has)
    {
        return Err(format!(
            "{letter}: some readings have a coordinate that others leave out"
        ));
    }
    if has == [false; 2] {
        return Err(format!(
            "{letter}: no reading has the position where it was made"
        ));
    }
    let along = |index: usize| {
        let mut positions: Vec<f64> = own
            .iter()
            .map(|(reading, _)| reading.position_mm[index].unwrap_or(0.0))
            .collect();
        positions.sort_by(f64::total_cmp);
        positions.dedup_by(|later, earlier| (*later - *earlier).abs() < SAME_MM);
        positions
    };
    let positions = [along(0), along(1)];
    let mut backlash_um = Vec::new();
    for y in &positions[1] {
        for x in &positions[0] {
            let here = own.iter().filter(|(reading, _)| {
                let at = reading.position_mm.map(|position| position.unwrap_or(0.0));
                (at[0] - x).abs() < SAME_MM && (at[1] - y).abs() < SAME_MM
            });
            let (sum, count) =
                here.fold((0.0, 0_u32), |(sum, count), (_, nm)| (sum + nm, count + 1));
            if count == 0 {
                return Err(format!(
                    "{letter}: no reading at X{x:.3} Y{y:.3}, but there are others in that column \
                     and in that row"
                ));
            }
            let um = sum / f64::from(count) / 1e3;
            if um < -NOISE_UM {
                return Err(format!(
                    "{letter}: a backlash of {um:.0} um at X{x:.3} Y{y:.3}, which is below zero: \
                     is a reading mistyped?"
                ));
            }
            backlash_um.push(um.max(0.0));
        }
    }
    let (axes, positions_mm) = match has {
        [true, true] => ([0, 1], positions),
        [x, _] => {
            let [along_x, along_y] = positions;
            let (axis, positions) = if x { (0, along_x) } else { (1, along_y) };
            ([axis; 2], [positions, vec![0.0]])
        }
    };
    Ok(Some(BacklashTable {
        axes,
        positions_mm,
        backlash_um,
    }))
}
