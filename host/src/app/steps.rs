//! `husillo steps`.

use super::job::Job;
use super::reporting::{verdict, with_some_findings};
use super::{ERRORS, Failure, OK, choice, count, own_output};
use crate::cli::{Output, Steps};
use crate::console;
use crate::output::Outputs;
use husillo_simulator::text::json::write_found;
use serde_json::json;
use std::io::Write;

/// Writes the step events of a program.
pub fn write_steps(args: &Steps) -> Result<u8, Failure> {
    let path = own_output(Some(&args.output), args.format)?;
    let mut job = choice::job(&args.file, &args.target, args.place.zero, args.limit)?;
    let (_, findings) =
        with_some_findings(args.limit, args.format, |findings| job.check(findings))?;
    let print = |job: &Job, steps: Option<u64>| {
        let body = json!({
            "file": job.name(),
            "machine": job.machine.name,
            "output": steps.map(|_| path),
            "step_events": steps,
            "errors": findings.errors,
            "warnings": findings.warnings,
        });
        write_found("husillo.steps/1", &body, &findings, &mut console::stdout())
    };
    if findings.errors > 0 {
        if args.format == Output::Json {
            print(&job, None)?;
            return Ok(ERRORS);
        }
        eprintln!(
            "{}: {}; nothing moves",
            job.name(),
            verdict(findings.errors, findings.warnings)
        );
        choice::suggest(&job, &args.target, args.place.zero, &findings)?;
        return Ok(ERRORS);
    }
    let mut outputs = Outputs::new();
    let mut out = outputs.create(path)?;
    let steps = job.write_steps(!args.no_compensation, args.levels, &mut out)?;
    out.flush()?;
    outputs.finish()?;
    if args.format == Output::Json {
        print(&job, Some(steps))?;
    } else if path != "-" {
        eprintln!("{path}: {}", count(steps, "step event"));
    }
    Ok(OK)
}
