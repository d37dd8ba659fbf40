//! The micro mill: programs as its strings, and a controller on a port.
//!
//! ```text
//! program ─► commands ─► translate ─► lines ─┬─► file.mm
//!                                            └─► sender ─► port ─► controller
//!                        the machine's steps ◄─ compared ─┘ steps told
//!
//! actions ─► hand ─► port ─► controller
//! ```

use crate::by_hand;
use crate::cli::Jog;
use crate::console::reporter::Reporter;
use crate::console::sharing::share;
use crate::console::stop::stop_requests;
use husillo_clients::micromill::{
    Action, BAUD, Frame, Hand, LEASE_MS, LengthUnit, Translated, Translator, open,
};
use husillo_machine::Config;
use husillo_simulator::diagnostics::Findings;
use husillo_simulator::job::Job;
use husillo_simulator::programs::source::Source;
use husillo_simulator::programs::{program, setup};
use husillo_transports::micromill::{Line, Order};
use std::fmt::Write as _;
use std::io;

/// The program of a job as the lines of the mill. `source` is the open program. A check finds its
/// errors, so they are not collected again.
///
/// # Errors
///
/// The program cannot be read.
pub fn translated(job: &Job, mut source: Source) -> io::Result<Translated> {
    let config = setup::first_three(&job.config);
    let [zero, at] = [job.start.zero, job.start.at].map(setup::three);
    let mut translator = Translator::new(&config, zero, at);
    program::walk(
        &mut source,
        job.name(),
        job.start,
        &mut Findings::new(0),
        |meaning, command, _, _| {
            translator.push_command(meaning.at.line, command);
            Ok(())
        },
    )?;
    Ok(translator.take())
}

/// The lines as the text of a file: one string per line.
pub fn text(lines: &[(usize, Line)]) -> String {
    let mut out = String::new();
    for (_, line) in lines {
        let text = Order::Line(*line).text();
        // Strings of the link are plain letters and digits, so writing one does not fail.
        let _ = writeln!(out, "{}", String::from_utf8_lossy(text.bytes()));
    }
    out
}

/// `husillo jog`. Returns whether all actions succeeded.
///
/// # Errors
///
/// A sentence about a wrong action, before anything moves.
pub fn jog(args: &Jog, config: Config<3>, out: &mut Reporter<'_>) -> Result<bool, String> {
    let actions = Action::parse(&args.actions)?;
    let [name] = &args.port[..] else {
        return Err("a mill is driven alone: one --port".into());
    };
    if args.figure.is_some() || args.without_answers {
        return Err("--figure and --without-answers are for the microfactory".into());
    }
    let baud = args.baud.unwrap_or(BAUD);
    let stop = stop_requests()?;
    let wire = open(name, baud)?;
    share(&args.machine, name, baud);
    let unit = match args.inch {
        true => LengthUnit::Inches,
        false => LengthUnit::Millimetres,
    };
    let lease_ms = args.lease.unwrap_or(LEASE_MS);
    let frame = Frame { config, unit };
    let mut hand = match Hand::new(wire, baud, lease_ms, frame, stop) {
        Ok(hand) => hand,
        Err(sentence) => {
            out.failed(name, &sentence);
            return Ok(false);
        }
    };
    Ok(by_hand::carry_out(name, &actions, &mut hand, out))
}
