//! A program as strings of the micro mill.

use super::loaded::{Surroundings, job, said};
use crate::micromill;
use husillo_clients::micromill::Translated;
use husillo_simulator::diagnostics::Findings;
use husillo_simulator::job::Job;
use husillo_transports::micromill::{Line, Order};
use serde_json::{Value, json};

/// The string of a line, with its `;`.
pub fn string(line: Line) -> String {
    String::from_utf8_lossy(Order::Line(line).text().bytes()).into_owned()
}

/// Strings with the numbers of their lines, and findings.
pub type Strings = (Vec<(usize, String)>, Vec<Value>);

/// The strings of a checked program, and what was dropped or changed, as findings.
///
/// # Errors
///
/// A sentence: the program cannot be read.
pub fn strings(job: &Job) -> Result<Strings, String> {
    let made = translated(job)?;
    let finding = |severity: &str, (line, message): &(usize, String)| {
        json!({
            "code": "mill",
            "severity": severity,
            "line": line,
            "column": 1,
            "message": message,
        })
    };
    let errors = made.errors.iter().map(|one| finding("error", one));
    let notes = made.notes.iter().map(|one| finding("warning", one));
    let strings = made.lines.iter();
    Ok((
        strings
            .map(|(number, line)| (*number, string(*line)))
            .collect(),
        errors.chain(notes).collect(),
    ))
}

/// A program as the lines that the mill makes from where it stands.
///
/// # Errors
///
/// A sentence about its first error.
pub fn lines(name: &str, text: &[u8], around: &Surroundings) -> Result<Translated, String> {
    let mut job = job(name, text, around)?;
    let mut findings = Findings::new(200).up_to_error();
    job.check(&mut findings).map_err(said)?;
    if findings.errors > 0 {
        let last = findings.kept().last();
        let why = last.map(|one| format!("line {}: {}", one.line_and_column().0, one.message));
        return Err(why.unwrap_or_else(|| "the program has errors".into()));
    }
    let made = translated(&job)?;
    match made.errors.first() {
        Some((line, message)) => Err(format!("line {line}: {message}")),
        None => Ok(made),
    }
}

fn translated(job: &Job) -> Result<Translated, String> {
    let source = job.open().map_err(said)?;
    micromill::translated(job, source).map_err(|error| error.to_string())
}
