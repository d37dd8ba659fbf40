//! The course of a program, of all families: it is loaded, runs, waits, and ends with a record.

use super::phase::Phase;
use crate::serve::console_lines::From;
use crate::serve::loaded::Loaded;
use crate::serve::machine::Machine;
use crate::serve::run_record::RunRecord;
use serde_json::{Value, json};
use std::collections::BTreeSet;
use std::sync::{Arc, PoisonError};
use std::time::Duration;

/// A program on its course. Its parts are lines, or the holes of a drill.
#[derive(Debug, Default)]
pub(super) struct Course {
    program: Option<Arc<Loaded>>,
    phase: Phase,
    record: Option<RunRecord>,
    /// The phase that was noted last in the record.
    noted: &'static str,
    /// Programs that were loaded.
    loads: u64,
    /// Runs that have ended. The last one has a report.
    runs: u64,
    pub(super) single_block: bool,
    pub(super) breakpoints: BTreeSet<usize>,
    /// It waits before its next part, because the operator has asked for that.
    pub(super) pauses: bool,
    /// The operator has let the part before which it waits pass.
    pub(super) is_passed: bool,
    pub(super) message: Option<String>,
    /// The part with which an interrupted program goes on.
    resume_at: Option<usize>,
    /// Time in motion.
    pub(super) elapsed: Duration,
}

/// What the state of the machine has of a program beside its course.
pub(super) struct Progress {
    /// The phase, as pages get it.
    pub(super) phase: &'static str,
    /// The part that is made.
    pub(super) line: Option<usize>,
    /// Parts that were sent, and that are made, of all.
    pub(super) sent: usize,
    pub(super) answered: usize,
    pub(super) of: usize,
    /// Estimated time of all parts, s.
    pub(super) time_s: Option<f64>,
    /// Estimated time of the rest, s.
    pub(super) remaining_s: Option<f64>,
    /// From 0 to 1.
    pub(super) progress: Option<f64>,
    /// The part that comes next.
    pub(super) next: Option<usize>,
}

impl Course {
    /// Whether parts are made, or will be.
    pub(super) const fn is_active(&self) -> bool {
        self.phase.is_active()
    }

    pub(super) const fn phase(&self) -> Phase {
        self.phase
    }

    /// The loaded program.
    pub(super) const fn program(&self) -> Option<&Arc<Loaded>> {
        self.program.as_ref()
    }

    /// Takes over a program that was checked.
    pub(super) fn load(&mut self, machine: &Machine, program: Arc<Loaded>) {
        machine.tell(From::Server, format!("{} is loaded", program.name));
        *self = Self {
            resume_at: program.resume_line,
            program: Some(program),
            loads: self.loads + 1,
            runs: self.runs,
            single_block: self.single_block,
            ..Self::default()
        };
    }

    /// Forgets the program.
    pub(super) fn unload(&mut self, machine: &Machine) {
        let mut program = machine
            .program
            .lock()
            .unwrap_or_else(PoisonError::into_inner);
        *program = None;
        *self = Self {
            loads: self.loads,
            runs: self.runs,
            single_block: self.single_block,
            ..Self::default()
        };
    }

    /// Starts a program at its first part, or at `from`.
    pub(super) fn start(&mut self, machine: &Machine, program: Arc<Loaded>, from: Option<usize>) {
        let name = program.name.clone();
        *self = Self {
            record: Some(RunRecord::new(Arc::clone(&program), from)),
            program: Some(program),
            phase: Phase::Running,
            loads: self.loads,
            runs: self.runs,
            single_block: self.single_block,
            breakpoints: std::mem::take(&mut self.breakpoints),
            ..Self::default()
        };
        let how = from.map_or("starts".into(), |number| {
            format!("goes on from {}", self.part(number))
        });
        machine.tell(From::Server, format!("{name} {how}"));
    }

