//! A program: each line is sent when the one before is made.

use super::Driver;
use super::orders::{Purpose, Sent};
use crate::serve::driver::course::{Course, Progress};
use crate::serve::driver::phase::Phase;
use crate::serve::loaded::Loaded;
use crate::serve::mill_program;
use crate::serve::reply::Reply;
use husillo_clients::micromill::Translated;
use husillo_transports::micromill::{Line, Order};
use serde_json::{Value, json};
use std::sync::Arc;
use std::time::Duration;

/// The program of a mill.
#[derive(Debug, Default)]
pub(super) struct Running {
    pub(super) course: Course,
    /// Its lines for the mill, with their numbers, as they are sent.
    lines: Vec<(usize, Line)>,
    /// Lines that are made. The next one is being made, or is sent next.
    made: usize,
    /// Time of the session when the run, or the last line, was looked at.
    looked_at: Duration,
    /// Simulated time that is done, s.
    done_s: f64,
}

impl Running {
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
        let course = &self.course;
        let is_wanted = course.pauses || is_tool || course.breakpoints.contains(&number);
        (is_wanted || (course.single_block && self.made > 0)) && !course.is_passed
    }
}

impl Driver<'_> {
    /// Takes a program that was checked.
    pub(super) fn load(&mut self, program: Arc<Loaded>, reply: Reply) {
        if self.running.course.is_active() {
            return reply.error("a program runs: stop it first");
        }
        let mut course = std::mem::take(&mut self.running.course);
        course.load(self.machine, program);
        *self.running = Running {
            course,
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
        let program = self.running.course.program().cloned();
        let program = program.ok_or("no program is loaded")?;
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
        let times = program.times.as_ref();
        let done_s = from
            .zip(times)
            .map(|(line, times)| times.end_s(line.saturating_sub(1)));
        let mut course = std::mem::take(&mut self.running.course);
        course.start(self.machine, program, from);
        *self.running = Running {
            course,
            lines: made.lines,
            looked_at: self.session.elapsed(),
            done_s: done_s.unwrap_or(0.0),
            ..Running::default()
        };
        self.begin_path();
    }

    /// Sends the next line, if the one before is made.
    pub(super) fn feed_program(&mut self) {
        if self.running.course.phase() != Phase::Running || self.is_busy() {
            return;
        }
        let Some((_, line)) = self.running.next() else {
            return;
        };
        if self.running.must_wait() {
            let tool = match line {
                Line::Tool(tool) => Some(format!("put in tool {tool}, then resume")),
                _ => None,
            };
            self.running.course.wait(tool);
            return;
        }
        self.running.course.is_passed = false;
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
            self.fail_program(&format!("line {number}, {string}: {why}"));
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
            let program = running.course.program();
            let times = program.and_then(|of| of.times.as_ref());
            running.done_s = times.map_or(running.done_s, |times| times.total_s());
            let message = format!("{} lines made", running.lines.len());
            running.course.done(self.machine, message);
        }
        Ok(())
    }

    fn fail_program(&mut self, why: &str) {
        let next = self.running.next().map(|(number, _)| number);
        self.running.course.fail(self.machine, why, next);
    }

    /// STOP was pressed.
    pub(super) fn stop_program(&mut self) {
        let next = self.running.next().map(|(number, _)| number);
        self.running.course.stop(next);
    }

    /// The machine stands after a stop, or the controller is lost.
    pub(super) fn end_program(&mut self, why: &str) {
        let next = self.running.next().map(|(number, _)| number);
        self.running.course.end(self.machine, why, next);
    }

    /// Notes what has changed in a run, and publishes its record when it has ended.
    pub(super) fn note_run(&mut self) {
        let running = &mut *self.running;
        let line = running.next().map_or(0, |(number, _)| number);
        let made = [running.made, running.lines.len()];
        let phase = running.course.phase().name();
        running.course.note(self.machine, phase, [line; 2], made);
    }

    /// The program in the state of the machine. Progress goes on by the simulated time within a
    /// line.
    pub(super) fn program_shown(&mut self) -> Option<Value> {
        let now = self.session.elapsed();
        let running = &mut *self.running;
        let program = Arc::clone(running.course.program()?);
        let passed = now.saturating_sub(std::mem::replace(&mut running.looked_at, now));
        let next = running.lines.get(running.made).map(|(line, _)| *line);
        let last = running.lines.last().map(|(line, _)| *line);
        let line = next.or(last);
        let times = program.times.as_ref();
        if running.course.phase() == Phase::Running {
            running.course.elapsed += passed;
            if let (Some(times), Some(line)) = (times, line) {
                let least = times.end_s(line.saturating_sub(1));
                let most = times.end_s(line).max(least);
                running.done_s = (running.done_s + passed.as_secs_f64()).clamp(least, most);
            }
        }
        let total_s = times.map(|times| times.total_s());
        let left_s = total_s.map(|total_s| (total_s - running.done_s).max(0.0));
        let progress = total_s
            .filter(|total| *total > 0.0)
            .map(|total| running.done_s / total);
        let is_begun = running.course.phase() != Phase::Loaded;
        let of = match is_begun {
            true => running.lines.len(),
            false => program.lines.len(),
        };
        running.course.shown(&Progress {
            phase: running.course.phase().name(),
            line,
            sent: running.made,
            answered: running.made,
            of,
            time_s: total_s,
            remaining_s: left_s,
            progress,
            next,
        })
    }
}
