//! The change of a tool in a program.
//!
//! A controller with a protocol for it (grblHAL with `$341` of 1 to 3) gets the M6. With all others
//! this program makes the change: it switches spindle and coolant off and waits, while the operator
//! moves and measures by hand. Then the tool goes back to its place.

use super::sequence::{Sequence, Then};
use super::{Driver, Purpose};
use crate::serve::axes::words;
use crate::serve::driver::phase::Phase;
use crate::serve::reply::Reply;
use crate::serve::tool_changes::ToolChange;
use husillo_transports::grbl::{Realtime, State};
use serde_json::{Value, json};

/// The setting of grblHAL for the kind of a change.
const KIND: u16 = 341;
/// The byte with which a sender takes over during a change in grblHAL.
const TAKE_OVER: Realtime = Realtime::Unknown(0xa3);
/// Feed with which the tool is lowered if the program has none yet, mm/min.
const SLOW: f64 = 100.0;

/// A change of a tool.
#[derive(Debug)]
pub(super) struct Changing {
    what: ToolChange,
    /// The kind of change of a controller that has a protocol for it.
    kind: Option<u8>,
    stage: Stage,
    /// How the program goes on: its modes, its feed, and the place of the tool from the work zero.
    modal: Vec<String>,
    feed: f64,
    rpm: f64,
    work_mm: Vec<f64>,
}

/// How far a change has come.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Stage {
    /// The spindle is switched off, or the controller has got the M6.
    Begun,
    /// That is answered. The next report has the place of the tool.
    Answered,
    /// The operator changes the tool.
    Open,
}

impl Changing {
    /// It, as pages get it.
    pub(super) fn shown(&self) -> Value {
        json!({
            "tool": self.what.tool,
            "note": self.what.note,
            "line": self.what.line,
            "kind": self.kind,
        })
    }
}

