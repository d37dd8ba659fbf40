//! The table of `husillo compare motion` as text.

use super::{MEANING, Motion, TITLES};
use std::io::{self, Write};

/// Prints everything.
///
/// # Errors
///
/// Writing fails.
pub fn print(of: &Motion, out: &mut impl Write) -> io::Result<()> {
    let rows: Vec<[String; 10]> = of.rows().collect();
    writeln!(out, "{}\n", of.title)?;
    let width = |column: usize| {
        let cells = rows.iter().map(|row| row[column].chars().count());
        cells.max().unwrap_or(0).max(TITLES[column].len())
    };
    let widths: Vec<usize> = (0..TITLES.len()).map(width).collect();
    let mut line = |cells: &[String]| {
        let mut text = String::new();
        for (column, (cell, width)) in cells.iter().zip(&widths).enumerate() {
            let gap = if column == 0 { "" } else { "  " };
            text += &if column == 0 {
                format!("{gap}{cell:<width$}")
            } else {
                format!("{gap}{cell:>width$}")
            };
        }
        writeln!(out, "{}", text.trim_end())
    };
    line(&TITLES.map(str::to_owned))?;
    for row in &rows {
        line(row)?;
    }
    writeln!(out)?;
    for text in MEANING
        .iter()
        .copied()
        .chain(of.notes.iter().map(String::as_str))
    {
        writeln!(out, "{text}")?;
    }
    Ok(())
}
