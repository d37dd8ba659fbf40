//! Prints findings to standard error, and counts them.

use super::Failure;
use crate::diagnostics::{Finding, Findings, Format};
use std::io::{self, IsTerminal};

/// Number of findings of a file that are printed, without an option.
const MOST_PRINTED: u64 = 50;

/// Calls `make`, and prints its findings to standard error, even if it fails.
pub fn with_findings<T>(
    make: impl FnOnce(&mut Findings) -> Result<T, Failure>,
) -> Result<(T, Findings), Failure> {
    let mut findings = Findings::new(MOST_PRINTED);
    let made = make(&mut findings);
    let is_coloured = colour(io::stderr().is_terminal());
    findings.print(Format::Text, is_coloured, &mut io::stderr())?;
    Ok((made?, findings))
}

/// Prints findings to standard error.
pub fn print(found: &[Finding]) -> io::Result<()> {
    let is_coloured = colour(io::stderr().is_terminal());
    let mut printed = found.iter().take(MOST_PRINTED as usize);
    printed.try_for_each(|finding| finding.print(Format::Text, is_coloured, &mut io::stderr()))
}

/// Whether output is coloured, to a terminal or not.
pub fn colour(is_terminal: bool) -> bool {
    is_terminal && std::env::var_os("NO_COLOR").is_none()
}

/// The numbers of errors and warnings.
pub fn verdict(errors: u64, warnings: u64) -> String {
    let count = |number: u64, name: &str| match number {
        0 => format!("no {name}s"),
        1 => format!("1 {name}"),
        _ => format!("{number} {name}s"),
    };
    format!("{}, {}", count(errors, "error"), count(warnings, "warning"))
}