impl Driver<'_> {
    /// The change that must be made before the next line.
    pub(super) fn next_change(&self) -> Option<&ToolChange> {
        let running = &*self.running;
        let change = running
            .course
            .program()?
            .changes
            .get(running.changes_made)?;
        (change.line <= running.next_number()?).then_some(change)
    }

    /// Whether the operator changes a tool, and moves by hand meanwhile.
    pub(super) fn is_changing(&self) -> bool {
        let is_open = |change: &Changing| change.stage == Stage::Open;
        self.running.course.phase() == Phase::Waiting
            && self.running.changing.as_ref().is_some_and(is_open)
    }

    /// Begins a change: all lines before are made.
    pub(super) fn begin_change(&mut self) {
        let Some(what) = self.next_change().cloned() else {
            return;
        };
        let kind = self.settings.get(&KIND).and_then(|kind| kind.parse().ok());
        let kind = kind.filter(|kind| (1..=3).contains(kind));
        if kind.is_some() {
            let tool = what.tool.map_or(String::new(), |tool| format!("T{tool}"));
            self.send(format!("{tool}M6"), Purpose::Change);
        } else {
            // How the spindle turns now, before it is switched off.
            self.send_known("$G");
            self.send("M5M9", Purpose::Change);
        }
        self.running.changing = Some(Changing {
            what,
            kind,
            stage: Stage::Begun,
            modal: Vec::new(),
            feed: 0.0,
            rpm: 0.0,
            work_mm: Vec::new(),
        });
    }

    /// The spindle is off, or the controller has taken the M6; or it has refused that.
    ///
    /// # Errors
    ///
    /// The controller is lost.
    pub(super) fn change_answered(&mut self, result: Result<(), String>) -> Result<(), String> {
        if let Err(why) = result {
            self.fail_program(&format!("the change of a tool: {why}"));
            return self.begin_halt(false, "a line of the program was refused");
        }
        let programmed = |name: &str| {
            let all = self.state.programmed.as_ref();
            all.and_then(|all| all[name].as_f64()).unwrap_or(0.0)
        };
        let (feed, rpm) = (programmed("feed"), programmed("rpm"));
        if let Some(changing) = &mut self.running.changing {
            changing.stage = Stage::Answered;
            changing.modal.clone_from(&self.state.modal);
            (changing.feed, changing.rpm) = (feed, rpm);
        }
        Ok(())
    }

    /// The controller has reported: the operator may begin, when it waits for the tool.
    ///
    /// # Errors
    ///
    /// The controller is lost.
    pub(super) fn change_reported(&mut self) -> Result<(), String> {
        let state = self.session.state();
        let runs = self.running.course.phase() == Phase::Running;
        let Some(changing) = &mut self.running.changing else {
            return Ok(());
        };
        let has_controller = changing.kind.is_some();
        let waits_for = if has_controller {
            State::Tool
        } else {
            State::Idle
        };
        if !runs || changing.stage != Stage::Answered || state != Some(waits_for) {
            return Ok(());
        }
        changing.stage = Stage::Open;
        changing.work_mm = self.state.work_mm.clone().unwrap_or_default();
        let message = changing.what.said();
        self.modes_are_due = true;
        self.running.course.wait(Some(message));
        match has_controller {
            true => self.put(TAKE_OVER),
            false => Ok(()),
        }
    }

    /// The operator has changed the tool: goes back, and on with the program.
    ///
    /// # Errors
    ///
    /// The controller is lost.
    pub(super) fn end_change(&mut self, reply: Reply) -> Result<(), String> {
        let has_controller = self.running.changing.as_ref().and_then(|one| one.kind);
        if has_controller.is_some() {
            if self.session.state() != Some(State::Tool) || !self.is_quiet() {
                reply.error("the machine is not at rest");
                return Ok(());
            }
            self.put(Realtime::Resume)?;
            self.change_made();
            reply.ok();
            return Ok(());
        }
        match self.stands().and_then(|()| self.way_back()) {
            Ok(lines) => {
                let name = "the way back to the program".to_owned();
                self.begin_sequence(Sequence::new(name, lines, Then::Change, reply));
            }
            Err(why) => reply.error(why),
        }
        Ok(())
    }

    /// The change is made: the program goes on.
    pub(super) fn change_made(&mut self) {
        let running = &mut *self.running;
        running.changing = None;
        running.changes_made += 1;
        running.length_mm = self.state.tool_length_mm.unwrap_or(0.0);
        // What waits before the same line has waited.
        running.pass();
        // The program is waiting.
        let _ = running.course.resume();
    }

    /// The lines that lead back to where the program was, with the present length of the tool.
    fn way_back(&self) -> Result<Vec<String>, String> {
        let changing = self.running.changing.as_ref().ok_or("no tool is changed")?;
        if self.modes_are_pending() {
            return Err("the controller has not reported its modes yet: try again".into());
        }
        let now = self.state.work_mm.as_deref().unwrap_or_default();
        let (Some(high), [x, y, z, ..]) = (now.get(2), &changing.work_mm[..]) else {
            return Err("the position of the machine is not known".into());
        };
        let has = |code: &str| changing.modal.iter().any(|mode| mode == code);
        let frame = changing.modal.get(1).cloned().unwrap_or_default();
        if self.state.offset.as_ref() != Some(&frame) {
            return Err(format!("send {frame} first: the program is in this system"));
        }
        let feed = if changing.feed > 0.0 {
            changing.feed
        } else {
            SLOW
        };
        let up = words(&[(2, high.max(*z))]);
        let over = words(&[(0, *x), (1, *y)]);
        let mut lines = vec![format!("G21G90G94F{feed:.3}"), format!("G0{up}")];
        lines.push(format!("G0{over}"));
        for spindle in ["M3", "M4"].into_iter().filter(|code| has(code)) {
            lines.push(format!("{spindle}S{:.3}", changing.rpm));
        }
        lines.extend(
            ["M7", "M8"]
                .into_iter()
                .filter(|code| has(code))
                .map(str::to_owned),
        );
        if high > z {
            lines.push(format!("G1{}", words(&[(2, *z)])));
        }
        // Arcs and cycles have their code in each line of theirs.
        let kept = [
            "G0", "G1", "G80", "G17", "G18", "G19", "G20", "G21", "G90", "G91", "G93", "G94",
        ];
        let modes = changing.modal.iter();
        lines.push(
            modes
                .filter(|mode| kept.contains(&mode.as_str()))
                .cloned()
                .collect(),
        );
        Ok(lines)
    }
}
