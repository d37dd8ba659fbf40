//! `husillo steps`.

use super::reporting::{verdict, with_some_findings};
use super::{ERRORS, Failure, OK, choice};
use crate::cli::{Output, Steps};
use crate::output::Outputs;
use crate::programs::{setup, steps};
use std::io::Write;

/// Writes the step events of a program.
pub fn write_steps(args: &Steps) -> Result<u8, Failure> {
    let mut job = choice::job(&args.file, &args.target, args.place.zero, args.limit)?;
    let (_, findings) =
        with_some_findings(args.limit, Output::Text, |findings| job.check(findings))?;
    if findings.errors > 0 {
        eprintln!(
            "{}: {}; nothing moves",
            job.name(),
            verdict(findings.errors, findings.warnings)
        );
        return Ok(ERRORS);
    }
    let mut source = job.open()?;
    let mut machine = job.new_machine(!args.no_compensation)?;
    let motors = args
        .levels
        .then(|| setup::motors(&job.machine))
        .transpose()?;
    let mut outputs = Outputs::new();
    let mut out = outputs.create(&args.output)?;
    let count = steps::write(&mut source, &mut machine, &job.piece(), motors, &mut out)?;
    out.flush()?;
    outputs.finish()?;
    if args.output != "-" {
        eprintln!("{}: {count} step events", args.output);
    }
    Ok(OK)
}
