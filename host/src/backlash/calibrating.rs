//! `husillo calibrate backlash`.

use super::bench::SimulatedBench;
use super::readings;
use crate::cli::BacklashArgs;
use crate::console::reporter::Reporter;
use husillo_metrology::calibration::backlash::{
    BacklashTable, Field, Leftover, LinePair, Map, RUN_UP_MM, WHOLE_RUN_UP_MM, backlash_table,
    cut_all, survey,
};
use husillo_metrology::quantity::{self, Quantity};
use husillo_reports::backlash::{self, Panel};
use husillo_sim::observers::AXES;
use husillo_sim::text::counted;
use husillo_simulator::machines::backlash_file::section;
use husillo_simulator::machines::machine_file::{MachineFile, Travel};
use husillo_simulator::programs::setup;
use serde_json::json;

/// The files that a calibration writes.
pub struct Calibrated {
    /// The report.
    pub page: String,
    /// The machine file with its map.
    pub machine: String,
}

/// Measures on the simulated machine or reads measured values, and prints the sections of the
/// machine file.
///
/// # Errors
///
/// A message about the file, the readings or the machine.
pub fn calibrate_backlash(
    args: &BacklashArgs,
    file: &MachineFile,
    out: &mut Reporter<'_>,
) -> Result<Calibrated, String> {
    let travel_mm = travel(file)?;
    let now = if args.uncompensated {
        setup::no_backlash()
    } else {
        setup::maps(file)?
    };
    let readings = pairs(args, file, &now, travel_mm)?;
    let step_nm = file.xyz(|axis| axis.step.num as f64 / axis.step.den as f64);
    let steps = file.xyz(|axis| axis.step);
    let backlash: Vec<(LinePair, f64)> = readings
        .iter()
        .map(|reading| {
            let taken_up = reading.taken_up_nm(&now[reading.axis], step_nm, travel_mm);
            (*reading, reading.backlash_nm(taken_up))
        })
        .collect();
    let mut maps = setup::maps(file)?;
    let one = setup::one_value(file);
    let mut sections = String::new();
    let mut tables = [None, None];
    for (axis, kept) in tables.iter_mut().enumerate() {
        let Some(table) = backlash_table(axis, &backlash)? else {
            continue;
        };
        let letter = file.axes[axis].letter;
        let map = table.map(steps[axis], steps);
        maps[axis] = map.map_err(|why| format!("{}: {why}", char::from(letter)))?;
        sections.push_str(&section(&table, letter));
        *kept = Some(table);
    }
    if sections.is_empty() {
        return Err("no readings".into());
    }
    let panels = match args.file {
        None => {
            let over = |maps| survey(&mut SimulatedBench::new(file, maps)?, travel_mm);
            let [before, after] = [over(one)?, over(maps)?];
            surveyed(before, after, travel_mm)
        }
        Some(_) => {
            let measured = |axis: usize, table: &BacklashTable| {
                [&one, &maps].map(|maps| {
                    Field::measured(axis, table, &backlash, &maps[axis], step_nm, travel_mm)
                })
            };
            let tables = tables.iter().enumerate();
            tables
                .filter_map(|(axis, table)| Some((axis, measured(axis, table.as_ref()?))))
                .collect()
        }
    };
    for (axis, fields) in &panels {
        let um = tables[*axis]
            .as_ref()
            .map_or(&[][..], |table| &table.backlash_um);
        print_left(file.axes[*axis].letter, um, fields, out);
    }
    let text = sections.trim_end();
    out.tell(
        text,
        || json!({"kind": "lines", "readings": readings.len(), "text": text}),
    );
    let panels: Vec<Panel> = panels
        .into_iter()
        .map(|(axis, fields)| Panel {
            letter: char::from(file.axes[axis].letter),
            value_um: f64::from(file.axes[axis].backlash_steps) * step_nm[axis] / 1e3,
            fields,
        })
        .collect();
    Ok(Calibrated {
        page: backlash::html(&file.title, readings.len(), args.file.is_none(), &panels),
        machine: with_sections(&file.text, &sections),
    })
}

/// The pairs of lines, from the file of readings or cut on the simulated machine.
fn pairs(
    args: &BacklashArgs,
    file: &MachineFile,
    now: &[Map; AXES],
    travel_mm: [[f64; 2]; 2],
) -> Result<Vec<LinePair>, String> {
    let Some(path) = &args.file else {
        return simulated_pairs(args, file, now, travel_mm);
    };
    let readings = readings::read(path)?;
    for reading in &readings {
        reading
            .within(travel_mm)
            .map_err(|why| format!("{path}: {why}"))?;
    }
    Ok(readings)
}

