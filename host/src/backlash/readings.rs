//! Reads the readings of the two-line test from a file.

use crate::input::columns::{Columns, Row};
use husillo_metrology::calibration::backlash::LinePair;
use husillo_metrology::quantity::{self, Quantity};

/// Reads a file of readings.
///
/// # Errors
///
/// The file cannot be read, or a line is bad. The message then has the line number.
pub fn read(path: &str) -> Result<Vec<LinePair>, String> {
    let columns = Columns::read(path, &["axis", "x", "y", "programmed", "measured"])?;
    let length = |row: &Row<'_>, name: &str| row.parsed(name, length_nm);
    let reading = |row: Row<'_>| -> Result<LinePair, String> {
        let axis = row.parsed("axis", |text| match text {
            "x" | "X" => Ok(0),
            "y" | "Y" => Ok(1),
            other => Err(format!("`{other}`: expected X or Y")),
        })?;
        let position = |name: &str| match row.get(name) {
            None | Some("") => Ok(None),
            Some(_) => length(&row, name).map(|nm| Some(nm / 1e6)),
        };
        Ok(LinePair {
            axis,
            position_mm: [position("x")?, position("y")?],
            programmed_nm: length(&row, "programmed")?,
            measured_nm: length(&row, "measured")?,
        })
    };
    let readings: Result<Vec<_>, _> = columns.rows().map(reading).collect();
    readings.map_err(|why| format!("{path}: {why}"))
}

/// Reads millimetres, or a length with its unit.
fn length_nm(text: &str) -> Result<f64, String> {
    if let Ok(mm) = text.parse::<f64>() {
        if mm.is_finite() && mm.abs() < 1e6 {
            return Ok(mm * 1e6);
        }
    }
    match quantity::parse(text)? {
        Quantity::Length(length) => Ok(length.num as f64 / length.den as f64),
        _ => Err(format!("`{text}` is not a length")),
    }
}
