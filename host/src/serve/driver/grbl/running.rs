//! A program that is sent: line after line, with breakpoints and holds.

use super::changing::Changing;
use super::{Driver, From, Purpose};
use crate::serve::continuation::Continuation;
use crate::serve::driver::course::{Course, Progress};
use crate::serve::driver::phase::Phase;
use crate::serve::loaded::{Loaded, Surroundings, Target};
use crate::serve::reply::Reply;
use husillo_clients::grbl::{SYNCHRONISE, has_coordinate};
use husillo_transports::grbl::{Realtime, State};
use serde_json::{Value, json};
use std::sync::Arc;
use std::time::{Duration, Instant};

/// A length and a work zero are reported with three places each.
const ROUNDED_MM: f64 = 0.0025;

/// The program of a machine.
#[derive(Debug, Default)]
pub(in crate::serve) struct Running {
    pub(in crate::serve) course: Course,
    /// The lines that are sent: all of the program, or those of a continuation.
    lines: Arc<[(usize, String)]>,
    /// How many of them come before those of the program.
    before: usize,
    /// A continuation that was shown.
    pub(super) continuation: Option<Continuation>,
    /// Where the machine was when the program was started at its first line, mm.
    pub(super) begun_mm: Option<Vec<f64>>,
    /// The overrides that were noted in its record.
    noted: Option<Value>,
    /// Index of the next line to send.
    next: usize,
    answered: usize,
    /// Index of the line that the operator has let pass.
    passed: usize,
    /// The lines before the next one are made, when the dwell that was sent is answered.
    is_synchronising: bool,
    /// All lines are made. The next report of the controller has the last position.
    is_made: bool,
    turned_at: Option<Instant>,
    /// Simulated time that is done, s.
    done_s: f64,
    /// The change of a tool that is being made.
    pub(super) changing: Option<Changing>,
    /// Changes of tools that are made, or are before the first line.
    pub(super) changes_made: usize,
    /// The length of the tool with which the program runs, and that with which it was checked, mm.
    pub(super) length_mm: f64,
    checked_length_mm: f64,
}

impl Running {
    /// The phase, as pages get it.
    fn phase_name(&self, is_held: bool) -> &'static str {
        match self.course.phase() {
            Phase::Running if is_held => "held",
            phase => phase.name(),
        }
    }

    /// The number of the line that is sent next.
    pub(super) fn next_number(&self) -> Option<usize> {
        self.lines.get(self.next).map(|(number, _)| *number)
    }

    /// The next line is sent without a wait before it.
    pub(super) const fn pass(&mut self) {
        self.passed = self.next + 1;
        self.is_synchronising = false;
    }

    fn is_at_breakpoint(&self) -> bool {
        let is_marked = |(number, _): &(usize, String)| {
            self.next >= self.before && self.course.breakpoints.contains(number)
        };
        let next = self.lines.get(self.next);
        let must = (self.course.single_block && self.next > 0) || next.is_some_and(is_marked);
        must && self.passed != self.next + 1
    }

    /// The line that is probably being made, if this many moves wait in the controller.
    fn line(&self, moves: usize) -> Option<usize> {
        match self.course.phase() {
            Phase::Loaded => None,
            _ => self.open(moves),
        }
    }

    /// The first line that is not certainly made, if at most this many moves wait in the
    /// controller and one is made. Lines without motion do not wait there: they are answered at
    /// once.
    fn open(&self, moves: usize) -> Option<usize> {
        let moved = (0..self.answered).rev().filter(|index| self.moves(*index));
        let index = moved.take(moves + 1).last();
        // With fewer moves, all of them may wait.
        self.lines
            .get(index.unwrap_or(0))
            .map(|(number, _)| *number)
    }

    /// Whether a line can wait in the queue of the controller: whether it takes time, or without
    /// the times of the program, whether it has a coordinate.
    fn moves(&self, index: usize) -> bool {
        let program = self.course.program();
        let times = program.and_then(|program| program.times.as_ref());
        match (self.lines.get(index), times) {
            (None, _) => false,
            (Some((number, _)), Some(times)) if index >= self.before => {
                times.end_s(*number) > times.end_s(number.saturating_sub(1))
            }
            (Some((_, line)), _) => has_coordinate(line),
        }
    }
}

