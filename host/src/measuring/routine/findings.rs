//! Mistakes and failures of routines and programs, as findings.

use crate::measuring::help;
use husillo_metrology::routine::program::{self, ProgramError, ProgramFault};
use husillo_metrology::routine::{Failure, Mistake, Refusal, Refused, Wrong, code, span};
use husillo_simulator::diagnostics::{Finding, Place};
use husillo_simulator::programs::explain::{self, At};

/// Name of the standard input in findings.
const INPUT: &str = "<input>";

/// The finding of a line that is not understood.
pub fn of_mistake(mistake: Mistake, file: &str, text: &str) -> Finding {
    let line = text.lines().nth(mistake.line - 1).unwrap_or_default();
    of_wrong(mistake.wrong, file, mistake.line, line)
}

/// The finding of a line that failed on the machine.
pub fn of_failure(failure: &Failure, file: &str, number: usize, line: &str) -> Finding {
    failed(
        failure,
        Place::new(file, number, line.as_bytes(), span(line)),
    )
}

/// The finding of a typed line that the recording refused.
pub fn of_refused(refused: &Refused) -> Finding {
    let Refused { line, text, why } = refused;
    match why {
        Refusal::Wrong(wrong) => of_wrong(wrong.clone(), INPUT, *line, text),
        Refusal::Failed(failure) => of_failure(failure, INPUT, *line, text),
    }
}

/// The finding of a mistake in a program, or of its failure on the machine.
pub fn of_program(error: &ProgramError, file: &str) -> Finding {
    let at = At {
        file,
        line: error.line,
        bytes: &error.text,
        block: 0,
        length: error.text.len(),
        dialect: program::DIALECT,
    };
    match &error.fault {
        ProgramFault::Code(error) => explain::finding(error, &at),
        ProgramFault::Foreign(span) => {
            let place = span
                .clone()
                .map_or_else(|| at.whole(), |span| at.place(span));
            Finding::error(code::MACHINE, error.fault.to_string(), place)
                .label("a measuring program cannot do this")
                .help(
                    "there are G0, G1, G38.2 to G38.5, frames, M0, M2, M30, O-words, parameters \
                     and the measuring cycles",
                )
        }
        ProgramFault::Call { message, expected } => {
            let finding = Finding::error(code::MISSING, *message, at.whole());
            match expected {
                Some(expected) => {
                    let names: Vec<_> = program::cycles().collect();
                    finding
                        .label(expected)
                        .note(format!("cycles: {}", names.join(", ")))
                }
                None => finding,
            }
        }
        ProgramFault::Failed(failure) => failed(failure, at.whole()),
    }
}

fn of_wrong(wrong: Wrong, file: &str, number: usize, line: &str) -> Finding {
    let place = Place::new(file, number, line.as_bytes(), wrong.span);
    let finding = Finding::error(wrong.code, wrong.message, place).label(wrong.label);
    match wrong.help {
        Some(help) => finding.help(help),
        None => finding,
    }
}

fn failed(failure: &Failure, place: Place) -> Finding {
    let finding = Finding::error(code::MACHINE, failure.to_string(), place);
    match help::of_failure(failure) {
        Some(help) => finding.help(help),
        None => finding,
    }
}
