//! A figure of the microfactory: read from a list or a program, checked, and timed.

use crate::microfactory::figure::{self, Moves, NOTHING, drawn, is_list};
use husillo_clients::microfactory::{Settings, listed};
use husillo_sim::device::microfactory::ROOM;
use husillo_sim::text::counted;
use husillo_simulator::diagnostics::{Finding, Findings, Place, Severity};
use husillo_simulator::job::Job;
use husillo_simulator::machines::machine_file::MachineFile;
use husillo_simulator::programs::source::Source;
use std::io::Cursor;

/// A microfactory.
#[derive(Debug)]
pub struct Factory {
    /// Its description.
    pub file: MachineFile,
    /// Its rates and the bytes of its link.
    pub settings: Settings,
}

/// The text of a figure as a program: a list of moves as one of the same moves.
///
/// # Errors
///
/// A finding: the list has a line that is no move.
pub fn as_program(name: &str, text: &[u8], factory: &Factory) -> Result<Vec<u8>, Box<Finding>> {
    if !is_list(name) {
        return Ok(text.to_vec());
    }
    let text = String::from_utf8_lossy(text);
    match listed(&text) {
        Ok(moves) => Ok(drawn(&moves, &factory.settings).into_bytes()),
        Err((number, reason)) => {
            let line = text.lines().nth(number - 1).unwrap_or_default().as_bytes();
            let place = Place::new(name, number, line, 0..line.len());
            Err(Box::new(Finding::error("E0401", reason, place)))
        }
    }
}

/// The moves of a checked program, in steps of X and Z, with their lines. `findings` gets what the
/// machine cannot cut.
///
/// # Errors
///
/// A sentence: the program cannot be read.
pub fn moves(
    job: &Job,
    text: &[u8],
    factory: &Factory,
    findings: &mut Findings,
) -> Result<Moves, String> {
    let mut source = Source::from_reader(Box::new(Cursor::new(text.to_vec())));
    // The errors of the program are known.
    let mut known = Findings::new(1);
    let read = figure::programmed(&mut source, job.name(), &factory.settings, &mut known);
    let moves = match read.map_err(|error| error.to_string())? {
        Ok(moves) => moves,
        Err(refused) => {
            findings.add(refused);
            return Ok(Vec::new());
        }
    };
    let wrong = match moves.len() {
        0 => NOTHING.into(),
        count if count > usize::from(ROOM) => format!(
            "a figure of {}: the machine has room for {ROOM}",
            counted(count, "move")
        ),
        _ => return Ok(moves),
    };
    findings.add(Finding::general(Severity::Error, "E0401", wrong));
    Ok(Vec::new())
}

/// A move as text, such as `X +1000 Z -500`.
pub fn text([x, z]: [i16; 2]) -> String {
    format!("X {x:+} Z {z:+}")
}
