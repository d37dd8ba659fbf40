//! Findings printed to standard error, and how they are summed up.

use super::Failure;
use crate::diagnostics::{Finding, Findings, Format};
use std::io::{self, IsTerminal};

/// Findings of a file that are printed, where no option says otherwise.
const MOST_PRINTED: u64 = 50;

/// Makes something, and prints to standard error what was found on the way, also where it fails.
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

/// Whether what goes to a terminal, or not to one, is coloured.
pub fn colour(is_terminal: bool) -> bool {
    is_terminal && std::env::var_os("NO_COLOR").is_none()
}

/// How many errors and warnings there are.
pub fn verdict(errors: u64, warnings: u64) -> String {
    let count = |number: u64, name: &str| match number {
        0 => format!("no {name}s"),
        1 => format!("1 {name}"),
        _ => format!("{number} {name}s"),
    };
    format!("{}, {}", count(errors, "error"), count(warnings, "warning"))
}
