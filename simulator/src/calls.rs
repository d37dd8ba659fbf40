//! The simulator for other languages: options in JSON and a program as bytes in, answers in JSON
//! out. The packages for browsers and for Python have their forms of these calls.
//!
//! ```
//! use husillo_simulator::calls::{Options, check};
//!
//! let options: Options = serde_json::from_str(r#"{"machine": "router"}"#)?;
//! let answer = check(&options, b"G1 X2 Q\n").expect("a machine and a text");
//! assert!(answer.text.starts_with(br#"{"schema":"husillo.check/1""#));
//! # Ok::<(), serde_json::Error>(())
//! ```

mod answer;
mod compare;
mod drill_file;
mod machines;
mod options;
mod ready;
mod tune;

pub use answer::{Answer, Failed};
pub use compare::{Compared, compare};
pub use drill_file::{Holes, holes};
pub use machines::{machine, machine_text, machines};
pub use options::Options;
pub use ready::Ready;
pub use tune::{Experiment, tune};

use crate::holes as drill_files;
use serde_json::json;

/// Checks a program, or a drill file by its name. Nothing runs.
///
/// # Errors
///
/// The machine or an option is wrong, or the program cannot be read. What is wrong in the program
/// is in the answer.
pub fn check(options: &Options, program: &[u8]) -> Result<Answer, Failed> {
    const SCHEMA: &str = "husillo.check/1";
    let mut findings = options.findings();
    if drill_files::is_drill_file(None, &options.name) {
        let setup = drill_files::Setup::default();
        drill_files::read(program, &options.name, &setup, &mut findings);
        let body = json!({
            "file": options.name,
            "errors": findings.errors,
            "warnings": findings.warnings,
            "notes": [],
        });
        return Answer::found(SCHEMA, &body, &findings);
    }
    let mut job = options.job(program)?;
    let facts = job.check(&mut findings)?;
    let body = json!({
        "file": job.name(),
        "machine": job.machine.name,
        "errors": findings.errors,
        "warnings": findings.warnings,
        "notes": job.take_notes(),
        "feed_nm": facts.feed_nm.round(),
        "rapid_nm": facts.rapid_nm.round(),
        "reversals": &facts.reversals[..job.machine.axes.len()],
    });
    Answer::found(SCHEMA, &body, &findings)
}

/// The commands of a program. They are the data: one JSON object a line.
///
/// # Errors
///
/// As [`check`].
pub fn commands(options: &Options, program: &[u8]) -> Result<Answer, Failed> {
    let mut findings = options.findings();
    let job = options.job(program)?;
    let mut lines = Vec::new();
    job.write_commands(true, &mut findings, &mut lines)?;
    let body = json!({"errors": findings.errors, "warnings": findings.warnings});
    let answer = Answer::found("husillo.commands/1", &body, &findings)?;
    Ok(Answer {
        data: lines,
        ..answer
    })
}

#[cfg(test)]
mod tests;
