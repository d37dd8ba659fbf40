//! `husillo check`.

use super::job::{Job, displayed, load, whole};
use super::reporting::{left_out, verdict};
use super::{ERRORS, Failure, OK};
use crate::cli::Check;
use crate::console;
use crate::console::shown;
use crate::holes;
use husillo_simulator::diagnostics::{Findings, Format};
use husillo_simulator::text::json::write_found;
use serde_json::json;
use std::io::{self, BufWriter, Write};

/// Checks programs and drill files, and prints the findings.
pub fn check_files(args: &Check) -> Result<u8, Failure> {
    let mut code = OK;
    for file in &args.files {
        let mut findings = Findings::new(args.limit);
        let checked = check_file(args, file, &mut findings);
        print_checked(args, file, &findings, checked.is_ok())?;
        checked?;
        if findings.errors > 0 || (args.deny_warnings && findings.warnings > 0) {
            code = ERRORS;
        }
    }
    Ok(code)
}

/// Checks a program or a drill file. Returns the findings.
fn check_file(args: &Check, file: &str, findings: &mut Findings) -> Result<(), Failure> {
    if holes::is_drill_file(args.target.dialect.as_deref(), file) {
        let name = displayed(file);
        let board = holes::read(&whole(file)?, name, &holes::Options::default(), findings);
        if let Some(machine) = &args.target.machine {
            holes::check_travel(&board, name, &load(machine)?, findings);
        }
    } else {
        let mut job = Job::new(file, &args.target, "free")?;
        job.place(args.place.zero)?;
        job.check(findings)?;
    }
    Ok(())
}

/// Prints the findings and, as text, the verdict about a file that was checked to its end.
fn print_checked(args: &Check, file: &str, findings: &Findings, is_whole: bool) -> io::Result<()> {
    let stdout = io::stdout();
    let is_coloured = console::is_coloured(&stdout);
    let Some(format) = args.format.of_finding() else {
        let body = json!({
            "file": displayed(file),
            "errors": findings.errors,
            "warnings": findings.warnings,
        });
        return write_found("husillo.check/1", &body, findings, &mut console::stdout());
    };
    let mut out = BufWriter::new(stdout.lock());
    findings.print(format, is_coloured, &mut out)?;
    if is_whole && format == Format::Text {
        if let Some(left_out) = left_out(findings) {
            writeln!(out, "{left_out}\n")?;
        }
        let verdict = verdict(findings.errors, findings.warnings);
        writeln!(out, "{}: {verdict}", shown(displayed(file)))?;
    }
    out.flush()
}
