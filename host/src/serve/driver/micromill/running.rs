//! A program: each line is sent when the one before is made.

use super::orders::{Purpose, Sent};
use super::{Driver, From};
use crate::serve::driver::phase::Phase;
use crate::serve::loaded::Loaded;
use crate::serve::mill_program;
use crate::serve::reply::Reply;
use crate::serve::run_record::RunRecord;
use husillo_clients::micromill::Translated;
use husillo_transports::micromill::{Line, Order};
use serde_json::{Value, json};
use std::collections::BTreeSet;
use std::sync::{Arc, PoisonError};
use std::time::Duration;

/// The program of a mill.
#[derive(Debug, Default)]
pub(super) struct Running {
    program: Option<Arc<Loaded>>,
    /// Its lines for the mill, with their numbers, as they are sent.
    lines: Vec<(usize, Line)>,
    record: Option<RunRecord>,
    noted: &'static str,
    runs: u64,
    loads: u64,
    phase: Phase,
    /// Lines that are made. The next one is being made, or is sent next.
    made: usize,
    /// The operator has let the line before which the program waits pass.
    is_passed: bool,
    /// It waits before the next line, because the operator has asked for that.
    pauses: bool,
    pub(super) single_block: bool,
    pub(super) breakpoints: BTreeSet<usize>,
    message: Option<String>,
    resume_line: Option<usize>,
    /// Time of the session when the run, or the last line, was looked at.
    looked_at: Duration,
    /// Time in motion.
    elapsed: Duration,
    /// Simulated time that is done, s.
    done_s: f64,
}

impl Running {
    /// Whether lines are sent, or will be.
    pub(super) const fn is_active(&self) -> bool {
        matches!(
            self.phase,
            Phase::Running | Phase::Waiting | Phase::Stopping
        )
    }

    /// Whether a line is made, or is sent next.
    pub(super) const fn is_moving(&self) -> bool {
        matches!(self.phase, Phase::Running)
    }

    fn next(&self) -> Option<(usize, Line)> {
        self.lines.get(self.made).copied()
    }

    /// Whether the program waits before its next line.
    fn must_wait(&self) -> bool {
        let Some((number, line)) = self.next() else {
            return false;
        };
        // Another tool is put in by the operator.
        let is_tool = matches!(line, Line::Tool(_));
        let is_wanted = self.pauses || is_tool || self.breakpoints.contains(&number);
        (is_wanted || (self.single_block && self.made > 0)) && !self.is_passed
    }
}