impl Driver<'_> {
    /// Takes a program that was checked.
    pub(super) fn load(&mut self, program: Arc<Loaded>, reply: Reply) {
        if self.running.course.is_active() {
            return reply.error("a program runs: stop it first");
        }
        let mut course = std::mem::take(&mut self.running.course);
        let lines = Arc::clone(&program.lines);
        course.load(self.machine, program);
        *self.running = Running {
            course,
            lines,
            checked_length_mm: self.state.tool_length_mm.unwrap_or(0.0),
            ..Running::default()
        };
        reply.ok();
    }

    /// Forgets the program.
    pub(super) fn unload(&mut self, reply: Reply) {
        if self.running.course.is_active() {
            return reply.error("a program runs: stop it first");
        }
        let mut course = std::mem::take(&mut self.running.course);
        course.unload(self.machine);
        *self.running = Running {
            course,
            ..Running::default()
        };
        reply.ok();
    }

    /// What a program is checked against.
    pub(super) fn surroundings(&self) -> Surroundings {
        let zero_mm = self.state.zero_mm.clone().filter(|_| !self.zero_is_due);
        Surroundings {
            target: Target::Grbl(self.settings.clone()),
            zero_mm: zero_mm.unwrap_or_default(),
            at_mm: self.state.machine_mm.clone().unwrap_or_default(),
        }
    }

    /// Starts the program, or tells what would happen.
    pub(super) fn run(&mut self, is_confirmed: bool, reply: Reply) {
        let program = match self.may_run() {
            Ok(program) => program,
            Err(why) => return reply.error(why),
        };
        if is_confirmed {
            self.running.begun_mm.clone_from(&self.state.machine_mm);
            let lines = Arc::clone(&program.lines);
            self.start(program, lines, 0, None);
            return reply.ok();
        }
        reply.data(json!({
            "name": program.name,
            "lines": program.lines.len(),
            "time_s": program.times.as_ref().map(|times| times.total_s()),
            "work_mm": self.state.work_mm,
            "modal": self.state.modal,
            "changes": program.changes.iter().map(|change| {
                json!({"line": change.line, "tool": change.tool, "note": change.note})
            }).collect::<Vec<_>>(),
        }));
    }

    /// Whether a program that was checked in these surroundings may be run now. Another tool may
    /// have another length.
    fn is_as_checked(&self, before: &Surroundings) -> bool {
        let mut now = self.surroundings();
        let length = self.state.tool_length_mm.unwrap_or(0.0) - self.running.checked_length_mm;
        if length == 0.0 {
            return now.are_those_of(before);
        }
        if let (Some(z), Some(before)) = (now.zero_mm.get_mut(2), before.zero_mm.get(2)) {
            if (*z - length - before).abs() < ROUNDED_MM {
                *z = *before;
            }
        }
        now.are_those_of(before)
    }

    /// The program, if it may be run.
    ///
    /// # Errors
    ///
    /// A sentence about why not.
    pub(super) fn may_run(&self) -> Result<Arc<Loaded>, String> {
        self.takes_lines()?;
        if self.running.course.is_active() {
            return Err("a program runs".into());
        }
        let program = self.running.course.program().cloned();
        let program = program.ok_or("no program is loaded")?;
        if program.errors > 0 {
            return Err("the program has errors: correct them first".into());
        }
        if !self.is_as_checked(&program.around) {
            let why = "the work zero or a setting has changed since the program was checked: \
                       load it again";
            return Err(why.into());
        }
        if program.lines.is_empty() {
            return Err("the program has no commands".into());
        }
        match self.session.state() {
            Some(State::Idle | State::Check) if self.is_quiet() => Ok(program),
            Some(State::Alarm) => Err("the controller is locked: home or unlock".into()),
            _ => Err("the machine is not at rest".to_owned()),
        }
    }

    /// Begins to send these lines, `before` of which come before those of the program.
    pub(super) fn start(
        &mut self,
        program: Arc<Loaded>,
        lines: Arc<[(usize, String)]>,
        before: usize,
        from: Option<usize>,
    ) {
        let running = &mut *self.running;
        let mut course = std::mem::take(&mut running.course);
        course.start(self.machine, program, from);
        *running = Running {
            course,
            lines,
            before,
            begun_mm: running.begun_mm.take(),
            length_mm: self.state.tool_length_mm.unwrap_or(0.0),
            checked_length_mm: running.checked_length_mm,
            ..Running::default()
        };
    }

    /// Goes on: past a breakpoint, or after a hold.
    ///
    /// # Errors
    ///
    /// The controller is lost.
    pub(super) fn resume(&mut self, reply: Reply) -> Result<(), String> {
        if self.is_changing() && !self.session.is_held() {
            return self.end_change(reply);
        }
        let waits = self.running.course.phase() == Phase::Waiting;
        if waits && !self.session.is_held() && self.running.course.resume().is_ok() {
            self.running.passed = self.running.next + 1;
        } else {
            self.put(Realtime::Resume)?;
        }
        reply.ok();
        Ok(())
    }

    /// Waits after each line, or no more.
    pub(super) fn set_single_block(&mut self, is_on: bool, reply: Reply) {
        self.running.course.single_block = is_on;
        reply.ok();
    }

    /// Waits before these lines.
    pub(super) fn set_breakpoints(&mut self, lines: Vec<usize>, reply: Reply) {
        self.running.course.breakpoints = lines.into_iter().collect();
        reply.ok();
    }

    /// Sends the lines for which the controller has room.
    ///
    /// # Errors
    ///
    /// The controller is lost.
    pub(super) fn feed_program(&mut self) -> Result<(), String> {
        let lines = Arc::clone(&self.running.lines);
        while self.running.course.phase() == Phase::Running && self.halting.is_none() {
            if self.running.is_synchronising {
                break;
            }
            let next = lines.get(self.running.next);
            let waits = self.running.is_at_breakpoint() || self.next_change().is_some();
            let (line, purpose) = match next {
                Some((_, line)) if !waits => (line.as_str(), Purpose::Program),
                // All lines before are made when a dwell is answered.
                _ => (SYNCHRONISE, Purpose::Synchronise),
            };
            if !self.stream.has_room(line) {
                break;
            }
            match purpose {
                Purpose::Program => self.running.next += 1,
                _ => self.running.is_synchronising = true,
            }
            self.machine.tell(From::Host, line);
            self.session.put(format!("{line}\n").as_bytes())?;
            self.stream.sent(line, purpose);
        }
        Ok(())
    }

    /// A line of the program was accepted, or refused.
    ///
    /// # Errors
    ///
    /// The controller is lost.
    pub(super) fn program_answered(&mut self, result: Result<(), String>) -> Result<(), String> {
        let line = self.running.lines.get(self.running.answered).cloned();
        match (result, line) {
            (Err(why), Some((number, line))) if self.running.course.phase() != Phase::Failed => {
                self.fail_program(&format!("line {number}, {line}: {why}"));
                self.begin_halt(false, "a line of the program was refused")?;
            }
            (Ok(()), _) => self.running.answered += 1,
            _ => {}
        }
        Ok(())
    }

    /// All lines that were sent are made.
    pub(super) fn synchronised(&mut self) {
        if self.next_change().is_some() && self.running.course.phase() == Phase::Running {
            return self.begin_change();
        }
        let running = &mut *self.running;
        if running.course.phase() != Phase::Running {
            // The line before was refused, or STOP was pressed.
            running.is_synchronising = false;
        } else if running.next < running.lines.len() {
            running.is_synchronising = false;
            running.course.wait(None);
        } else {
            // Until then no further line is sent.
            running.is_made = true;
        }
    }

    /// The controller has reported. A program that is made ends with this position.
    pub(super) fn program_reported(&mut self) {
        let running = &mut *self.running;
        if !std::mem::take(&mut running.is_made) {
            return;
        }
        running.is_synchronising = false;
        if running.course.phase() != Phase::Running {
            return;
        }
        let program = running.course.program();
        let times = program.and_then(|program| program.times.as_ref());
        running.done_s = times.map_or(running.done_s, |times| times.total_s());
        let count = running.lines.len() - running.before;
        let message = format!("{count} lines made; {}", self.session.stands());
        running.course.done(self.machine, message);
    }

    /// The program cannot go on.
    pub(super) fn fail_program(&mut self, why: &str) {
        let next = self.first_open();
        self.running.course.fail(self.machine, why, next);
    }

    /// STOP was pressed.
    pub(super) fn stop_program(&mut self) {
        let next = self.first_open();
        self.running.course.stop(next);
    }

    /// The machine stands after a stop, or its lines are lost.
    pub(super) fn end_program(&mut self, why: &str) {
        self.running.is_synchronising = false;
        self.running.is_made = false;
        let next = self.first_open();
        self.running.course.end(self.machine, why, next);
        self.running.changing = None;
    }

    /// The first line that is not certainly made.
    fn first_open(&self) -> Option<usize> {
        if self.running.changing.is_some() {
            // Whether the tool is in is not known: it is asked for again.
            return self.next_change().map(|change| change.line);
        }
        self.running.open(self.queue_moves)
    }

    /// An alarm has come.
    pub(super) fn note_alarm(&mut self, why: &str) {
        if let Some(record) = self.running.course.record() {
            record.alarm(format!("alarm: {why}"));
        }
    }

    /// Notes what has changed in a run, and publishes its record when it has ended.
    pub(super) fn note_run(&mut self) {
        let phase = self.running.phase_name(self.session.is_held());
        let overrides = self.state.overrides.clone();
        let shown = self.state.program.as_ref();
        let line = shown.and_then(|program| program["line"].as_u64());
        let line = line.map_or(0, |line| line as usize);
        let running = &mut *self.running;
        let before = std::mem::replace(&mut running.noted, overrides.clone());
        if let (Some(record), Some(all)) = (running.course.record(), overrides) {
            if before.as_ref() != Some(&all) {
                record.event(format!(
                    "overrides: feed {} %, rapids {} %, spindle {} %",
                    all["feed"], all["rapid"], all["spindle"]
                ));
            }
        }
        let next = running.lines.get(running.next);
        let next = next.map_or(0, |(number, _)| *number);
        let made = [running.answered, running.lines.len()];
        running.course.note(self.machine, phase, [line, next], made);
    }

    /// The program in the state of the machine. Progress goes on by the simulated time, between the
    /// line that is made and the last one that is answered.
    pub(super) fn program_shown(&mut self) -> Option<Value> {
        let is_moving = self.session.state() == Some(State::Run);
        let is_held = self.session.is_held();
        let free = self.session.status().and_then(|status| status.free);
        let waiting = free.map(|(moves, _)| self.queue_moves.saturating_sub(moves.into()));
        let most_waiting = self.queue_moves;
        let percent = |name: &str| {
            let overrides = self.state.overrides.as_ref();
            overrides
                .and_then(|all| all[name].as_f64())
                .unwrap_or(100.0)
        };
        let (feed, rapid) = (percent("feed"), percent("rapid"));
        let running = &mut *self.running;
        let program = Arc::clone(running.course.program()?);
        // Reports without the room in the queue (bit 1 of `$10`) leave the time to tell the line.
        let timed = program.times.as_ref().filter(|_| waiting.is_none());
        let line = match (timed, running.line(0)) {
            (Some(times), Some(last)) if running.course.phase() != Phase::Done => {
                Some(times.line_at(running.done_s).min(last))
            }
            (Some(_), last) => last,
            (None, _) => running.line(waiting.unwrap_or(most_waiting)),
        };
        let now = Instant::now();
        let passed = running
            .turned_at
            .replace(now)
            .map_or(Duration::ZERO, |then| now - then);
        if running.course.phase() == Phase::Running && is_moving {
            running.course.elapsed += passed;
            running.done_s += passed.as_secs_f64() * feed / 100.0;
        }
        let times = program.times.as_ref();
        let mut left_s = None;
        if let (Some(times), Some(line)) = (times, line) {
            let last = running.answered.checked_sub(1);
            let last = last
                .and_then(|last| running.lines.get(last))
                .map_or(0, |(line, _)| *line);
            if running.course.phase() != Phase::Done {
                let least = match timed {
                    Some(_) => 0.0,
                    None => times.end_s(line.saturating_sub(1)),
                };
                let most = times.end_s(last).max(least);
                running.done_s = running.done_s.clamp(least, most);
            }
            left_s = Some(times.left_s(line, running.done_s, feed, rapid));
        }
        let total_s = times.map(|times| times.total_s());
        let progress = total_s
            .filter(|total| *total > 0.0)
            .map(|total| running.done_s / total);
        let next = running.next_number();
        let change = running.changing.as_ref().map(Changing::shown);
        let mut shown = running.course.shown(&Progress {
            phase: running.phase_name(is_held),
            line,
            sent: running.next,
            answered: running.answered,
            of: running.lines.len(),
            time_s: total_s,
            remaining_s: left_s,
            progress,
            next,
        })?;
        shown["change"] = change.filter(|_| self.is_changing()).unwrap_or_default();
        Some(shown)
    }
}
