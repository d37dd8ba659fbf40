//! Rebuilt tables as text.

use super::Rebuilt;
use husillo_metrology::originals::{Row, Table};
use std::fmt::Write;

/// Widest line of notes.
const WIDTH: usize = 100;

/// The tables, their parameters, and the part that stays unexplained.
pub fn text(rebuilt: &Rebuilt) -> String {
    let mut text = String::new();
    for (index, table) in rebuilt.tables.iter().enumerate() {
        if index > 0 {
            text.push('\n');
        }
        // Writing to a String cannot fail.
        let _ = write(&mut text, rebuilt.machine, table);
    }
    text
}

/// One line about all tables.
pub fn verdict(rebuilt: &Rebuilt) -> String {
    let counts = rebuilt.tables.iter().map(Table::counts);
    let [all, within] = counts.fold([0; 2], |sum, one| [sum[0] + one[0], sum[1] + one[1]]);
    let tables = match rebuilt.tables.len() {
        1 => "1 table".to_owned(),
        count => format!("{count} tables"),
    };
    format!("{tables}, {within} of {all} rebuilt values within their spread")
}

fn write(text: &mut String, machine: &str, table: &Table) -> std::fmt::Result {
    let name = |row: &Row| row.name.chars().count();
    let width = table.rows.iter().map(name).max().unwrap_or(0).max(8);
    writeln!(text, "{machine}, table {}: {}\n", table.number, table.title)?;
    writeln!(
        text,
        "{:width$}  unit    measured   rebuilt  unexplained   spread     today",
        ""
    )?;
    for row in &table.rows {
        let value = |value: Option<f64>| value.map_or_else(|| "-".to_owned(), |v| figure(row, v));
        let mark = if row.is_within() == Some(false) {
            " *"
        } else {
            ""
        };
        writeln!(
            text,
            "{:width$}  {:6} {:>9} {:>9} {:>12} {:>8} {:>9}{mark}",
            row.name,
            row.unit,
            figure(row, row.measured),
            value(row.rebuilt),
            value(row.unexplained()),
            figure(row, row.spread),
            value(row.today),
        )?;
    }
    text.push('\n');
    for line in summary(table) {
        wrap(text, "", &line);
    }
    wrap(text, "", &format!("Spread: {}.", table.spread));
    for parameter in &table.parameters {
        let line = format!(
            "{}: {} ({})",
            parameter.name, parameter.value, parameter.source
        );
        wrap(text, "- ", &line);
    }
    for note in &table.notes {
        wrap(text, "", note);
    }
    Ok(())
}

/// Sentences about a table: how many rows are within their spread, how much stays unexplained, and
/// what today's compensation improves.
pub fn summary(table: &Table) -> Vec<String> {
    let mut lines = Vec::new();
    let [all, within] = table.counts();
    let data = table.rows.len() - all;
    let mut line = format!("{within} of {all} rebuilt values are within their spread.");
    if data > 0 {
        let _ = write!(line, " {data} values have no model or are its start.");
    }
    let mut units: Vec<&str> = table.rows.iter().map(|row| row.unit).collect();
    units.dedup();
    units.sort_unstable();
    units.dedup();
    let rms = units.iter().filter_map(|unit| {
        let example = table.rows.iter().find(|row| row.unit == *unit)?;
        Some(format!("{} {unit}", figure(example, table.rms(unit)?)))
    });
    let rms: Vec<String> = rms.collect();
    if !rms.is_empty() {
        let _ = write!(line, " Left unexplained (RMS): {}.", rms.join(", "));
    }
    lines.push(line);
    let outside = table
        .rows
        .iter()
        .filter(|row| row.is_within() == Some(false));
    let outside: Vec<&str> = outside.map(|row| row.name.as_str()).collect();
    if !outside.is_empty() {
        lines.push(format!("Outside (*): {}.", outside.join("; ")));
    }
    for unit in units {
        if let Some([measured, rebuilt, today]) = table.gain(unit) {
            let example = table.rows.iter().find(|row| row.unit == unit);
            let [measured, rebuilt, today] = [measured, rebuilt, today]
                .map(|value| example.map_or_else(String::new, |row| figure(row, value)));
            lines.push(format!(
                "Largest deviation from the programmed value: {measured} {unit} measured, \
                 {rebuilt} {unit} rebuilt, {today} {unit} today."
            ));
        }
    }
    lines
}

/// A value with the decimals of its unit.
pub fn figure(row: &Row, value: f64) -> String {
    let decimals = match row.unit {
        "mm" => 3,
        "um" | "us" | "points" | "min" | "s" | "C" | "counts" => 1,
        "A" => 3,
        "Hz" | "X/Z" => 2,
        _ => 0,
    };
    let text = format!("{value:.decimals$}");
    let is_zero = text.chars().all(|c| matches!(c, '-' | '0' | '.'));
    text.trim_start_matches(if is_zero { '-' } else { '\0' })
        .to_owned()
}

/// Adds a paragraph in lines of at most [`WIDTH`] characters.
fn wrap(text: &mut String, mark: &str, paragraph: &str) {
    let mut column = mark.len();
    text.push_str(mark);
    let mut is_first = true;
    for word in paragraph.split_whitespace() {
        let length = word.chars().count();
        if !is_first && column + 1 + length > WIDTH {
            let _ = write!(text, "\n{:width$}", "", width = mark.len());
            column = mark.len();
            is_first = true;
        }
        if !is_first {
            text.push(' ');
            column += 1;
        }
        text.push_str(word);
        column += length;
        is_first = false;
    }
    text.push('\n');
}
