//! Lines that are sent one after the other: those of a macro, and those of a move that probes.

use super::{Driver, From, Purpose};
use crate::serve::reply::Reply;
use husillo_clients::grbl::SYNCHRONISE;
use husillo_transports::grbl::State;
use serde_json::Value;
use std::collections::VecDeque;

/// Reports of a machine at rest until its position is that after the last line. The first one may
/// have been on its way before.
const SETTLED: u32 = 2;

/// Lines, each of which is sent when the one before was accepted.
#[derive(Debug)]
pub(super) struct Sequence {
    /// What it is, for messages.
    name: String,
    lines: VecDeque<String>,
    /// The line that is on its way.
    sent: Option<String>,
    /// Lines that were accepted.
    accepted: usize,
    /// Reports of a machine at rest after the last line.
    reports: Option<u32>,
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
            reports: None,
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

    /// Whether the machine stands, and nothing is on its way to it.
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
        if sequence.sent.is_some() || sequence.reports.is_some() {
            return;
        }
        match sequence.lines.pop_front() {
            Some(line) => {
                sequence.sent = Some(line.clone());
                let is_home = (line.get(..2)).is_some_and(|head| head.eq_ignore_ascii_case("$H"));
                self.send(line, Purpose::Sequence { is_home });
            }
            None => sequence.reports = Some(0),
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

    /// A report has come. After the last line the position is known when the machine stands.
    pub(super) fn sequence_reported(&mut self) {
        let stands = self.session.state() == Some(State::Idle);
        let reports = self.sequence.as_mut().and_then(|all| all.reports.as_mut());
        let Some(reports) = reports.filter(|_| stands) else {
            return;
        };
        *reports += 1;
        if *reports < SETTLED {
            return;
        }
        if let Some(sequence) = self.sequence.take() {
            match sequence.then {
                Then::Answer => sequence.reply.ok(),
                Then::Contact(axis, set) => self.touched(axis, set, sequence.reply),
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
