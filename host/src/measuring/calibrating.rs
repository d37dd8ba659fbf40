//! `husillo calibrate axis` and `squareness`.

use super::Stopped;
use super::calibration_file::{axis_lines, squareness_lines};
use super::machine_file;
use crate::app::count;
use crate::cli::{AxisArgs, SquarenessArgs};
use crate::console::reporter::Reporter;
use crate::input::columns::{Columns, Row};
use husillo_backlash::Flank;
use husillo_metrology::calibration::{AxisFit, Ends, Reading, SquareFit};
use husillo_metrology::heads::Machine;
use husillo_simulator::text::json::Millimetres;
use serde_json::json;

/// `husillo calibrate axis`: writes the lines for the machine file to `out`.
///
/// # Errors
///
/// [`Stopped`]: the file is bad, or its readings do not determine a calibration.
pub fn calibrate_axis(args: &AxisArgs, out: &mut Reporter<'_>) -> Result<(), Stopped> {
    let machine = load(&args.machine)?;
    let letter = args.axis.to_ascii_uppercase();
    let axis = machine.axes.iter().position(|axis| axis.letter == letter);
    let index = "XYZ".find(letter).filter(|_| axis.is_some());
    let index = index.ok_or_else(|| format!("{} has no axis {letter}", machine.title))?;
    let columns = Columns::read(&args.file, &["nominal", "reading", "direction"])?;
    let readings: Result<Vec<Reading>, String> = columns
        .rows()
        .map(|row| {
            let flank = match row.get("direction") {
                None | Some("") => Flank::Unknown,
                Some(_) => row.parsed("direction", direction)?,
            };
            Ok(Reading {
                nominal: length(&machine, &row, "nominal")?,
                // Removes the correction by which the machine file has changed the reading.
                reading: machine.errors.axes[index]
                    .reading_nm(length(&machine, &row, "reading")?, flank),
                flank,
            })
        })
        .collect();
    let readings = readings.map_err(|why| format!("{}: {why}", args.file))?;
    let resolution = machine.scale.of_counts(1) as f64;
    let fit = AxisFit::new(&readings, resolution, args.no_table)
        .map_err(|why| format!("{}: {why}", args.file))?;
    let [before, scaled, after] = fit.spans.map(|nm| nm / 1e3);
    let knots = fit.table.knots().len();
    let noise = fit.noise / 1e3;
    let table = if knots > 0 {
        format!("{after:.2} um with its table of {knots} as well")
    } else {
        "no table: it was not requested, or only noise is left".to_owned()
    };
    let lines = axis_lines(letter, &fit.table);
    out.tell(
        format_args!(
            "# {letter}: {} of {}, a mean of them good to {noise:.2} um\n\
             # errors span {before:.2} um; {scaled:.2} um with the scale; {table}\n{}",
            count(readings.len() as u64, "reading"),
            count(fit.lengths as u64, "length"),
            lines.trim_end()
        ),
        || {
            let knots = fit.table.knots().iter();
            let knots = knots.map(|knot| {
                json!({
                    "reading_mm": Millimetres(knot.reading_nm),
                    "after_positive_move_um": f64::from(knot.positive_nm) / 1e3,
                    "after_negative_move_um": f64::from(knot.negative_nm) / 1e3,
                })
            });
            json!({
                "axis": letter,
                "readings": readings.len(),
                "lengths": fit.lengths,
                "noise_um": noise,
                "error_span_um": before,
                "error_span_with_scale_um": scaled,
                "error_span_with_table_um": after,
                "scale_um_per_m": f64::from(fit.table.scale_ppb()) / 1e3,
                "table": knots.collect::<Vec<_>>(),
                "text": lines,
            })
        },
    );
    Ok(())
}

/// `husillo calibrate squareness`: writes the lines for the machine file to `out`.
///
/// # Errors
///
/// [`Stopped`]: the file is bad, or its readings do not determine an angle.
pub fn calibrate_squareness(args: &SquarenessArgs, out: &mut Reporter<'_>) -> Result<(), Stopped> {
    let machine = load(&args.machine)?;
    let names = ["x1", "y1", "z1", "x2", "y2", "z2"];
    let columns = Columns::read(&args.file, &names)?;
    let end = |row: &Row<'_>, names: [&str; 3]| -> Result<[i64; 3], String> {
        let mut position = [0; 3];
        for (coordinate, name) in position.iter_mut().zip(names) {
            // A machine of two axes has no Z.
            if !name.starts_with('z') || columns.has(name) {
                *coordinate = length(&machine, row, name)?;
            }
        }
        Ok(machine.errors.squareness.reading_nm(position))
    };
    let places: Result<Vec<Ends>, String> = columns
        .rows()
        .map(|row| {
            Ok([
                end(&row, ["x1", "y1", "z1"])?,
                end(&row, ["x2", "y2", "z2"])?,
            ])
        })
        .collect();
    let places = places.map_err(|why| format!("{}: {why}", args.file))?;
    let given = match &args.length {
        None => None,
        Some(text) => {
            Some(amount(&machine, text).map_err(|why| format!("--length: {why}"))? as f64)
        }
    };
    let fit = SquareFit::new(&places, given).map_err(|why| format!("{}: {why}", args.file))?;
    let [before, after] = fit.worst.map(|nm| nm / 1e3);
    let origin = if given.is_some() { "" } else { " (fitted)" };
    let length_mm = fit.length / 1e6;
    let unknown = fit.unknown();
    let lines = squareness_lines(&fit.squareness);
    let mut text = format!(
        "# {} of a bar of {length_mm:.4} mm{origin}: off by {before:.2} um at most before, \
         {after:.2} um after\n",
        count(places.len() as u64, "position")
    );
    for plane in &unknown {
        text += &format!("# {plane} is not known: the bar did not lie along both diagonals\n");
    }
    text += lines.trim_end();
    out.tell(text, || {
        let squareness = &fit.squareness;
        let [xy, xz, yz] = [squareness.xy_ppb, squareness.xz_ppb, squareness.yz_ppb]
            .map(|ppb| f64::from(ppb) / 1e3);
        json!({
            "places": places.len(),
            "length_mm": length_mm,
            "is_length_fitted": given.is_none(),
            "worst_before_um": before,
            "worst_after_um": after,
            "unknown_planes": unknown,
            "xy_um_per_m": xy,
            "xz_um_per_m": xz,
            "yz_um_per_m": yz,
            "text": lines,
        })
    });
    Ok(())
}

fn load(name: &str) -> Result<Machine, Stopped> {
    let machine = machine_file::load(name).map_err(Stopped::File)?;
    if machine.scale.unit() == "mm" {
        Ok(machine)
    } else {
        let why = "has no `count` (the length of a count), so lengths cannot be compared";
        Err(Stopped::Usage(format!("{name} {why}")))
    }
}

fn direction(text: &str) -> Result<Flank, String> {
    match text {
        "+" => Ok(Flank::Positive),
        "-" => Ok(Flank::Negative),
        other => Err(format!("`{other}`: expected + or -")),
    }
}

fn length(machine: &Machine, row: &Row<'_>, name: &str) -> Result<i64, String> {
    row.parsed(name, |text| amount(machine, text))
}

fn amount(machine: &Machine, text: &str) -> Result<i64, String> {
    let quantity = machine.scale.parse(text)?;
    let amount = machine.scale.amount(quantity);
    amount.ok_or_else(|| format!("`{text}` is not a length"))
}
