//! The tables of `husillo compare` as text.

use husillo_methods::trial::{Speed, WINDOWS};
use husillo_methods::{CRITERIA, Comparison, Row};
use std::io::{self, Write};

/// The ratings by the builders of the micro mill.
pub const ORIGINAL: &str = "The builders of the micro mill used the same weights with their own \
     criteria. They gave direct search 90.5, DDA 84.4 and the staircase 72.1 points: see `husillo \
     reproduce micromill 9`.";

/// Prints everything.
///
/// # Errors
///
/// Writing fails.
pub fn print(of: &Comparison, out: &mut impl Write) -> io::Result<()> {
    writeln!(out, "{}", of.title)?;
    for shape in ["line", "arc"] {
        let rows: Vec<&Row> = of.rows.iter().filter(|row| row.shape == shape).collect();
        if rows.is_empty() {
            continue;
        }
        figures(&rows, shape, out)?;
        speeds(
            &rows,
            "equal time for every pass",
            |row| Some(&row.equal_time),
            out,
        )?;
        speeds(
            &rows,
            "vector feed, every event takes the time of its path",
            |row| row.vector_feed.as_ref(),
            out,
        )?;
        matrix(of, &rows, out)?;
    }
    for note in &of.notes {
        writeln!(out, "\nnote: {note}")?;
    }
    Ok(())
}

fn figures(rows: &[&Row], shape: &str, out: &mut impl Write) -> io::Result<()> {
    let moves = rows.first().map_or(0, |row| row.moves);
    let name = match moves {
        1 => shape.to_owned(),
        _ => format!("{moves} {shape}s"),
    };
    writeln!(
        out,
        "\n{name:<22} {:>10} {:>10}   {:>13} {:>9}   {:>9} {:>13}",
        "iterations", "moving", "largest error", "RMS", "add, test", "M0, M4F, RV"
    )?;
    for row in rows {
        writeln!(
            out,
            "{:<22} {:>10} {:>10}   {:>9.3} BLU {:>5.3} BLU   {:>9} {:>13}",
            row.method,
            row.iterations,
            row.moving,
            row.max_error_blu,
            row.rms_error_blu,
            format!("{}, {}", row.additions, row.tests),
            instructions(row)
        )?;
    }
    Ok(())
}

/// Instructions per event on all processors.
pub fn instructions(row: &Row) -> String {
    let of = &row.instructions;
    [of.cortex_m0, of.cortex_m4f, of.riscv]
        .map(|count| count.map_or("-".to_owned(), |count| format!("{count:.0}")))
        .join(", ")
}

fn speeds(
    rows: &[&Row],
    title: &str,
    speed: fn(&Row) -> Option<&Speed>,
    out: &mut impl Write,
) -> io::Result<()> {
    if rows.iter().all(|row| speed(row).is_none()) {
        return Ok(());
    }
    writeln!(
        out,
        "\n{title}: speed per programmed feed, ripple in % over windows of events"
    )?;
    write!(out, "{:<22} {:>6}", "", "mean")?;
    for events in WINDOWS {
        write!(out, " {events:>13}")?;
    }
    writeln!(out)?;
    for (row, speed) in rows.iter().filter_map(|row| Some((row, speed(row)?))) {
        write!(out, "{:<22} {:>6.3}", row.method, speed.mean_speed)?;
        for ripple in &speed.ripple_percent_windows {
            write!(
                out,
                " {:>13}",
                format!("{:+.1} {:+.1}", ripple.low, ripple.high)
            )?;
        }
        writeln!(out)?;
    }
    Ok(())
}

fn matrix(of: &Comparison, rows: &[&Row], out: &mut impl Write) -> io::Result<()> {
    write!(out, "\n{:<22}", "decision matrix")?;
    for name in CRITERIA {
        write!(out, " {name:>10}")?;
    }
    write!(out, " {:>10}\n{:<22}", "total", "weight")?;
    for weight in of.weights.0 {
        write!(out, " {weight:>10}")?;
    }
    writeln!(out)?;
    for row in rows {
        write!(out, "{:<22}", row.method)?;
        for points in row.points.values() {
            write!(out, " {points:>10.1}")?;
        }
        writeln!(out, " {:>10.1}", row.points.total)?;
    }
    if rows.iter().any(|row| row.shape == "arc") {
        writeln!(out, "{ORIGINAL}")?;
    }
    Ok(())
}
