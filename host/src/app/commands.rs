//! `husillo commands`.

use super::job::Job;
use super::reporting::with_some_findings;
use super::{ERRORS, Failure, OK, drilling};
use crate::cli::{Commands, Listing, Output};
use crate::console;
use husillo_simulator::text::json::write_found;
use serde_json::json;
use std::io::{BufWriter, Write};

/// Prints the commands of a program.
pub fn print_commands(args: &Commands) -> Result<u8, Failure> {
    if args.file.to_ascii_lowercase().ends_with(".cod") {
        return drilling::list(&args.file, args.format);
    }
    if args.format == Listing::Gcode {
        let message = "--format gcode is for records of the drill, *.cod";
        return Err(Failure::Usage(message.into()));
    }
    let mut job = Job::new(&args.file, &args.target, "free")?;
    job.place(args.place.zero)?;
    let mut out = BufWriter::with_capacity(1 << 18, console::stdout());
    let json = args.format == Listing::Json;
    let format = if json { Output::Json } else { Output::Text };
    let ((), findings) = with_some_findings(args.limit, format, |findings| {
        job.write_commands(json, findings, &mut out)?;
        Ok(out.flush()?)
    })?;
    if json {
        let body = json!({
            "kind": "findings",
            "errors": findings.errors,
            "warnings": findings.warnings,
        });
        write_found(
            "husillo.commands/1",
            &body,
            &findings,
            &mut console::stdout(),
        )?;
    }
    Ok(if findings.errors > 0 { ERRORS } else { OK })
}