    /// Waits before the next part. A part that is being made is made to its end.
    ///
    /// # Errors
    ///
    /// No program runs.
    pub(super) const fn pause(&mut self) -> Result<(), &'static str> {
        match self.phase {
            Phase::Running | Phase::Waiting => {
                self.pauses = true;
                Ok(())
            }
            _ => Err("no program runs"),
        }
    }

    /// Waits for the operator. `message` is what the operator has to do.
    pub(super) fn wait(&mut self, message: Option<String>) {
        self.phase = Phase::Waiting;
        self.pauses = false;
        self.message = message;
    }

    /// Goes on after a wait.
    ///
    /// # Errors
    ///
    /// Nothing waits.
    pub(super) fn resume(&mut self) -> Result<(), &'static str> {
        let is_pausing = self.pauses && self.phase == Phase::Running;
        if self.phase != Phase::Waiting && !is_pausing {
            return Err("nothing waits");
        }
        self.is_passed = self.phase == Phase::Waiting;
        self.pauses = false;
        self.phase = Phase::Running;
        self.message = None;
        Ok(())
    }

    /// All parts are made.
    pub(super) fn done(&mut self, machine: &Machine, message: String) {
        self.phase = Phase::Done;
        self.resume_at = None;
        machine.tell(From::Server, message.as_str());
        self.message = Some(message);
    }

    /// The program cannot go on. `next` is the first part that is not certainly made.
    pub(super) fn fail(&mut self, machine: &Machine, why: &str, next: Option<usize>) {
        if self.is_active() {
            self.phase = Phase::Failed;
            let text = format!("{why}; {}", self.interrupt(next));
            machine.tell(From::Server, text.as_str());
            self.message = Some(text);
        }
    }

    /// STOP was pressed. `next` is the first part that is not certainly made.
    pub(super) fn stop(&mut self, next: Option<usize>) {
        if self.is_active() {
            self.phase = Phase::Stopping;
            self.message = Some(format!("stopped; {}", self.interrupt(next)));
        }
    }

    /// The machine stands after a stop, or the controller is lost.
    pub(super) fn end(&mut self, machine: &Machine, why: &str, next: Option<usize>) {
        match self.phase {
            Phase::Stopping => self.phase = Phase::Stopped,
            _ => self.fail(machine, why, next),
        }
    }

    /// The program goes on with `next`. Returns which parts are made.
    fn interrupt(&mut self, next: Option<usize>) -> String {
        self.resume_at = next;
        let (part, made) = self.parts();
        match next {
            Some(1) if part != "line" => format!("no {part} is {made}"),
            Some(next) => format!("all {part}s before {} are {made}", self.part(next)),
            None => format!("all {part}s are {made}"),
        }
    }

    /// A part as text, such as `line 12`.
    fn part(&self, number: usize) -> String {
        let (part, _) = self.parts();
        format!("{part} {number}")
    }

    /// What a part is called, and what becomes of it.
    fn parts(&self) -> (&'static str, &'static str) {
        match &self.program {
            Some(program) if program.holes.is_some() => ("hole", "drilled"),
            Some(program) if program.figure.is_some() => ("move", "cut"),
            _ => ("line", "made"),
        }
    }

    /// The record of the run, while it goes on.
    pub(super) const fn record(&mut self) -> Option<&mut RunRecord> {
        self.record.as_mut()
    }

    /// Notes in the record that `phase` has changed, and publishes it when the run has ended. `at`
    /// is the part that is made, `next` the one before which it waits, and `made` how many of how
    /// many are made.
    pub(super) fn note(
        &mut self,
        machine: &Machine,
        phase: &'static str,
        [at, next]: [usize; 2],
        made: [usize; 2],
    ) {
        let [at, next] = [at, next].map(|number| self.part(number));
        let Some(record) = &mut self.record else {
            return;
        };
        let before = std::mem::replace(&mut self.noted, phase);
        match phase {
            _ if phase == before => {}
            "held" => record.stop(format!("held at {at}")),
            "stopping" => record.stop(format!("STOP at {at}")),
            "waiting" => record.event(format!("waits before {next}")),
            "running" if ["held", "waiting"].contains(&before) => record.event("goes on"),
            _ => {}
        }
        if self.is_active() {
            return;
        }
        if let Some(mut record) = self.record.take() {
            let result = self.message.as_deref().unwrap_or(phase);
            record.end(result, made, self.elapsed.as_secs_f64());
            self.runs += 1;
            let mut last = machine.run.lock().unwrap_or_else(PoisonError::into_inner);
            *last = Some(Arc::new(record));
        }
    }

    /// The program in the state of the machine.
    pub(super) fn shown(&self, now: &Progress) -> Option<Value> {
        let program = self.program.as_ref()?;
        let is_begun = self.phase != Phase::Loaded;
        // Tenths, so that a state does not change without need.
        let tenths = |s: f64| (s * 10.0).round() / 10.0;
        // A run that has ended in this turn is noted before pages get this.
        let ended = u64::from(self.record.is_some() && !self.is_active());
        let progress = now.progress.map(|part| part.clamp(0.0, 1.0));
        Some(json!({
            "name": program.name,
            "lines": program.count,
            "errors": program.errors,
            "warnings": program.warnings,
            "load": self.loads,
            "phase": now.phase,
            "line": now.line.filter(|_| is_begun),
            "sent": now.sent,
            "answered": now.answered,
            "of": now.of,
            "time_s": now.time_s.map(tenths),
            "elapsed_s": tenths(self.elapsed.as_secs_f64()),
            "remaining_s": now.remaining_s.filter(|_| is_begun).map(tenths),
            "progress": progress.map(|part| (part * 1e3).round() / 1e3),
            "single_block": self.single_block,
            "breakpoints": self.breakpoints,
            "waits_before": now.next.filter(|_| self.phase == Phase::Waiting),
            "message": self.message,
            "resume_line": self.resume_at,
            "runs": self.runs + ended,
        }))
    }
}
