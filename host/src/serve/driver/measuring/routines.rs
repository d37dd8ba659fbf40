//! Routines: their check, their sketch, their run and its results.
//!
//! A routine has a [`Phase`], but not the `Course` of a program. A course has a program that was
//! loaded and simulated, waits before its parts, goes on with the part that was interrupted, and
//! ends with a record of its times. A routine comes with the request that starts it, is carried
//! out in one go by the thread of the head, cannot go on after a stop, because it needs the
//! features that were measured before, and ends with results.

use super::measured::Measured;
use super::{Driver, Job, Purpose};
use crate::measuring::Routine;
use crate::serve::driver::phase::Phase;
use crate::serve::loaded::described;
use crate::serve::machine::{Machine, ReportPage};
use crate::serve::reply::Reply;
use crate::serve::tool_path::Motion;
use husillo_metrology::routine::{Sketch, number};
use jiff::Timestamp;
use serde_json::{Value, json};
use std::sync::{Arc, PoisonError};

/// Longest text of a routine, bytes. A frame of a page has 64 KiB.
const MOST_BYTES: usize = 60_000;

/// The last routine of a machine.
#[derive(Debug, Default)]
pub(super) struct Routines {
    name: String,
    text: String,
    phase: Phase,
    line: Option<usize>,
    /// The line of an M0 at which it waits.
    waits: Option<usize>,
    message: Option<String>,
    summary: Option<String>,
    is_good: bool,
    features: Vec<Value>,
    /// How many have ended: the last one has a report.
    runs: u64,
}

impl Routines {
    /// Checks a routine: its mistakes, or the sketch of its features.
    pub(super) fn checked(name: &str, text: String) -> Result<Value, String> {
        if text.len() > MOST_BYTES {
            return Err(format!("a routine has {MOST_BYTES} bytes at most"));
        }
        Ok(match Routine::parse(&plain(name), text.into_bytes()) {
            Ok(routine) => {
                let mut coordinates_from = 1;
                let mut sketches = Vec::new();
                for statement in routine.statements() {
                    if statement.changes_coordinates() {
                        coordinates_from = statement.line;
                    }
                    let found = statement.sketch();
                    sketches.extend(found.map(|one| sketch(&one, coordinates_from)));
                }
                json!({"findings": [], "sketch": sketches})
            }
            Err(findings) => {
                let findings: Vec<_> = findings.iter().map(described).collect();
                json!({"findings": findings, "sketch": []})
            }
        })
    }

    /// In the state of the machine. `None`: there was none.
    pub(super) fn shown(&self) -> Option<Value> {
        (!self.name.is_empty()).then(|| {
            json!({
                "name": self.name,
                "phase": self.phase.name(),
                "line": self.line,
                "waits_at": self.waits,
                "message": self.message,
                "summary": self.summary,
                "is_good": self.is_good,
                "features": self.features.len(),
                "runs": self.runs,
            })
        })
    }

    /// All of the last routine: its text and what it has measured.
    pub(super) fn all(&self) -> Value {
        json!({"name": self.name, "text": self.text, "features": self.features})
    }

    pub(super) fn line(&mut self, line: usize) {
        self.line = Some(line);
    }

    pub(super) fn waits(&mut self, line: Option<usize>) {
        self.waits = line;
        self.phase = match line {
            Some(_) => Phase::Waiting,
            None => Phase::Running,
        };
        self.line = line.or(self.line);
    }

    /// Whether it waits at an M0.
    pub(super) fn is_waiting(&self) -> bool {
        self.phase == Phase::Waiting
    }

    pub(super) fn feature(&mut self, feature: Value) {
        self.features.push(feature);
    }

    /// The routine has ended: its results and its report.
    pub(super) fn measured(&mut self, measured: Measured, machine: &Machine) {
        self.features = measured.features;
        self.summary = Some(measured.summary);
        self.is_good = measured.is_good;
        if measured.has_collided {
            self.message = Some("the probe has collided: no result counts".into());
        }
        self.runs += 1;
        let page = ReportPage {
            name: ReportPage::name_of(&self.name, Timestamp::now()),
            text: measured.page,
        };
        let mut kept = machine
            .report
            .lock()
            .unwrap_or_else(PoisonError::into_inner);
        *kept = Some(Arc::new(page));
    }

    /// The routine has ended like this.
    pub(super) fn ended(&mut self, result: Result<(), String>, is_stopped: bool) {
        self.waits = None;
        self.phase = match &result {
            Ok(()) => Phase::Done,
            Err(_) if is_stopped => Phase::Stopped,
            Err(_) => Phase::Failed,
        };
        if let Err(why) = result {
            // That the probe has collided is said beside it.
            self.message = Some(match self.message.take() {
                Some(before) => format!("{why}; {before}"),
                None => why,
            });
        }
    }

    /// The machine is lost, or this program ends.
    pub(super) fn end(&mut self, why: &str) {
        if self.phase.is_active() {
            self.ended(Err(why.into()), false);
        }
    }
}

impl Driver<'_> {
    /// Runs a routine.
    pub(super) fn run(&mut self, name: &str, text: String, part: Option<String>, reply: Reply) {
        if let Err(why) = self.is_free() {
            return reply.error(why);
        }
        if self.config.scale.count_mm().is_none() {
            return reply.error("a routine is in mm, and the length of a count is not known");
        }
        if text.len() > MOST_BYTES {
            return reply.error(format!("a routine has {MOST_BYTES} bytes at most"));
        }
        let name = plain(name);
        let routine = match Routine::parse(&name, text.clone().into_bytes()) {
            Ok(routine) => routine,
            Err(findings) => {
                let first = findings.first();
                let text = first.map(|one| (one.line_and_column().0, one.message.as_str()));
                let (line, message) = text.unwrap_or_default();
                return reply.error(format!("line {line}: {message}"));
            }
        };
        *self.routines = Routines {
            name,
            text,
            phase: Phase::Running,
            runs: self.routines.runs,
            ..Routines::default()
        };
        let part = part.filter(|part| !part.is_empty());
        let part = part.map(|part| part.chars().take(200).collect());
        self.start(
            Job::Routine(Box::new(routine), part),
            Purpose::Routine,
            "Run",
        );
        reply.ok();
    }

    /// Why the tip moves.
    pub(super) fn motion(&self) -> Motion {
        match &self.current {
            Some((Purpose::Jog { .. }, _)) | None => Motion::Jog,
            Some((Purpose::Asked(_), "Home" | "Run")) => Motion::Rapid,
            Some(_) => Motion::Feed,
        }
    }
}

/// The name of a routine without control characters.
fn plain(name: &str) -> String {
    let name: String = name.chars().filter(|c| !c.is_control()).take(200).collect();
    if name.is_empty() {
        "part.routine".into()
    } else {
        name
    }
}

/// A sketch, as pages get it. Lengths are in mm, in the coordinates that begin with a line.
fn sketch(sketch: &Sketch, coordinates_from: usize) -> Value {
    let touches = sketch
        .touches
        .iter()
        .map(|touch| json!({"at": touch.at_nm.map(number), "towards": touch.towards}));
    json!({
        "kind": sketch.keyword,
        "feature": sketch.name,
        "line": sketch.line,
        "coordinates_from": coordinates_from,
        "touches": touches.collect::<Vec<_>>(),
        "round": sketch.round_nm.map(|(centre, diameter)| {
            json!({"centre": centre.map(number), "diameter": number(diameter)})
        }),
    })
}
