//! A job on the simulated machine.

use super::{Job, JobError, Results, losses};
use crate::machines::encoder_file::Push;
use crate::programs::check::Facts;
use crate::programs::feeder;
use crate::programs::setup::{self, ClosedEngine};
use crate::simulation::run::Run;
use husillo_sim::observers::symmetry::Symmetry;
use husillo_sim::observers::{AXES, Observer};
use std::io::Write;

/// How a program is simulated.
pub struct Options {
    /// The controller compensates the backlash.
    pub compensation: bool,
    /// The screws have the backlash of `[simulated_backlash]` of the machine file.
    pub worn: bool,
    /// Steps that are lost at given events.
    pub pushes: Vec<Push>,
    /// Compares the two sides of the work to the left and to the right of this X in mm.
    pub symmetry_mm: Option<f64>,
    /// Receives every step as text.
    pub trace: Option<Box<dyn Write>>,
    /// Follows every step.
    pub observer: Option<Box<dyn Observer>>,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            compensation: true,
            worn: false,
            pushes: Vec::new(),
            symmetry_mm: None,
            trace: None,
            observer: None,
        }
    }
}

impl std::fmt::Debug for Options {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Options")
            .field("compensation", &self.compensation)
            .field("worn", &self.worn)
            .finish_non_exhaustive()
    }
}

/// A simulated job.
#[derive(Debug)]
pub struct Simulated {
    /// The run with its observers.
    pub run: Run,
    /// Position of work zero at the end, nm of the machine frame.
    pub offset_nm: [i64; AXES],
    /// An encoder stopped the machine.
    pub has_stopped: bool,
}

impl Simulated {
    /// The figures of the run, with a sentence about each axis that lost steps.
    pub fn results(&self, job: &Job, facts: &Facts) -> Results {
        let losses = losses::sentences(job, &self.run);
        Results {
            errors: losses.len() as u64,
            losses,
            ..Results::new(job, &self.run, facts, self.offset_nm)
        }
    }
}

impl Job {
    /// Runs the checked program on the simulated machine, and calls `step` at each of its events.
    /// The curves of `facts` are taken.
    ///
    /// # Errors
    ///
    /// The program cannot be read, the trace cannot be written, the observer has failed, a driver
    /// does not have the step mode of the machine, or a probe finds nothing.
    pub fn simulate(
        &self,
        facts: &mut Facts,
        options: Options,
        mut step: impl FnMut(),
    ) -> Result<Simulated, JobError> {
        let mut run = Run::new(&self.machine, options.worn, options.trace)?;
        run.set_curves(std::mem::take(&mut facts.curves));
        let mut source = self.open()?;
        let mut machine = self.engine(options.compensation)?;
        run.start_at(machine.position_steps());
        run.set_pushes(&options.pushes);
        run.observers.additional = options.observer;
        run.observers.symmetry = options.symmetry_mm.map(|mm| {
            let [x, y, ..] = run.mechanics.nm_per_step();
            Symmetry::new(mm * 1e6, [x, y])
        });
        let piece = self.piece();
        let encoders = setup::encoders(&self.machine);
        let mut has_stopped = false;
        if encoders.iter().any(Option::is_some) {
            let mut closed = ClosedEngine::new(machine, encoders);
            let counts = run.mechanics.counts();
            feeder::feed_followed(&mut source, &mut closed, &piece, counts, |closed, entry| {
                step();
                run.followed(closed, entry)
            })?;
            has_stopped = closed.is_stopped();
            machine = closed.machine().clone();
        } else {
            feeder::feed(&mut source, &mut machine, &piece, |machine, event| {
                step();
                run.event(machine, event)
            })?;
        }
        run.finish()?;
        Ok(Simulated {
            run,
            offset_nm: machine.modal().work_offset().map(|nm| nm.0),
            has_stopped,
        })
    }
}
