//! `husillo holes`.

use super::job::{displayed, whole};
use super::reporting::{self, MOST_PRINTED, verdict, with_some_findings};
use super::{ERRORS, Failure, OK, write};
use crate::cli::{DrillOrder, DrillOutput, Holes, Output};
use crate::console;
use crate::holes;
use crate::holes::drill_records::Refusal;
use crate::holes::made::Maker;
use husillo_holes::Metric;
use std::io::{self, IsTerminal, Write};

/// Reads a drill file, and writes its holes in the form that is asked for.
pub fn list_holes(args: &Holes) -> Result<u8, Failure> {
    let options = holes::Options::new(&args.layout)?;
    let maker = Maker::new(args)?;
    expect_no_terminal(args)?;
    // A list has the findings in it. Other forms may not be written for them.
    let printed = match args.make {
        DrillOutput::List => args.format,
        DrillOutput::Gcode | DrillOutput::Drill => Output::Text,
    };
    let name = displayed(&args.file);
    let text = whole(&args.file)?;
    let (mut board, findings) = with_some_findings(MOST_PRINTED, printed, |findings| {
        Ok(holes::read(&text, name, &options, findings))
    })?;
    let (errors, warnings) = (findings.errors, findings.warnings);
    if errors > 0 && args.make != DrillOutput::List {
        eprintln!("{name}: {}; nothing written", verdict(errors, warnings));
        return Ok(ERRORS);
    }
    if let Some(fit) = holes::apply(&mut board, &options)? {
        eprintln!("{name}: {fit}");
    }
    if args.layout.order == DrillOrder::Shortest {
        board.sort_shortest(Metric::Straight);
    }
    // Everything is computed before the file is written.
    let made = match maker.make(&board, name, &findings) {
        Ok(made) => made,
        Err(Refusal::Usage(message)) => return Err(Failure::Usage(message)),
        Err(Refusal::Finding(finding)) => {
            reporting::print(&[*finding])?;
            return Ok(ERRORS);
        }
    };
    match args.output.as_deref().unwrap_or("-") {
        // A list is text or one line of JSON; the other forms are bytes for a machine.
        "-" if args.make == DrillOutput::List => console::stdout().write_all(&made)?,
        path => write(path, &made)?,
    }
    if errors > 0 {
        eprintln!("{name}: {}", verdict(errors, warnings));
        return Ok(ERRORS);
    }
    Ok(OK)
}

fn expect_no_terminal(args: &Holes) -> Result<(), Failure> {
    let is_bytes = args.make == DrillOutput::Drill && args.format == Output::Text;
    let to_file = args.output.as_ref().is_some_and(|path| path != "-");
    if is_bytes && !to_file && io::stdout().is_terminal() {
        let message = "records are bytes and not for a terminal: see -o and --format json";
        return Err(Failure::Usage(message.into()));
    }
    Ok(())
}
