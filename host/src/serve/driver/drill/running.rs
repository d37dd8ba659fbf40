//! A program: each hole is made record by record, and the next one begins when it is made.

use super::Driver;
use super::bench::{Bench, Work};
use super::stepping::Trouble;
use crate::serve::console_lines::From;
use crate::serve::drill_program::Hole;
use crate::serve::driver::phase::Phase;
use crate::serve::loaded::Loaded;
use crate::serve::run_record::RunRecord;
use crate::serve::tool_path::Motion;
use husillo_transports::drill::{Record, Step, Table};
use serde_json::{Value, json};
use std::collections::BTreeSet;
use std::sync::{Arc, PoisonError};
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
    program: Option<Arc<Loaded>>,
    record: Option<RunRecord>,
    noted: &'static str,
    runs: u64,
    loads: u64,
    phase: Phase,
    /// Holes that are made.
    made: usize,
    /// Parts whose move home is made.
    returned: usize,
    /// The operator has let the hole before which the program waits pass.
    is_passed: bool,
    /// It waits before the next hole, because the operator has asked for that.
    pauses: bool,
    pub(super) single_block: bool,
    pub(super) breakpoints: BTreeSet<usize>,
    message: Option<String>,
    resume_hole: Option<usize>,
    /// The zero from which the holes of the references were measured.
    pub(super) measured_zero: Option<[u16; 2]>,
    /// The zero from which holes were drilled.
    drilled_zero: Option<[u16; 2]>,
    /// Time of the link when the run was looked at.
    looked_at: Duration,
    /// Time in motion.
    elapsed: Duration,
    /// Time in motion at the begin of what is being made.
    begun: Duration,
    /// Estimated time that was done at the start, and is done, s.
    done_s: [f64; 2],
}

impl Running {
    /// Whether holes are made, or will be.
    pub(super) const fn is_active(&self) -> bool {
        matches!(
            self.phase,
            Phase::Running | Phase::Waiting | Phase::Stopping
        )
    }

    /// Whether a hole is being made.
    pub(super) const fn is_moving(&self) -> bool {
        matches!(self.phase, Phase::Running)
    }

    /// The loaded program.
    pub(super) fn program(&self) -> Option<Arc<Loaded>> {
        self.program.clone()
    }

    fn hole(&self, index: usize) -> Option<&Hole> {
        let program = self.program.as_ref()?;
        program.holes.as_ref()?.holes.get(index)
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
        let program = self.program.as_ref().and_then(|one| one.holes.as_ref());
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
        let is_due = self.pauses
            || self.is_new_tool(index)
            || self.single_block && self.elapsed > Duration::ZERO
            || self.breakpoints.contains(&(index + 1));
        is_due && !self.is_passed
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
        self.machine
            .tell(From::Server, format!("{} is loaded", program.name));
        let running = &mut *self.running;
        *running = Running {
            resume_hole: program.resume_line,
            program: Some(program),
            loads: running.loads + 1,
            runs: running.runs,
            single_block: running.single_block,
            ..Running::default()
        };
        Ok(())
    }

    /// Forgets the program.
    pub(super) fn unload(&mut self) -> Result<(), Trouble> {
        self.is_free().map_err(Trouble::Refused)?;
        let mut program = self
            .machine
            .program
            .lock()
            .unwrap_or_else(PoisonError::into_inner);
        *program = None;
        let running = &mut *self.running;
        *running = Running {
            loads: running.loads,
            runs: running.runs,
            single_block: running.single_block,
            ..Running::default()
        };
        Ok(())
    }

    /// Waits before the next hole. A hole that is being drilled is drilled to its end.
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

    fn fail_program(&mut self, why: &str) {
        if self.running.is_active() {
            self.running.phase = Phase::Failed;
            let text = format!("{why}; {}", self.holes_made());
            self.machine.tell(From::Server, text.as_str());
            self.running.message = Some(text);
        }
    }

    /// STOP was pressed.
    pub(super) fn stop_program(&mut self) {
        if self.running.is_active() {
            self.running.phase = Phase::Stopping;
            self.running.message = Some(format!("stopped; {}", self.holes_made()));
        }
    }

    /// The machine stands after a stop, or the controller is lost.
    pub(super) fn end_program(&mut self, why: &str) {
        match self.running.phase {
            Phase::Stopping => self.running.phase = Phase::Stopped,
            _ => self.fail_program(why),
        }
    }

