//! Lines that are sent one after the other: those of a macro, and those of a move that probes.

use super::{Driver, From, Purpose};
use crate::serve::reply::Reply;
use husillo_clients::grbl::SYNCHRONISE;
use husillo_transports::grbl::State;
use serde_json::Value;
use std::collections::VecDeque;

/// Lines, each of which is sent when the one before was accepted.
#[derive(Debug)]
pub(super) struct Sequence {
    /// Its name in messages.
    name: String,
    lines: VecDeque<String>,
    /// The line that is sent and not answered.
    sent: Option<String>,
    /// Lines that were accepted.
    accepted: usize,
    /// All lines are made. The next report has the position after the last one.
    is_made: bool,
    then: Then,
    reply: Reply,
}

/// What follows the last line.
#[derive(Clone, Debug)]
pub(super) enum Then {
    /// The answer.
    Answer,
    /// The contact of a probe becomes this work coordinate of this axis, if it has one.
    Contact(usize, Option<f64>),
    /// The program goes on, with another tool.
    Change,
}

impl Sequence {
    /// Lines that were not sent yet.
    pub(super) fn new(name: String, lines: Vec<String>, then: Then, reply: Reply) -> Self {
        let mut all = VecDeque::new();
        for line in lines {
            // Commands of the controller need a machine at rest.
            if line.starts_with('$') && !all.is_empty() {
                all.push_back(SYNCHRONISE.to_owned());
            }
            all.push_back(line);
        }
        all.push_back(SYNCHRONISE.to_owned());
        Self {
            name,
            lines: all,
            sent: None,
            accepted: 0,
            is_made: false,
            then,
            reply,
        }
    }
}

impl Driver<'_> {
    /// Begins to send lines one after the other, if the machine stands.
    pub(super) fn begin_sequence(&mut self, sequence: Sequence) {
        self.machine
            .tell(From::Server, format!("{} begins", sequence.name));
        self.sequence = Some(sequence);
    }

    /// Sends the lines of a macro.
    pub(super) fn run_macro(&mut self, name: &str, reply: Reply) {
        let lines = self.stands().and_then(|()| self.machine.macros.lines(name));
        match lines {
            Ok(lines) => {
                let name = format!("the macro {name}");
                self.begin_sequence(Sequence::new(name, lines, Then::Answer, reply));
            }
            Err(why) => reply.error(why),
        }
    }

    /// Whether the machine stands, and all lines are answered.
    ///
    /// # Errors
    ///
    /// A sentence about why not.
    pub(super) fn stands(&self) -> Result<(), String> {
        self.is_free()?;
        match self.session.state() {
            Some(State::Idle) if self.is_quiet() => Ok(()),
            _ => Err("the machine is not at rest".into()),
        }
    }

    /// Sends the next line, when the one before was accepted.
    pub(super) fn feed_sequence(&mut self) {
        if self.halting.is_some() {
            return;
        }
        let Some(sequence) = &mut self.sequence else {
            return;
        };
        if sequence.sent.is_some() || sequence.is_made {
            return;
        }
        match sequence.lines.pop_front() {
            Some(line) => {
                sequence.sent = Some(line.clone());
                let is_home = (line.get(..2)).is_some_and(|head| head.eq_ignore_ascii_case("$H"));
                self.send(line, Purpose::Sequence { is_home });
            }
            None => sequence.is_made = true,
        }
    }

    /// A line was accepted, or refused. After a refusal what moves is stopped.
    ///
    /// # Errors
    ///
    /// The controller is lost.
    pub(super) fn sequence_answered(&mut self, result: Result<(), String>) -> Result<(), String> {
        let Some(sequence) = &mut self.sequence else {
            return Ok(());
        };
        let line = sequence.sent.take().unwrap_or_default();
        let Err(why) = result else {
            sequence.accepted += 1;
            return Ok(());
        };
        let may_move = sequence.accepted > 0;
        self.end_sequence(&format!("{line}: {why}"));
        match may_move && self.halting.is_none() {
            true => self.begin_halt(false, "a line was refused"),
            false => Ok(()),
        }
    }

    /// The controller has reported. A sequence that is made ends with this position.
    pub(super) fn sequence_reported(&mut self) {
        if let Some(sequence) = self.sequence.take_if(|sequence| sequence.is_made) {
            match sequence.then {
                Then::Answer => sequence.reply.ok(),
                Then::Contact(axis, set) => self.touched(axis, set, sequence.reply),
                Then::Change => {
                    self.change_made();
                    sequence.reply.ok();
                }
            }
        }
    }

    /// A sequence has ended before its last line.
    pub(super) fn end_sequence(&mut self, why: &str) {
        if let Some(sequence) = self.sequence.take() {
            let why = format!("{}: {why}", sequence.name);
            self.machine.tell(From::Server, why.as_str());
            sequence.reply.error(why);
        }
    }

    /// Answers with the contact. It becomes a work coordinate, if one is given.
    fn touched(&mut self, axis: usize, set: Option<f64>, reply: Reply) {
        let Some(probe) = self.state.probe.clone() else {
            return reply.error("the controller has reported no contact");
        };
        let data = serde_json::json!({"at_mm": probe["at_mm"], "touched": probe["touched"]});
        let contact = probe["at_mm"].get(axis).and_then(Value::as_f64);
        let now = (self.state.machine_mm.as_ref()).and_then(|at| at.get(axis).copied());
        match (set, contact.zip(now)) {
            (None, _) => reply.data(data),
            (Some(set), Some((contact, now))) => {
                let at = set + now - contact;
                self.zero_axes(&[(axis, at)], data, reply);
            }
            (Some(_), None) => reply.error("the contact is not known"),
        }
    }
}
