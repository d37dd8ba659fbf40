//! Reads and writes `[axis.x.calibration]` and `[squareness]` of a machine file.

use husillo_backlash::{ErrorTable, Knot, Squareness};
use husillo_metrology::Scale;
use husillo_metrology::quantity::{self, Quantity};
use husillo_simulator::machines::table::Table;
use std::fmt::Write;

const RATIO: &str = "as in \"50 um/m\", at most 10000 um/m";
const ENTRY: &str = "expected [\"-200 mm\", \"0.3 um\", \"-0.1 um\"]: the reading, and its \
     correction after a move in the positive and in the negative direction";

/// Reads `calibration` of an axis. An axis without it has no errors.
pub fn read_axis(table: &mut Table<'_, '_>, scale: Scale) -> ErrorTable<Vec<Knot>> {
    let span = table.value("calibration").map(|(_, span)| span);
    let errors = table.optional_table("calibration", |table| {
        let scale_ppb = ratio(table, "scale");
        let knots = match table.value("table") {
            None => Some(Vec::new()),
            Some((value, span)) => {
                let entries = value.as_array().and_then(|entries| {
                    entries
                        .iter()
                        .map(|entry| knot(entry.get_ref(), scale))
                        .collect::<Option<Vec<Knot>>>()
                });
                if entries.is_none() {
                    table.wrong(span, "`table` is not understood", ENTRY);
                }
                entries
            }
        };
        (scale_ppb, knots)
    });
    let Some((scale_ppb, Some(knots))) = errors else {
        return ErrorTable::default();
    };
    let span = span.unwrap_or_default();
    if scale.unit() != "mm" {
        let why = "a calibration needs a `count`";
        table.wrong(span, why, "the file does not give the length of a count");
        return ErrorTable::default();
    }
    ErrorTable::new(scale_ppb, knots).unwrap_or_else(|error| {
        let label = "entries are counted from 0";
        table.wrong(span, &format!("the calibration is invalid: {error}"), label);
        ErrorTable::default()
    })
}

/// Reads `[squareness]` of a machine with these axes.
pub fn read_squareness(table: &mut Table<'_, '_>, axes: &str) -> Squareness {
    let squareness = table.optional_table("squareness", |table| {
        let mut of = |key: &'static str| {
            let lean = ratio(table, key);
            let is_there = key
                .to_ascii_uppercase()
                .chars()
                .all(|axis| axes.contains(axis));
            if let (true, Some((_, span))) = (lean != 0 && !is_there, table.value(key)) {
                let message = format!("`{key}`: the machine does not have both axes");
                table.wrong(span, &message, &format!("it has {axes}"));
            }
            lean
        };
        Squareness {
            xy_ppb: of("xy"),
            xz_ppb: of("xz"),
            yz_ppb: of("yz"),
        }
    });
    squareness.unwrap_or_default()
}

/// Reads a ratio, in parts per 10^9. A missing one is 0.
fn ratio(table: &mut Table<'_, '_>, key: &'static str) -> i32 {
    let ratio = table.quantity(key, RATIO, |quantity| match quantity {
        Quantity::Ratio(ratio) => i32::try_from(ratio.rounded()).ok(),
        _ => None,
    });
    ratio.unwrap_or_default()
}

/// Reads `["-200 mm", "0.3 um", "-0.1 um"]`.
fn knot(entry: &toml::de::DeValue<'_>, scale: Scale) -> Option<Knot> {
    let length = |text: &str| scale.amount(quantity::parse(text).ok()?);
    let lengths = entry.as_array()?.iter();
    let lengths = lengths.map(|text| length(text.get_ref().as_str()?));
    match *lengths.collect::<Option<Vec<i64>>>()? {
        [reading_nm, positive, negative] => Some(Knot {
            reading_nm,
            positive_nm: i32::try_from(positive).ok()?,
            negative_nm: i32::try_from(negative).ok()?,
        }),
        _ => None,
    }
}

/// The lines of `calibration` of an axis.
pub fn axis_lines(letter: char, table: &ErrorTable<Vec<Knot>>) -> String {
    let mut text = format!(
        "[axis.{}.calibration]\nscale = \"{}\"\n",
        letter.to_ascii_lowercase(),
        per_metre(table.scale_ppb())
    );
    if !table.knots().is_empty() {
        text += "table = [ # reading, correction after a positive and after a negative move\n";
        for knot in table.knots() {
            // Writing to a string cannot fail.
            let _ = writeln!(
                text,
                "  [\"{} mm\", \"{} um\", \"{} um\"],",
                knot.reading_nm as f64 / 1e6,
                f64::from(knot.positive_nm) / 1e3,
                f64::from(knot.negative_nm) / 1e3
            );
        }
        text += "]\n";
    }
    text
}

/// The lines of `[squareness]`.
pub fn squareness_lines(squareness: &Squareness) -> String {
    format!(
        "[squareness]\nxy = \"{}\"\nxz = \"{}\"\nyz = \"{}\"\n",
        per_metre(squareness.xy_ppb),
        per_metre(squareness.xz_ppb),
        per_metre(squareness.yz_ppb)
    )
}

fn per_metre(ppb: i32) -> String {
    format!("{} um/m", f64::from(ppb) / 1e3)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measuring::machine_file;

    #[test]
    fn written_calibration_reads_back_unchanged() {
        let knot = |reading_nm, positive_nm, negative_nm| Knot {
            reading_nm,
            positive_nm,
            negative_nm,
        };
        let knots = vec![knot(-200_000_000, 312, -98), knot(3_333_700, 0, 7)];
        let table = ErrorTable::new(-50_123, knots).unwrap();
        let squareness = Squareness {
            xy_ppb: 100_001,
            xz_ppb: -3,
            yz_ppb: 0,
        };
        let text = include_str!("../../machines/cmm3.toml").to_owned()
            + &axis_lines('Y', &table)
            + &squareness_lines(&squareness);
        let machine = machine_file::parse("mine.toml", &text).unwrap();
        assert_eq!(machine.errors.axes[1], table);
        assert_eq!(machine.errors.squareness, squareness);
        assert_eq!(machine.errors.axes[0], ErrorTable::default());
    }
}