/// Prints the remaining backlash of an axis, with one value and with its map.
fn print_left(letter: u8, um: &[f64], [before, after]: &[Field; 2], out: &mut Reporter<'_>) {
    let low = um.iter().copied().fold(f64::MAX, f64::min);
    let high = um.iter().copied().fold(f64::MIN, f64::max);
    let ([one_low, one_high], [low_left, high_left]) = (before.span_um, after.span_um);
    let (letter, count) = (char::from(letter), um.len());
    let positions = counted(count, "position");
    out.tell(
        format_args!(
            "# {letter}: {positions}, backlash {low:.1} to {high:.1} um; left with one value \
             {one_low:+.1} to {one_high:+.1} um, with this map {low_left:+.2} to {high_left:+.2} um"
        ),
        || {
            json!({
                "kind": "axis",
                "axis": letter,
                "positions": count,
                "backlash_um": [low, high],
                "left_with_one_value_um": before.span_um,
                "left_with_map_um": after.span_um,
            })
        },
    );
}

/// Travel of X and Y in mm.
fn travel(file: &MachineFile) -> Result<[[f64; 2]; 2], String> {
    let mut travel_mm = [[0.0; 2]; 2];
    for (travel_mm, axis) in travel_mm.iter_mut().zip(&file.axes) {
        let Travel::Range(range) = axis.travel else {
            let letter = char::from(axis.letter);
            return Err(format!(
                "{}: the travel of {letter} must be known",
                file.path
            ));
        };
        *travel_mm = range.map(|nm| nm as f64 / 1e6);
    }
    Ok(travel_mm)
}

/// Runs the two-line test all over the work area of the simulated machine.
fn simulated_pairs(
    args: &BacklashArgs,
    file: &MachineFile,
    maps: &[Map; AXES],
    travel_mm: [[f64; 2]; 2],
) -> Result<Vec<LinePair>, String> {
    let every = match quantity::parse(&args.every) {
        Ok(Quantity::Length(length)) if length.num >= 100_000 => {
            length.num as f64 / length.den as f64 / 1e6
        }
        Ok(_) => return Err("--every: expected a length of at least 0.1 mm".into()),
        Err(why) => return Err(format!("--every: {why}")),
    };
    let run_up_mm = if args.uncompensated {
        WHOLE_RUN_UP_MM
    } else {
        RUN_UP_MM
    };
    let mut bench = SimulatedBench::new(file, maps.clone())?;
    cut_all(&mut bench, every, travel_mm, run_up_mm)
}

fn surveyed(
    before: [Leftover; 2],
    after: [Leftover; 2],
    travel_mm: [[f64; 2]; 2],
) -> Vec<(usize, [Field; 2])> {
    let pairs = before.into_iter().zip(after);
    let pairs =
        pairs.map(|(before, after)| [before, after].map(|left| Field::surveyed(left, travel_mm)));
    pairs.enumerate().collect()
}

/// The text of a machine file with these sections instead of its own.
fn with_sections(text: &str, sections: &str) -> String {
    let mut kept = String::new();
    let mut is_backlash = false;
    for line in text.lines() {
        if line.trim_start().starts_with('[') && !line.trim_start().starts_with("[[") {
            // The next line of a list of lists may also begin with `[`, but no name follows there.
            let name = line.trim_start().trim_start_matches('[');
            if name.starts_with(|letter: char| letter.is_ascii_alphabetic()) {
                is_backlash =
                    name.starts_with("backlash_map.") || name.starts_with("backlash_map]");
            }
        }
        if !is_backlash {
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
    fn a_map_replaces_the_one_before() {
        let text = "a = 1\n[backlash_map.x]\num = [\n    [1, 2],\n]\n\n[idle]\npolicy \
             = \"off\"\n[backlash_map.y]\num = [3]\n";
        let made = with_sections(text, "[backlash_map.x]\num = [9]\n");
        assert_eq!(
            made,
            "a = 1\n[idle]\npolicy = \"off\"\n\n[backlash_map.x]\num = [9]\n"
        );
        assert_eq!(with_sections(&made, "[backlash_map.x]\num = [9]\n"), made);
    }
}