impl Driver<'_> {
    /// Takes a program that was checked.
    pub(super) fn load(&mut self, program: Arc<Loaded>, reply: Reply) {
        if self.running.is_active() {
            return reply.error("a program runs: stop it first");
        }
        self.machine
            .tell(From::Server, format!("{} is loaded", program.name));
        *self.running = Running {
            resume_line: program.resume_line,
            program: Some(program),
            loads: self.running.loads + 1,
            runs: self.running.runs,
            single_block: self.running.single_block,
            ..Running::default()
        };
        reply.ok();
    }

    /// Forgets the program.
    pub(super) fn unload(&mut self, reply: Reply) {
        if self.running.is_active() {
            return reply.error("a program runs: stop it first");
        }
        let mut program = self
            .machine
            .program
            .lock()
            .unwrap_or_else(PoisonError::into_inner);
        *program = None;
        *self.running = Running {
            loads: self.running.loads,
            runs: self.running.runs,
            single_block: self.running.single_block,
            ..Running::default()
        };
        reply.ok();
    }

    /// Starts the program at its first line or at `from`, or tells what would happen.
    pub(super) fn run(&mut self, is_confirmed: bool, from: Option<usize>, reply: Reply) {
        let (program, made) = match self.may_run(from) {
            Ok(may) => may,
            Err(why) => return reply.error(why),
        };
        if is_confirmed {
            // The check may have taken long.
            if self.machine.stop.is_asked() {
                return reply.error("the machine is being stopped");
            }
            self.start(program, made, from);
            return reply.ok();
        }
        let before = made.lines.iter().take_while(|(line, _)| Some(*line) < from);
        let before: Vec<_> = before
            .map(|(_, line)| mill_program::string(*line))
            .collect();
        let is_whole = from.is_none();
        let whole_s = program.times.as_ref().map(|times| times.total_s());
        reply.data(json!({
            "name": program.name,
            "lines": made.lines.len(),
            "time_s": whole_s.filter(|_| is_whole),
            "work_mm": self.state.work_mm,
            "from": from,
            "before": before,
        }));
    }

    /// The program and its lines from where the mill stands, if it may be run.
    fn may_run(&self, from: Option<usize>) -> Result<(Arc<Loaded>, Translated), String> {
        self.is_free()?;
        let program = self.running.program.clone().ok_or("no program is loaded")?;
        if program.errors > 0 {
            return Err("the program has errors: correct them first".into());
        }
        if !self.place.is_homed() {
            return Err("home the mill first: it does not know where it is".into());
        }
        let around = self.surroundings();
        if !around.are_those_of(&program.around) {
            return Err(
                "the work zero has changed since the program was checked: load it \
                        again"
                    .into(),
            );
        }
        let mut made = mill_program::lines(&program.name, &program.text, &around)?;
        if let Some(from) = from {
            made = made.resumed_at(from, self.place.state(), self.place.config())?;
        }
        match made.lines.is_empty() {
            true => Err("the program has no commands".into()),
            false => Ok((program, made)),
        }
    }

    fn start(&mut self, program: Arc<Loaded>, made: Translated, from: Option<usize>) {
        let how = from.map_or("starts".into(), |line| format!("goes on from line {line}"));
        let text = format!("{} {how}", program.name);
        self.machine.tell(From::Server, text);
        let times = program.times.as_ref();
        let done_s = from
            .zip(times)
            .map(|(line, times)| times.end_s(line.saturating_sub(1)));
        let running = &mut *self.running;
        *running = Running {
            record: Some(RunRecord::new(Arc::clone(&program), from)),
            program: Some(program),
            lines: made.lines,
            loads: running.loads,
            runs: running.runs,
            phase: Phase::Running,
            single_block: running.single_block,
            breakpoints: std::mem::take(&mut running.breakpoints),
            looked_at: self.session.elapsed(),
            done_s: done_s.unwrap_or(0.0),
            ..Running::default()
        };
        self.begin_path();
    }

    /// Waits before the next line. A line that is being made is made to its end.
    ///
    /// # Errors
    ///
    /// No program runs.
    pub(super) fn pause(&mut self) -> Result<(), &'static str> {
        match self.running.phase {
            Phase::Running | Phase::Waiting => {
                self.running.pauses = true;
                Ok(())
            }
            _ => Err("no program runs"),
        }
    }

    /// Goes on after a wait.
    ///
    /// # Errors
    ///
    /// Nothing waits.
    pub(super) fn resume(&mut self) -> Result<(), &'static str> {
        let running = &mut *self.running;
        let is_pausing = running.pauses && running.phase == Phase::Running;
        if running.phase != Phase::Waiting && !is_pausing {
            return Err("nothing waits");
        }
        running.is_passed = running.phase == Phase::Waiting;
        running.pauses = false;
        running.phase = Phase::Running;
        running.message = None;
        Ok(())
    }

    /// Sends the next line, if the one before is made.
    pub(super) fn feed_program(&mut self) {
        if self.running.phase != Phase::Running || self.is_busy() {
            return;
        }
        let Some((_, line)) = self.running.next() else {
            return;
        };
        if self.running.must_wait() {
            self.running.phase = Phase::Waiting;
            self.running.pauses = false;
            if let Line::Tool(tool) = line {
                self.running.message = Some(format!("put in tool {tool}, then resume"));
            }
            return;
        }
        self.running.is_passed = false;
        let order = Order::Line(line);
        self.waiting.push_back(Sent::new(order, Purpose::Program));
    }

    /// A line is made, or is not.
    ///
    /// # Errors
    ///
    /// The controller does not answer.
    pub(super) fn program_answered(&mut self, result: Result<(), &str>) -> Result<(), String> {
        let Some((number, line)) = self.running.next() else {
            return Ok(());
        };
        if let Err(why) = result {
            self.ask_place(Order::Line(line))?;
            let string = mill_program::string(line);
            self.fail_program(format!("line {number}, {string}: {why}"));
            return Ok(());
        }
        self.running.made += 1;
        let is_made = self.running.next().is_none();
        // A line that sets the work zero changes where everything is.
        if is_made || matches!(line, Line::Zero) {
            self.ask_place(Order::Line(line))?;
        }
        if is_made {
            let running = &mut *self.running;
            running.phase = Phase::Done;
            let times = running.program.as_ref().and_then(|of| of.times.as_ref());
            running.done_s = times.map_or(running.done_s, |times| times.total_s());
            let message = format!("{} lines made", running.lines.len());
            self.machine.tell(From::Server, message.as_str());
            running.message = Some(message);
        }
        Ok(())
    }

    fn fail_program(&mut self, why: String) {
        if self.running.is_active() {
            self.running.phase = Phase::Failed;
            let text = format!("{why}; {}", self.lines_made());
            self.machine.tell(From::Server, text.as_str());
            self.running.message = Some(text);
        }
    }

    /// STOP was pressed.
    pub(super) fn stop_program(&mut self) {
        if self.running.is_active() {
            self.running.phase = Phase::Stopping;
            self.running.message = Some(format!("stopped; {}", self.lines_made()));
        }
    }

    /// The machine stands after a stop, or the controller is lost.
    pub(super) fn end_program(&mut self, why: &str) {
        match self.running.phase {
            Phase::Stopping => self.running.phase = Phase::Stopped,
            _ => self.fail_program(why.to_owned()),
        }
    }

    /// Which lines are made. The next one is that with which the program goes on.
    fn lines_made(&mut self) -> String {
        self.running.resume_line = self.running.next().map(|(number, _)| number);
        match self.running.resume_line {
            Some(number) => format!("all lines before line {number} are made"),
            None => "all lines are made".into(),
        }
    }

    /// Notes what has changed in a run, and publishes its record when it has ended.
    pub(super) fn note_run(&mut self) {
        let running = &mut *self.running;
        let Some(record) = &mut running.record else {
            return;
        };
        let phase = running.phase.name();
        let before = std::mem::replace(&mut running.noted, phase);
        let line = running.lines.get(running.made).map_or(0, |(line, _)| *line);
        match phase {
            _ if phase == before => {}
            "stopping" => record.stop(format!("STOP at line {line}")),
            "waiting" => record.event(format!("waits before line {line}")),
            "running" if before == "waiting" => record.event("goes on"),
            _ => {}
        }
        if running.is_active() {
            return;
        }
        if let Some(mut record) = running.record.take() {
            let made = [running.made, running.lines.len()];
            let result = running.message.as_deref().unwrap_or(phase);
            record.end(result, made, running.elapsed.as_secs_f64());
            running.runs += 1;
            let mut last = self
                .machine
                .run
                .lock()
                .unwrap_or_else(PoisonError::into_inner);
            *last = Some(Arc::new(record));
        }
    }

    /// The program in the state of the machine. Progress goes on by the simulated time within a
    /// line.
    pub(super) fn program_shown(&mut self) -> Option<Value> {
        let now = self.session.elapsed();
        let running = &mut *self.running;
        let program = Arc::clone(running.program.as_ref()?);
        let passed = now.saturating_sub(std::mem::replace(&mut running.looked_at, now));
        let next = running.lines.get(running.made).map(|(line, _)| *line);
        let last = running.lines.last().map(|(line, _)| *line);
        let line = match running.phase {
            Phase::Loaded => None,
            _ => next.or(last),
        };
        let times = program.times.as_ref();
        if running.phase == Phase::Running {
            running.elapsed += passed;
            if let (Some(times), Some(line)) = (times, line) {
                let least = times.end_s(line.saturating_sub(1));
                let most = times.end_s(line).max(least);
                running.done_s = (running.done_s + passed.as_secs_f64()).clamp(least, most);
            }
        }
        let total_s = times.map(|times| times.total_s());
        let left_s = total_s.map(|total_s| (total_s - running.done_s).max(0.0));
        let is_begun = running.phase != Phase::Loaded;
        // Tenths, so that a state does not change without need.
        let tenths = |s: f64| (s * 10.0).round() / 10.0;
        let progress = total_s
            .filter(|total| *total > 0.0)
            .map(|total| (running.done_s / total).clamp(0.0, 1.0));
        Some(json!({
            "name": program.name,
            "lines": program.count,
            "errors": program.errors,
            "warnings": program.warnings,
            "load": running.loads,
            "phase": running.phase.name(),
            "line": line,
            "sent": running.made,
            "answered": running.made,
            "of": if is_begun { running.lines.len() } else { program.lines.len() },
            "time_s": total_s,
            "elapsed_s": tenths(running.elapsed.as_secs_f64()),
            "remaining_s": left_s.filter(|_| is_begun).map(tenths),
            "progress": progress.map(|part| (part * 1e3).round() / 1e3),
            "single_block": running.single_block,
            "breakpoints": running.breakpoints,
            "waits_before": next.filter(|_| running.phase == Phase::Waiting),
            "message": running.message,
            "resume_line": running.resume_line,
            "runs": running.runs,
        }))
    }
}
