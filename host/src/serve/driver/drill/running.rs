//! A program: each hole is made record by record, and the next one begins when it is made.

use super::Driver;
use super::bench::{Bench, Work};
use super::stepping::Trouble;
use crate::serve::console_lines::From;
use crate::serve::drill_program::Hole;
use crate::serve::driver::course::{Course, Progress};
use crate::serve::driver::phase::Phase;
use crate::serve::loaded::Loaded;
use crate::serve::tool_path::Motion;
use husillo_transports::drill::{Record, Step, Table};
use serde_json::{Value, json};
use std::sync::Arc;
use std::time::Duration;

/// What is made next.
#[derive(Clone, Debug)]
enum Next {
    /// The hole with this index.
    Hole(usize),
    /// The move home after the holes of a tool.
    Home(usize),
}

/// The program of a drill.
#[derive(Debug, Default)]
pub(super) struct Running {
    pub(super) course: Course,
    /// Holes that are made.
    made: usize,
    /// Parts whose move home is made.
    returned: usize,
    /// The zero from which the holes of the references were measured.
    pub(super) measured_zero: Option<[u16; 2]>,
    /// The zero from which holes were drilled.
    drilled_zero: Option<[u16; 2]>,
    /// Time of the link when the run was looked at.
    looked_at: Duration,
    /// Time in motion at the begin of what is being made.
    begun: Duration,
    /// Estimated time that was done at the start, and is done, s.
    done_s: [f64; 2],
}

impl Running {
    fn hole(&self, index: usize) -> Option<&Hole> {
        let program = self.course.program()?;
        program.holes.as_ref()?.holes.get(index)
    }

    /// The number of the next hole.
    fn next_hole(&self) -> Option<usize> {
        self.hole(self.made).map(|_| self.made + 1)
    }

    fn next(&self) -> Option<Next> {
        let before = self.made.checked_sub(1).and_then(|last| self.hole(last));
        let next = self.hole(self.made);
        let part = before.map(|hole| hole.part);
        let is_over = next.map(|hole| hole.part) != part;
        match (part, next) {
            (Some(part), _) if is_over && self.returned <= part => Some(Next::Home(part)),
            (_, Some(_)) => Some(Next::Hole(self.made)),
            (_, None) => None,
        }
    }

    /// Estimated seconds of what is made next.
    fn next_s(&self) -> f64 {
        let program = self.course.program().and_then(|one| one.holes.as_ref());
        match (program, self.next()) {
            (Some(program), Some(Next::Home(part))) => program.back_s(part),
            (_, Some(Next::Hole(index))) => self.hole(index).map_or(0.0, |hole| hole.seconds),
            _ => 0.0,
        }
    }

    /// Whether the tool of this hole is another one than before.
    fn is_new_tool(&self, index: usize) -> bool {
        let part = |index: usize| self.hole(index).map(|hole| hole.part);
        index > 0 && part(index) != part(index - 1)
    }

    /// Whether it waits before this hole.
    fn must_wait(&self, index: usize) -> bool {
        let course = &self.course;
        let is_due = course.pauses
            || self.is_new_tool(index)
            || course.single_block && course.elapsed > Duration::ZERO
            || course.breakpoints.contains(&(index + 1));
        is_due && !course.is_passed
    }
}

impl Bench<'_> {
    /// Takes over a program that was checked.
    ///
    /// # Errors
    ///
    /// A program runs.
    pub(super) fn load(&mut self, program: Arc<Loaded>) -> Result<(), String> {
        self.is_free()?;
        let mut course = std::mem::take(&mut self.running.course);
        course.load(self.machine, program);
        *self.running = Running {
            course,
            ..Running::default()
        };
        Ok(())
    }

    /// Forgets the program.
    pub(super) fn unload(&mut self) -> Result<(), Trouble> {
        self.is_free().map_err(Trouble::Refused)?;
        let mut course = std::mem::take(&mut self.running.course);
        course.unload(self.machine);
        *self.running = Running {
            course,
            ..Running::default()
        };
        Ok(())
    }

    fn fail_program(&mut self, why: &str) {
        let next = self.running.next_hole();
        self.running.course.fail(self.machine, why, next);
    }

    /// STOP was pressed.
    pub(super) fn stop_program(&mut self) {
        let next = self.running.next_hole();
        self.running.course.stop(next);
    }

    /// The machine stands after a stop, or the controller is lost.
    pub(super) fn end_program(&mut self, why: &str) {
        let next = self.running.next_hole();
        self.running.course.end(self.machine, why, next);
    }

    /// Notes what has changed in a run, and publishes its record when it has ended.
    pub(super) fn note_run(&mut self) {
        let running = &mut *self.running;
        let count = running.course.program().map_or(0, |program| program.count);
        let (hole, made) = (running.made + 1, [running.made, count]);
        let phase = running.course.phase().name();
        running.course.note(self.machine, phase, [hole; 2], made);
    }

    /// The program in the state of the machine. Its holes are what others call lines.
    pub(super) fn program_shown(&mut self) -> Option<Value> {
        let now = self.now;
        let running = &mut *self.running;
        let program = Arc::clone(running.course.program()?);
        let passed = now.saturating_sub(std::mem::replace(&mut running.looked_at, now));
        let is_moving = running.course.phase() == Phase::Running;
        if is_moving {
            running.course.elapsed += passed;
        }
        let total_s = program.holes.as_ref().map(|holes| holes.total_s());
        let total_s = total_s.filter(|_| program.errors == 0);
        let [start_s, done_s] = running.done_s;
        // The link and the motors are as fast as they were until now.
        let pace = match done_s - start_s {
            made_s if made_s > 1.0 => (running.begun.as_secs_f64() / made_s).max(0.1),
            _ => 1.0,
        };
        let within_s = match is_moving {
            true => (running.course.elapsed - running.begun).as_secs_f64() / pace,
            false => 0.0,
        };
        let at_s = done_s + within_s.min(running.next_s());
        let left_s = total_s.map(|total_s| (total_s - at_s).max(0.0) * pace);
        let progress = total_s
            .filter(|total| *total > 0.0)
            .map(|total| at_s / total);
        let next = running.next_hole();
        running.course.shown(&Progress {
            phase: running.course.phase().name(),
            line: next.or((running.made > 0).then_some(running.made)),
            sent: running.made,
            answered: running.made,
            of: program.count,
            time_s: total_s,
            remaining_s: left_s,
            progress,
            next,
        })
    }
}

