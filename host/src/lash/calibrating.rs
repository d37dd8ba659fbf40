//! `husillo calibrate backlash`.

use super::grid::{self, Reading};
use super::page::{self, Field, Panel};
use super::survey::{CELLS, Leftover, survey};
use super::{Bench, Map, PlaceTable, two_lines};
use crate::calibrating::BacklashArgs;
use crate::machines::machine_file::{MachineFile, Travel};
use crate::programs::setup;
use husillo_metrology::quantity::{self, Quantity};
use std::io::Write;

/// What a calibration makes besides what it prints.
pub struct Calibrated {
    /// The report.
    pub page: String,
    /// The machine file with its map.
    pub machine: String,
}

/// Measures, or reads what was measured, and prints the sections of the machine file.
///
/// # Errors
///
/// A sentence about the file, the readings or the machine.
pub fn calibrate_backlash(
    args: &BacklashArgs,
    file: &MachineFile,
    out: &mut dyn Write,
) -> Result<Calibrated, String> {
    let travel_mm = travel(file)?;
    let now = if args.uncompensated {
        setup::no_lash()
    } else {
        setup::maps(file)?
    };
    let readings = match &args.file {
        Some(path) => {
            let readings = grid::read(path)?;
            for reading in &readings {
                within(reading, travel_mm).map_err(|why| format!("{path}: {why}"))?;
            }
            readings
        }
        None => cut_all(args, file, &now, travel_mm)?,
    };
    let step_nm = file
        .axes
        .each_ref()
        .map(|axis| axis.step.num as f64 / axis.step.den as f64);
    let steps = file.axes.each_ref().map(|axis| axis.step);
    let lash: Vec<(Reading, f64)> = readings
        .iter()
        .map(|reading| {
            let taken_up = value(&now[reading.axis], reading, step_nm, travel_mm);
            (*reading, reading.lash_nm(taken_up))
        })
        .collect();
    let mut maps = setup::maps(file)?;
    let one = setup::one_value(file);
    let mut sections = String::new();
    let mut tables = [None, None];
    for (axis, kept) in tables.iter_mut().enumerate() {
        let Some(table) = grid::table(axis, &lash)? else {
            continue;
        };
        let letter = file.axes[axis].letter;
        let map = table.map(steps[axis], steps);
        maps[axis] = map.map_err(|why| format!("{}: {why}", char::from(letter)))?;
        sections.push_str(&table.text(letter));
        *kept = Some(table);
    }
    if sections.is_empty() {
        return Err("no readings".into());
    }
    let panels = match &args.file {
        None => {
            let [before, after] = [
                survey(file, one, travel_mm)?,
                survey(file, maps, travel_mm)?,
            ];
            surveyed(before, after, travel_mm)
        }
        Some(_) => {
            let mut pairs = Vec::new();
            for (axis, table) in tables.iter().enumerate() {
                if let Some(table) = table {
                    let [before, after] = [&one, &maps]
                        .map(|maps| measured(axis, table, &lash, &maps[axis], step_nm, travel_mm));
                    pairs.push((axis, [before, after]));
                }
            }
            pairs
        }
    };
    let failed = |error: std::io::Error| error.to_string();
    for (axis, [before, after]) in &panels {
        let letter = char::from(file.axes[*axis].letter);
        let table = tables[*axis].iter();
        let um: Vec<f64> = table.flat_map(|table| table.lash_um.clone()).collect();
        let (low, high) = um.iter().fold((f64::MAX, f64::MIN), |(low, high), um| {
            (low.min(*um), high.max(*um))
        });
        writeln!(
            out,
            "# {letter}: {} places, lash {low:.1} to {high:.1} um; left with one value {:+.1} to {:+.1} um, with this map {:+.2} to {:+.2} um",
            um.len(), before.span_um[0], before.span_um[1], after.span_um[0], after.span_um[1]
        )
        .map_err(failed)?;
    }
    out.write_all(sections.as_bytes()).map_err(failed)?;
    let panels: Vec<Panel> = panels
        .into_iter()
        .map(|(axis, fields)| Panel {
            letter: char::from(file.axes[axis].letter),
            value_um: f64::from(file.axes[axis].lash_steps) * step_nm[axis] / 1e3,
            fields,
        })
        .collect();
    Ok(Calibrated {
        page: page::html(&file.title, readings.len(), args.file.is_none(), &panels),
        machine: with_sections(&file.text()?, &sections),
    })
}

/// Travel of X and Y in mm.
/// Whether a reading was made where the axes go.
fn within(reading: &Reading, travel_mm: [[f64; 2]; 2]) -> Result<(), String> {
    for ((place, [low, high]), letter) in reading.place_mm.iter().zip(travel_mm).zip(["X", "Y"]) {
        if place.is_some_and(|mm| !(low..=high).contains(&mm)) {
            let mm = place.unwrap_or_default();
            return Err(format!(
                "a reading at {letter}{mm}, and the travel is {low} to {high} mm"
            ));
        }
    }
    Ok(())
}

fn travel(file: &MachineFile) -> Result<[[f64; 2]; 2], String> {
    let mut travel_mm = [[0.0; 2]; 2];
    for (travel_mm, axis) in travel_mm.iter_mut().zip(&file.axes) {
        let Travel::Range(range) = axis.travel else {
            let letter = char::from(axis.letter);
            return Err(format!(
                "{}: the travel of {letter} is not known",
                file.path
            ));
        };
        *travel_mm = range.map(|nm| nm as f64 / 1e6);
    }
    Ok(travel_mm)
}

