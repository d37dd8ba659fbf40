//! The step events of a job, entered at any place.

mod window;

use super::{Job, JobError};
use crate::programs::feeder;
use crate::simulation::mechanics::Mechanics;
use husillo_machine::{Event, Origin};
use husillo_sim::observers::AXES;
use std::io;
use window::{Entry, Window};

pub use window::Rows;

/// Entries that are kept. A program with more is run again, up to the place that is asked for.
const KEPT: u64 = 1 << 22;

/// The step events of a checked program on a machine without simulated losses, one by one.
///
/// Up to four million entries are kept, at about seven bytes each. Within them [`at`](Self::at)
/// makes at most 1024 steps again. Elsewhere the program is run from its begin.
#[derive(Debug)]
pub struct Steps {
    job: Job,
    compensation: bool,
    worn: bool,
    kept: u64,
    window: Window,
    /// Entry, event and ticks at which each part of `kept` entries begins.
    begins: Vec<Begin>,
    end: Begin,
}

/// The number of an entry and of its step event, and its time.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct Begin {
    entry: u64,
    event: u64,
    ticks: u64,
}

/// The machine after a step event.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Instant {
    /// Number of step events so far, those of take-ups included.
    pub event: u64,
    /// Timer ticks so far. Waits after the event are not in it, except those before a later time
    /// that was asked for.
    pub ticks: u64,
    /// Position of the controller, steps.
    pub commanded: [i32; AXES],
    /// Position of the tool, steps.
    pub tool: [i32; AXES],
    /// Inputs of the drivers; bit 0 is the first input.
    pub levels: [u8; AXES],
    /// The event took up backlash.
    pub is_take_up: bool,
}

impl Steps {
    /// Runs the program once, on a machine with the backlash of its file or, if worn, that of
    /// `[simulated_backlash]`.
    ///
    /// # Errors
    ///
    /// As [`Job::simulate`].
    pub fn new(job: Job, compensation: bool, worn: bool) -> Result<Self, JobError> {
        Self::with_kept(job, compensation, worn, KEPT)
    }

    fn with_kept(job: Job, compensation: bool, worn: bool, kept: u64) -> Result<Self, JobError> {
        let mechanics = Mechanics::new(&job.machine, worn)?;
        let mut steps = Self {
            window: Window::new(mechanics, [0; AXES], Begin::default()),
            job,
            compensation,
            worn,
            kept,
            begins: Vec::new(),
            end: Begin::default(),
        };
        steps.run(0, true)?;
        Ok(steps)
    }

    /// Number of step events.
    pub const fn events(&self) -> u64 {
        self.end.event
    }

    /// Number of entries: step events and waits without a step.
    pub const fn entries(&self) -> u64 {
        self.end.entry
    }

    /// Timer ticks from the start to the end.
    pub const fn ticks(&self) -> u64 {
        self.end.ticks
    }

    /// The job.
    pub const fn job(&self) -> &Job {
        &self.job
    }

    /// The machine after this number of step events; 0 is the start. `None` beyond the end.
    ///
    /// # Errors
    ///
    /// The program cannot be read again.
    pub fn at(&mut self, event: u64) -> Result<Option<Instant>, JobError> {
        if event > self.end.event {
            return Ok(None);
        }
        self.enter(|begin| begin.event < event || begin.entry == 0)?;
        Ok(Some(self.window.at_event(event)))
    }

    /// The machine at a time; at the end after it.
    ///
    /// # Errors
    ///
    /// The program cannot be read again.
    pub fn at_ticks(&mut self, ticks: u64) -> Result<Instant, JobError> {
        let ticks = ticks.min(self.end.ticks);
        self.enter(|begin| begin.ticks <= ticks)?;
        Ok(self.window.at_ticks(ticks))
    }

    /// Up to `count` entries from number `from` on, as columns. There are fewer at the end, and at
    /// the end of what is kept: the next call goes on there.
    ///
    /// # Errors
    ///
    /// The program cannot be read again.
    pub fn rows(&mut self, from: u64, count: usize) -> Result<Rows, JobError> {
        self.enter(|begin| begin.entry <= from)?;
        let axes = self.job.machine.axes.len();
        Ok(self.window.rows(from, count, axes))
    }

    /// Keeps the last part whose begin is as wanted.
    fn enter(&mut self, is_before: impl Fn(&Begin) -> bool) -> Result<(), JobError> {
        let part = self.begins.partition_point(is_before).saturating_sub(1);
        match self.begins.get(part) {
            Some(begin) if *begin != self.window.begin() => self.run(begin.entry, false),
            _ => Ok(()),
        }
    }

    /// Runs the program and keeps the entries from number `from` on. The first run is whole and
    /// notes where the parts begin; others end when all is kept.
    fn run(&mut self, from: u64, is_first: bool) -> Result<(), JobError> {
        let mut source = self.job.open()?;
        let mut engine = self.job.engine(self.compensation)?;
        let start = engine.position_steps();
        let mut mechanics = Mechanics::new(&self.job.machine, self.worn)?;
        mechanics.start_at(start);
        let mut now = Begin::default();
        let mut commanded = start;
        let mut window = Window::new(mechanics.clone(), commanded, now);
        let mut is_full = false;
        let (kept, begins) = (self.kept, &mut self.begins);
        let piece = self.job.piece();
        let fed = feeder::feed(&mut source, &mut engine, &piece, |engine, event| {
            let Some(entry) = Entry::of(event, engine.origin() == Origin::TakeUp) else {
                return Ok(());
            };
            if now.entry == from {
                window = Window::new(mechanics.clone(), commanded, now);
            }
            if is_first && now.entry.is_multiple_of(kept) {
                begins.push(now);
            }
            if (from..from + kept).contains(&now.entry) {
                window.push(entry, &mechanics, commanded, now);
            } else if now.entry >= from && !is_first {
                is_full = true;
                return Err(io::Error::other("all is kept"));
            }
            entry.make(&mut mechanics, &mut commanded);
            now = Begin {
                entry: now.entry + 1,
                event: mechanics.events(),
                ticks: mechanics.ticks(),
            };
            Ok(())
        });
        if !is_full {
            fed?;
        }
        if is_first {
            self.end = now;
        }
        self.window = window;
        Ok(())
    }
}

impl Entry {
    /// The entry of an event: of a step, or of a wait without one.
    fn of(event: &Event<AXES>, is_take_up: bool) -> Option<Self> {
        match event {
            Event::Step(step) => Some(Self::step(step, is_take_up)),
            Event::Dwell { wait_ticks } => Some(Self::wait(*wait_ticks)),
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests;
