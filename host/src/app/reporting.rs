//! Prints findings to standard error, and counts them.

use super::Failure;
use crate::cli::Output;
use crate::console::is_coloured;
use husillo_sim::text::counted;
use husillo_simulator::diagnostics::{Finding, Findings, Format};
use std::io;

/// Number of findings of a file that are printed, without an option.
pub const MOST_PRINTED: u64 = 50;

/// Calls `make`, and prints its findings to standard error, even if it fails.
pub fn with_findings<T>(
    make: impl FnOnce(&mut Findings) -> Result<T, Failure>,
) -> Result<(T, Findings), Failure> {
    with_some_findings(MOST_PRINTED, Output::Text, make)
}

/// The same for at most `limit` findings. Those of JSON are printed in its object.
pub fn with_some_findings<T>(
    limit: u64,
    format: Output,
    make: impl FnOnce(&mut Findings) -> Result<T, Failure>,
) -> Result<(T, Findings), Failure> {
    let mut findings = Findings::new(limit);
    let made = make(&mut findings);
    // The object of a command that fails is not printed.
    if format == Output::Json && made.is_ok() {
        return Ok((made?, findings));
    }
    let is_coloured = is_coloured(&io::stderr());
    findings.print(Format::Text, is_coloured, &mut io::stderr())?;
    if let Some(left_out) = left_out(&findings) {
        eprintln!("{left_out}\n");
    }
    Ok((made?, findings))
}

/// Prints findings to standard error.
pub fn print(found: &[Finding]) -> io::Result<()> {
    let is_coloured = is_coloured(&io::stderr());
    let mut printed = found.iter().take(MOST_PRINTED as usize);
    printed.try_for_each(|finding| finding.print(Format::Text, is_coloured, &mut io::stderr()))
}

/// How many findings are not printed, if there are any.
pub fn left_out(findings: &Findings) -> Option<String> {
    let hidden = findings.hidden();
    (hidden > 0).then(|| format!("{} not printed: see --limit", count(hidden, "finding")))
}

/// A number of things: no errors, 1 error, 2,000 errors.
pub fn count(number: u64, name: &str) -> String {
    match number {
        0 => format!("no {name}s"),
        _ => counted(number, name),
    }
}

/// The numbers of errors and warnings.
pub fn verdict(errors: u64, warnings: u64) -> String {
    format!("{}, {}", count(errors, "error"), count(warnings, "warning"))
}
