//! `husillo reproduce`.

use super::{Failure, OK};
use crate::cli::{Page, Reproduce};
use crate::console;
use crate::output::Outputs;
use crate::reproducing;
use husillo_reports::originals;
use husillo_simulator::text::json::write_line;
use std::io::Write;

/// Prints the tables of an original, or writes them.
pub fn reproduce(args: &Reproduce) -> Result<u8, Failure> {
    let rebuilt = reproducing::rebuild(args.machine, args.table.as_deref())?;
    let format = args.format.unwrap_or(match &args.output {
        Some(path) if path.ends_with(".html") => Page::Html,
        Some(path) if path.ends_with(".json") => Page::Json,
        _ => Page::Text,
    });
    let made = match format {
        Page::Text => originals::text(&rebuilt),
        Page::Json => {
            let mut line = Vec::new();
            write_line("husillo.reproduce/1", &rebuilt, &mut line)?;
            String::from_utf8_lossy(&line).into_owned()
        }
        Page::Html => originals::html(&rebuilt),
    };
    let Some(path) = &args.output else {
        console::stdout().write_all(made.as_bytes())?;
        return Ok(OK);
    };
    let mut outputs = Outputs::new();
    outputs.write(path, made.as_bytes())?;
    outputs.finish()?;
    eprintln!("{path}: {}", originals::verdict(&rebuilt));
    Ok(OK)
}