/// The two-line test everywhere on the simulated machine.
fn cut_all(
    args: &BacklashArgs,
    file: &MachineFile,
    maps: &[Map; 3],
    travel_mm: [[f64; 2]; 2],
) -> Result<Vec<Reading>, String> {
    let every = match quantity::parse(&args.every) {
        Ok(Quantity::Length(length)) if length.num >= 100_000 => {
            length.num as f64 / length.den as f64 / 1e6
        }
        Ok(_) => return Err("--every: a length from 0.1 mm".into()),
        Err(why) => return Err(format!("--every: {why}")),
    };
    let places = travel_mm.map(|[low, high]| {
        let count = ((high - low) / every).ceil().max(1.0) as u32;
        let part = move |index| low + (high - low) * f64::from(index) / f64::from(count);
        (0..=count).map(part).collect::<Vec<f64>>()
    });
    let run_up_mm = if args.uncompensated {
        two_lines::WHOLE_RUN_UP_MM
    } else {
        two_lines::RUN_UP_MM
    };
    let mut bench = Bench::new(file, maps.clone())?;
    let mut readings = Vec::new();
    for axis in 0..2 {
        for (row, y) in places[1].iter().enumerate() {
            let mut row_of: Vec<f64> = places[0].clone();
            if row % 2 == 1 {
                row_of.reverse();
            }
            for x in row_of {
                readings.push(two_lines::cut(
                    &mut bench,
                    axis,
                    [x, *y],
                    travel_mm,
                    run_up_mm,
                )?);
            }
        }
    }
    Ok(readings)
}

/// What a map takes up where a reading was made, nm; for bands, in the middle of the travel along them.
fn value(map: &Map, reading: &Reading, step_nm: [f64; 3], travel_mm: [[f64; 2]; 2]) -> f64 {
    let at = map.axes().map(|axis| {
        let place = reading.place_mm.get(axis).copied().flatten();
        let middle = travel_mm
            .get(axis)
            .map_or(0.0, |[low, high]| (low + high) / 2.0);
        (place.unwrap_or(middle) * 1e6 / step_nm[axis]).round() as i32
    });
    f64::from(map.steps(at)) * step_nm[reading.axis]
}

fn surveyed(
    before: [Leftover; 2],
    after: [Leftover; 2],
    travel_mm: [[f64; 2]; 2],
) -> Vec<(usize, [Field; 2])> {
    let field = |left: Leftover| Field {
        edges_mm: [0, 1].map(|index| {
            let [low, high] = travel_mm[index];
            let part = |cell| low + (high - low) * cell as f64 / CELLS[index] as f64;
            (0..=CELLS[index]).map(part).collect()
        }),
        um: left.cells_um,
        span_um: left.span_um,
    };
    let pairs = before.into_iter().zip(after);
    let pairs = pairs.map(|(before, after)| [field(before), field(after)]);
    pairs.enumerate().collect()
}

/// What a map leaves of readings, at each place the largest; cells reach half the way to the next place.
fn measured(
    axis: usize,
    table: &PlaceTable,
    lash: &[(Reading, f64)],
    map: &Map,
    step_nm: [f64; 3],
    travel_mm: [[f64; 2]; 2],
) -> Field {
    let edges = |index: usize| -> Vec<f64> {
        let [low, high] = travel_mm[index];
        let own = table.axes.iter().position(|axis| *axis == index);
        let places = own.map_or(&[][..], |own| table.places_mm[own].as_slice());
        let middles = places.windows(2).map(|pair| (pair[0] + pair[1]) / 2.0);
        [low].into_iter().chain(middles).chain([high]).collect()
    };
    let edges_mm = [edges(0), edges(1)];
    let [columns, rows] = edges_mm.each_ref().map(|edges| edges.len() - 1);
    let mut um = vec![0.0_f64; columns * rows];
    let mut span_um = [0.0_f64; 2];
    for (reading, nm) in lash.iter().filter(|(reading, _)| reading.axis == axis) {
        let off = (nm - value(map, reading, step_nm, travel_mm)) / 1e3;
        span_um = [span_um[0].min(off), span_um[1].max(off)];
        let [column, row] = [0, 1].map(|index| {
            let at = reading.place_mm[index].unwrap_or(f64::MIN);
            let inner = &edges_mm[index][1..edges_mm[index].len() - 1];
            inner.partition_point(|edge| *edge <= at)
        });
        let cell = &mut um[row * columns + column];
        if off.abs() > cell.abs() {
            *cell = off;
        }
    }
    Field {
        edges_mm,
        um,
        span_um,
    }
}

/// The text of a machine file with these sections in place of its own.
fn with_sections(text: &str, sections: &str) -> String {
    let mut kept = String::new();
    let mut is_lash = false;
    for line in text.lines() {
        if line.trim_start().starts_with('[') && !line.trim_start().starts_with("[[") {
            // A list of lists goes on with `[`, but not at the beginning of a line that names a table.
            let name = line.trim_start().trim_start_matches('[');
            if name.starts_with(|letter: char| letter.is_ascii_alphabetic()) {
                is_lash = name.starts_with("lash.") || name.starts_with("lash]");
            }
        }
        if !is_lash {
            kept.push_str(line);
            kept.push('\n');
        }
    }
    format!("{}\n\n{sections}", kept.trim_end())
}

#[cfg(test)]
mod tests {
    use super::with_sections;

    #[test]
    fn a_map_takes_the_place_of_the_one_before() {
        let text = "a = 1\n[lash.x]\num = [\n    [1, 2],\n]\n\n[idle]\npolicy = \"off\"\n[lash.y]\num = [3]\n";
        let made = with_sections(text, "[lash.x]\num = [9]\n");
        assert_eq!(
            made,
            "a = 1\n[idle]\npolicy = \"off\"\n\n[lash.x]\num = [9]\n"
        );
        assert_eq!(with_sections(&made, "[lash.x]\num = [9]\n"), made);
    }
}
