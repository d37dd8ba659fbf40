//! From readings of the two-line test to a table by place.

use super::PlaceTable;
use crate::calibrating::columns::{Columns, Row};
use husillo_metrology::quantity::{self, Quantity};

/// What the reading of a mark may be off, um: so far below zero is no lash at all.
const NOISE_UM: f64 = 10.0;

/// Places nearer to each other than this are one, mm.
const SAME_MM: f64 = 0.001;

/// What was measured between two lines.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reading {
    /// X or Y, by number.
    pub axis: usize,
    /// Where the line from above was cut, mm; `None` along an axis that bands lie along.
    pub place_mm: [Option<f64>; 2],
    /// From the line that was reached from below to that reached from above, as programmed, nm; signed.
    pub programmed_nm: f64,
    /// The same as measured.
    pub measured_nm: f64,
}

impl Reading {
    /// Play at the place, where `taken_up_nm` of it was made up for.
    pub fn lash_nm(&self, taken_up_nm: f64) -> f64 {
        taken_up_nm + self.measured_nm - self.programmed_nm
    }
}

/// Reads readings.
///
/// # Errors
///
/// A sentence with the line.
pub fn read(path: &str) -> Result<Vec<Reading>, String> {
    let columns = Columns::read(path, &["axis", "x", "y", "programmed", "measured"])?;
    let length = |row: &Row<'_>, name: &str| row.parsed(name, length_nm);
    let reading = |row: Row<'_>| -> Result<Reading, String> {
        let axis = row.parsed("axis", |text| match text {
            "x" | "X" => Ok(0),
            "y" | "Y" => Ok(1),
            other => Err(format!("`{other}`: expected X or Y")),
        })?;
        let place = |name: &str| match row.get(name) {
            None | Some("") => Ok(None),
            Some(_) => length(&row, name).map(|nm| Some(nm / 1e6)),
        };
        Ok(Reading {
            axis,
            place_mm: [place("x")?, place("y")?],
            programmed_nm: length(&row, "programmed")?,
            measured_nm: length(&row, "measured")?,
        })
    };
    let readings: Result<Vec<_>, _> = columns.rows().map(reading).collect();
    readings.map_err(|why| format!("{path}: {why}"))
}

/// Millimetres, or a length with its unit.
fn length_nm(text: &str) -> Result<f64, String> {
    if let Ok(mm) = text.parse::<f64>() {
        if mm.is_finite() && mm.abs() < 1e6 {
            return Ok(mm * 1e6);
        }
    }
    match quantity::parse(text)? {
        Quantity::Length(length) => Ok(length.num as f64 / length.den as f64),
        _ => Err(format!("`{text}` is no length")),
    }
}

/// The table of an axis from its readings, each with the lash that it says, in nm; several at a place are averaged. `None` without readings.
///
/// # Errors
///
/// A sentence: a place of the grid without a reading, or readings of bands and of places.
pub fn table(axis: usize, readings: &[(Reading, f64)]) -> Result<Option<PlaceTable>, String> {
    let own: Vec<_> = readings
        .iter()
        .filter(|(reading, _)| reading.axis == axis)
        .collect();
    let Some((first, _)) = own.first() else {
        return Ok(None);
    };
    let letter = ["X", "Y"][axis];
    let has = first.place_mm.map(|place| place.is_some());
    if own
        .iter()
        .any(|(reading, _)| reading.place_mm.map(|place| place.is_some()) != has)
    {
        return Err(format!(
            "{letter}: some readings have a place that others leave out"
        ));
    }
    if has == [false; 2] {
        return Err(format!("{letter}: no reading says where it was made"));
    }
    let along = |index: usize| {
        let mut places: Vec<f64> = own
            .iter()
            .map(|(reading, _)| reading.place_mm[index].unwrap_or(0.0))
            .collect();
        places.sort_by(f64::total_cmp);
        places.dedup_by(|later, earlier| (*later - *earlier).abs() < SAME_MM);
        places
    };
    let places = [along(0), along(1)];
    let mut lash_um = Vec::new();
    for y in &places[1] {
        for x in &places[0] {
            let here = own.iter().filter(|(reading, _)| {
                let at = reading.place_mm.map(|place| place.unwrap_or(0.0));
                (at[0] - x).abs() < SAME_MM && (at[1] - y).abs() < SAME_MM
            });
            let (sum, count) =
                here.fold((0.0, 0_u32), |(sum, count), (_, nm)| (sum + nm, count + 1));
            if count == 0 {
                return Err(format!(
                    "{letter}: no reading at X{x:.3} Y{y:.3}, where others of that column and that row are"
                ));
            }
            let um = sum / f64::from(count) / 1e3;
            if um < -NOISE_UM {
                return Err(format!(
                    "{letter}: a lash of {um:.0} um at X{x:.3} Y{y:.3}: there is none below zero; is a reading mistyped?"
                ));
            }
            lash_um.push(um.max(0.0));
        }
    }
    let (axes, places_mm) = match has {
        [true, true] => ([0, 1], places),
        [x, _] => {
            let [along_x, along_y] = places;
            let (axis, places) = if x { (0, along_x) } else { (1, along_y) };
            ([axis; 2], [places, vec![0.0]])
        }
    };
    Ok(Some(PlaceTable {
        axes,
        places_mm,
        lash_um,
    }))
}
