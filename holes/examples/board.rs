//! Reads a drill file, puts its holes in a short order, and prints a G-code program.
//!
//! ```sh
//! cargo run -p husillo-holes --example board -- examples/board.drl
//! ```

use husillo_holes::{Metric, Placement, Remark, Setup, Shift, SlotHandling, Work, read};

/// What is read without an argument: four holes of one tool, not in order.
const BOARD: &[u8] =
    b"M48\nMETRIC,TZ\nT1C0.8\n%\nT1\nX5.0Y1.0\nX30.0Y20.0\nX5.5Y1.0\nX29.0Y20.0\nM30\n";

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let text = match std::env::args().nth(1) {
        Some(path) => std::fs::read(path)?,
        None => BOARD.to_vec(),
    };
    let mut errors = 0;
    let mut board = read(&text, &Setup::default(), |remark| {
        errors += usize::from(remark.is_error());
        match remark {
            Remark::Error(line, _, error) => eprintln!("line {line}: {error}"),
            Remark::Warning(line, _, warning) => eprintln!("line {line}: {warning}"),
            other => eprintln!("{other:?}"),
        }
    });
    if errors > 0 {
        return Err(format!("{errors} lines with errors").into());
    }
    let placement = Placement {
        shift: Some(Shift::Corner),
        ..Placement::default()
    };
    placement.apply(&mut board)?;
    let before = board.travel_nm(Metric::Straight);
    board.sort_shortest(Metric::Straight);
    let after = board.travel_nm(Metric::Straight);
    eprintln!(
        "{:.1} mm between holes, {:.1} mm as in the file",
        after / 1e6,
        before / 1e6
    );
    let work = Work {
        slots: SlotHandling::Rout,
        ..Work::to_depth(1_800_000)
    };
    work.check(&board)?;
    work.write(&board, "board", &mut std::io::stdout().lock())?;
    Ok(())
}