impl Driver<'_> {
    /// Starts the program at its first hole or at `from`, or tells what would happen.
    pub(super) fn run(
        &mut self,
        is_confirmed: bool,
        from: Option<usize>,
    ) -> Result<Value, Trouble> {
        let program = self.may_run(from).map_err(Trouble::Refused)?;
        let first = from.unwrap_or(1) - 1;
        if is_confirmed {
            // The check may have taken long.
            if self.bench.machine.stop.is_asked() {
                return Err(Trouble::refused("the machine is being stopped"));
            }
            self.idle()?;
            self.start(program, first, from);
            return Ok(Value::Null);
        }
        let holes = program.holes.as_ref();
        let total_s = holes.map(|holes| holes.total_s());
        let tool = holes.and_then(|holes| {
            let hole = holes.holes.get(first)?;
            let part = holes.parts.get(hole.part)?;
            (part.tool > 0).then(|| part.name())
        });
        let records = self.bench.place.and_then(|place| place.records);
        let lost = match self.bench.taught.len() {
            0 => records.filter(|records| *records > 0).map(|records| {
                format!("the memory of the drill is cleared: its {records} records are lost")
            }),
            taught => Some(format!(
                "the memory of the drill is cleared: {taught} taught holes are lost"
            )),
        };
        let warnings = [tool.map(|tool| format!("put in {tool}")), lost];
        Ok(json!({
            "name": program.name,
            "lines": program.count - first,
            "time_s": total_s.filter(|_| from.is_none()),
            "work_mm": self.bench.state.work_mm,
            "from": from,
            "warnings": warnings.into_iter().flatten().collect::<Vec<_>>(),
        }))
    }

    /// The program, if it may be run.
    fn may_run(&self, from: Option<usize>) -> Result<Arc<Loaded>, String> {
        self.bench.is_free()?;
        let program = self.bench.running.course.program().cloned();
        let program = program.ok_or("no program is loaded")?;
        if program.errors > 0 {
            return Err("the program has errors: correct them first".into());
        }
        if from.is_some_and(|hole| hole == 0 || hole > program.count) {
            return Err(format!("the program has holes 1 to {}", program.count));
        }
        let place = self.bench.place;
        if !place.is_some_and(|place| place.machine.is_homed) {
            return Err("home the drill first: it does not know where it is".into());
        }
        let running = &self.bench.running;
        let drilled_zero = running.drilled_zero.filter(|_| from.is_some());
        let zeros = [running.measured_zero, drilled_zero];
        if zeros
            .into_iter()
            .flatten()
            .any(|zero| zero != self.bench.zero())
        {
            let done = match drilled_zero {
                Some(_) => "the first holes were drilled",
                None => "the board was measured",
            };
            return Err(format!(
                "the zero has changed since {done}: the holes would be at other places"
            ));
        }
        let [zero_x, zero_y] = self.bench.zero();
        let holes = program.holes.as_ref().map(|holes| &holes.holes[..]);
        let is_off = |hole: &&Hole| {
            let [x, y] = hole.at;
            x.saturating_add(zero_x) > Table::DRILL.x || y.saturating_add(zero_y) > Table::DRILL.y
        };
        match holes.unwrap_or_default().iter().filter(is_off).count() {
            0 => Ok(program),
            off => Err(format!(
                "{off} holes are off the table, because the zero is not at the switches: home"
            )),
        }
    }

    fn start(&mut self, program: Arc<Loaded>, first: usize, from: Option<usize>) {
        let holes = program.holes.as_ref().map(|holes| &holes.holes[..]);
        let holes = holes.unwrap_or_default();
        let done_s = holes.iter().take(first).map(|hole| hole.seconds).sum();
        let part = holes.get(first).map_or(0, |hole| hole.part);
        let zero = self.bench.zero();
        let running = &mut *self.bench.running;
        let mut course = std::mem::take(&mut running.course);
        course.start(self.bench.machine, program, from);
        // What was confirmed has named the tool.
        course.is_passed = true;
        *running = Running {
            course,
            made: first,
            returned: part,
            looked_at: self.bench.now,
            done_s: [done_s; 2],
            measured_zero: running.measured_zero,
            drilled_zero: Some(zero),
            ..Running::default()
        };
        self.bench.taught.clear();
        self.bench.begin_path();
    }

    /// Makes the next hole. Returns whether it was made.
    pub(super) fn feed_program(&mut self) -> Result<bool, Trouble> {
        if self.bench.running.course.phase() != Phase::Running {
            return Ok(false);
        }
        let Some(next) = self.bench.running.next() else {
            return Ok(false);
        };
        if let Next::Hole(index) = next {
            if self.bench.running.must_wait(index) {
                self.wait(index);
                return Ok(false);
            }
        }
        self.bench.running.begun = self.bench.running.course.elapsed;
        let seconds = self.bench.running.next_s();
        let made = match next {
            Next::Hole(index) => self.make(index),
            Next::Home(_) => self.go_to([0; 2]),
        };
        match made {
            Ok(()) => self.made(&next, seconds),
            Err(trouble @ Trouble::Lost(_)) => return Err(trouble),
            // The next turn ends the program.
            Err(Trouble::Halted(_)) => {}
            Err(trouble) => {
                let number = self.bench.running.made + 1;
                let why = format!("hole {number}: {}", trouble.text());
                self.bench.fail_program(&why);
            }
        }
        if !self.bench.running.course.is_active() {
            self.empty()?;
        }
        Ok(true)
    }

    fn wait(&mut self, index: usize) {
        let running = &mut *self.bench.running;
        let mut tool = None;
        if running.is_new_tool(index) {
            let program = running.course.program().and_then(|one| one.holes.as_ref());
            let part = running.hole(index).map(|hole| hole.part);
            let part = program
                .zip(part)
                .and_then(|(program, part)| program.parts.get(part));
            tool = part.map(|part| format!("put in {}, then resume", part.name()));
        }
        running.course.wait(tool);
    }

    fn made(&mut self, next: &Next, seconds: f64) {
        let running = &mut *self.bench.running;
        match next {
            Next::Hole(_) => {
                running.made += 1;
                running.course.is_passed = false;
            }
            Next::Home(part) => running.returned = part + 1,
        }
        running.done_s[1] += seconds;
        running.begun = running.course.elapsed;
        if running.next().is_none() {
            let message = format!("{} holes drilled", running.made);
            running.course.done(self.bench.machine, message);
        }
    }

    /// Drills a hole.
    fn make(&mut self, index: usize) -> Result<(), Trouble> {
        let Some(hole) = self.bench.running.hole(index).cloned() else {
            return Ok(());
        };
        self.go_to(hole.at)?;
        for depth in hole.depths {
            self.record(Record::Drill(depth))?;
        }
        let [x, y] = hole.at;
        let text = format!("hole {} drilled at {x},{y}", index + 1);
        self.bench.machine.tell(From::Server, text);
        Ok(())
    }

    /// Moves X, then Y.
    fn go_to(&mut self, to: [u16; 2]) -> Result<(), Trouble> {
        let [x, y] = to;
        for (axis, record) in [Record::X(x), Record::Y(y)].into_iter().enumerate() {
            if self.bench.at().get(axis) != to.get(axis) {
                self.record(record)?;
                let to = to.get(axis).copied().unwrap_or_default();
                self.bench.moved(axis, to, Motion::Rapid);
            }
        }
        Ok(())
    }

    /// Empties the memory of the drill of the last record. Holes that are taught begin there.
    pub(super) fn empty(&mut self) -> Result<(), Trouble> {
        let emptied = self.step(Step::Empty).and_then(|()| self.read_place());
        emptied.or_else(Trouble::unless_lost)
    }

    /// Sends a record as a program of its own, and runs it.
    fn record(&mut self, record: Record) -> Result<(), Trouble> {
        if self.bench.must_halt() {
            return Err(Trouble::Halted(self.bench.halting.unwrap_or("stopped")));
        }
        let is_drilling = matches!(record, Record::Drill(_));
        self.work(Work::Receive, Step::Empty)?;
        self.work(Work::Receive, Step::Begin)?;
        for byte in record.to_bytes() {
            self.work(Work::Receive, Step::Store(byte))?;
        }
        self.work(Work::Receive, Step::End)?;
        if is_drilling {
            self.spindle(true)?;
        }
        let work = match record {
            Record::X(_) => Work::X,
            Record::Y(_) => Work::Y,
            Record::Drill(_) => Work::Z,
        };
        self.work(work, Step::Execute)?;
        if is_drilling {
            // The controller stops the spindle at the end of a program.
            self.bench.has_spindle = false;
        }
        Ok(())
    }
}