    /// Which holes are made. The next one is that with which the program goes on.
    fn holes_made(&mut self) -> String {
        let running = &mut *self.running;
        let next = running.made + 1;
        running.resume_hole = running.hole(running.made).map(|_| next);
        match running.resume_hole {
            Some(1) => "no hole is drilled".into(),
            Some(number) => format!("all holes before hole {number} are drilled"),
            None => "all holes are drilled".into(),
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
        let number = running.made + 1;
        match phase {
            _ if phase == before => {}
            "stopping" => record.stop(format!("STOP at hole {number}")),
            "waiting" => record.event(format!("waits before hole {number}")),
            "running" if before == "waiting" => record.event("goes on"),
            _ => {}
        }
        if running.is_active() {
            return;
        }
        if let Some(mut record) = running.record.take() {
            let all = record.program.count;
            let result = running.message.as_deref().unwrap_or(phase);
            record.end(result, [running.made, all], running.elapsed.as_secs_f64());
            running.runs += 1;
            let mut last = self
                .machine
                .run
                .lock()
                .unwrap_or_else(PoisonError::into_inner);
            *last = Some(Arc::new(record));
        }
    }

    /// The program in the state of the machine. Its holes are what others call lines.
    pub(super) fn program_shown(&mut self) -> Option<Value> {
        let now = self.now;
        let running = &mut *self.running;
        let program = Arc::clone(running.program.as_ref()?);
        let passed = now.saturating_sub(std::mem::replace(&mut running.looked_at, now));
        if running.phase == Phase::Running {
            running.elapsed += passed;
        }
        let total_s = program.holes.as_ref().map(|holes| holes.total_s());
        let total_s = total_s.filter(|_| program.errors == 0);
        let [start_s, done_s] = running.done_s;
        let elapsed_s = running.elapsed.as_secs_f64();
        // The link and the motors are as fast as they were until now.
        let pace = match done_s - start_s {
            made_s if made_s > 1.0 => (running.begun.as_secs_f64() / made_s).max(0.1),
            _ => 1.0,
        };
        let within_s = match running.phase {
            Phase::Running => (running.elapsed - running.begun).as_secs_f64() / pace,
            _ => 0.0,
        };
        let at_s = done_s + within_s.min(running.next_s());
        let is_begun = running.phase != Phase::Loaded;
        let hole = running.made + usize::from(running.made < program.count);
        let waits = running.phase == Phase::Waiting;
        // Tenths, so that a state does not change without need.
        let tenths = |s: f64| (s * 10.0).round() / 10.0;
        let left_s = total_s.map(|total_s| (total_s - at_s).max(0.0) * pace);
        let progress = total_s
            .filter(|total| *total > 0.0)
            .map(|total| (at_s / total).clamp(0.0, 1.0));
        Some(json!({
            "name": program.name,
            "lines": program.count,
            "errors": program.errors,
            "warnings": program.warnings,
            "load": running.loads,
            "phase": running.phase.name(),
            "line": is_begun.then_some(hole),
            "sent": running.made,
            "answered": running.made,
            "of": program.count,
            "time_s": total_s.map(tenths),
            "elapsed_s": tenths(elapsed_s),
            "remaining_s": left_s.filter(|_| is_begun).map(tenths),
            "progress": progress.map(|part| (part * 1e3).round() / 1e3),
            "single_block": running.single_block,
            "breakpoints": running.breakpoints,
            "waits_before": waits.then_some(hole),
            "message": running.message,
            "resume_line": running.resume_hole,
            "runs": running.runs,
        }))
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
        let program = self.bench.running.program();
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
        let how = from.map_or("starts".into(), |hole| format!("goes on from hole {hole}"));
        let text = format!("{} {how}", program.name);
        self.bench.machine.tell(From::Server, text);
        let holes = program.holes.as_ref().map(|holes| &holes.holes[..]);
        let holes = holes.unwrap_or_default();
        let done_s = holes.iter().take(first).map(|hole| hole.seconds).sum();
        let part = holes.get(first).map_or(0, |hole| hole.part);
        let zero = self.bench.zero();
        let running = &mut *self.bench.running;
        *running = Running {
            record: Some(RunRecord::new(Arc::clone(&program), from)),
            program: Some(program),
            loads: running.loads,
            runs: running.runs,
            phase: Phase::Running,
            made: first,
            returned: part,
            // What was confirmed has named the tool.
            is_passed: true,
            single_block: running.single_block,
            breakpoints: std::mem::take(&mut running.breakpoints),
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
        if self.bench.running.phase != Phase::Running {
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
        self.bench.running.begun = self.bench.running.elapsed;
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
        if !self.bench.running.is_active() {
            self.empty()?;
        }
        Ok(true)
    }

    fn wait(&mut self, index: usize) {
        let running = &mut *self.bench.running;
        running.phase = Phase::Waiting;
        running.pauses = false;
        if running.is_new_tool(index) {
            let program = running.program.as_ref().and_then(|one| one.holes.as_ref());
            let part = running.hole(index).map(|hole| hole.part);
            let part = program
                .zip(part)
                .and_then(|(program, part)| program.parts.get(part));
            running.message = part.map(|part| format!("put in {}, then resume", part.name()));
        }
    }

    fn made(&mut self, next: &Next, seconds: f64) {
        let running = &mut *self.bench.running;
        match next {
            Next::Hole(_) => {
                running.made += 1;
                running.is_passed = false;
            }
            Next::Home(part) => running.returned = part + 1,
        }
        running.done_s[1] += seconds;
        running.begun = running.elapsed;
        if running.next().is_none() {
            running.phase = Phase::Done;
            running.resume_hole = None;
            let message = format!("{} holes drilled", running.made);
            self.bench.machine.tell(From::Server, message.as_str());
            self.bench.running.message = Some(message);
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
