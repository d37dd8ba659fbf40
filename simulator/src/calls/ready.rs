//! A program that may run.

use super::{Answer, Failed, Options};
use crate::diagnostics::Findings;
use crate::job::{Job, Options as RunOptions, Simulated};
use crate::programs::check::Facts;
use crate::programs::origins::Lines;
use husillo_sim::observers::{AXES, Observer};
use serde_json::{Map, Value, json};
use std::io;

/// A placed and checked program without errors.
#[derive(Debug)]
pub struct Ready {
    /// The program and its machine.
    pub job: Job,
    /// The figures of the check.
    pub facts: Facts,
    /// Its warnings.
    pub findings: Findings,
    compensation: bool,
    worn: bool,
}

impl Ready {
    /// Places and checks a program.
    ///
    /// # Errors
    ///
    /// The machine or an option is wrong, or the program has errors.
    pub fn new(options: &Options, program: &[u8]) -> Result<Self, Failed> {
        let mut job = options.job(program)?;
        let mut findings = options.findings();
        let facts = job.check(&mut findings)?;
        if findings.errors > 0 {
            return Err(Failed::refused(job.name(), &findings));
        }
        Ok(Self {
            job,
            facts,
            findings,
            compensation: options.compensation,
            worn: options.worn,
        })
    }

    /// The position of the tool before the first event, steps.
    ///
    /// # Errors
    ///
    /// A backlash or the position of the program is out of range.
    pub fn start(&self) -> Result<[i32; AXES], Failed> {
        Ok(self.job.engine(self.compensation)?.position_steps())
    }

    /// The lines of the moves, in the order of a run. They are taken.
    pub fn take_lines(&mut self) -> Lines {
        std::mem::take(&mut self.facts.origins).into_lines()
    }

    /// Runs it on the simulated machine. The observer follows each step.
    ///
    /// # Errors
    ///
    /// A probe finds nothing, a driver does not have the step mode of the machine, or the observer
    /// has failed.
    pub fn simulate(&mut self, observer: Option<Box<dyn Observer>>) -> Result<Simulated, Failed> {
        let options = RunOptions {
            compensation: self.compensation,
            worn: self.worn,
            observer,
            ..RunOptions::default()
        };
        Ok(self.job.simulate(&mut self.facts, options, || {})?)
    }

    /// What the machine of the run has: the letters of its axes, and its units.
    pub fn units(&self) -> Value {
        let machine = &self.job.machine;
        let letters = machine.axes.iter().map(|axis| char::from(axis.letter));
        let steps = machine.axes.iter().map(|axis| axis.step);
        json!({
            "file": self.job.name(),
            "machine": machine.name,
            "axes": letters.collect::<String>(),
            "ticks_per_second": machine.timer_hz,
            "nm_per_step": steps.map(|step| step.num as f64 / step.den as f64).collect::<Vec<_>>(),
        })
    }

    /// The answer about a run: its figures, its units, notes and warnings, and `more`.
    ///
    /// # Errors
    ///
    /// The answer cannot be written as JSON.
    pub fn answer(&mut self, simulated: &Simulated, more: Value) -> Result<Answer, Failed> {
        let results = simulated.results(&self.job, &self.facts);
        let results = serde_json::to_value(&results).map_err(io::Error::from)?;
        let own = json!({
            "warnings": self.findings.warnings,
            "notes": self.job.take_notes(),
            "ticks": simulated.run.mechanics.ticks(),
            "zero_nm": &simulated.offset_nm[..self.job.machine.axes.len()],
        });
        let mut body = Map::new();
        for part in [results, self.units(), own, more] {
            if let Value::Object(part) = part {
                body.extend(part);
            }
        }
        Answer::found("husillo.run/1", &body, &self.findings)
    }
}
