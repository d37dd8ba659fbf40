//! `husillo run`: passes events to the simulated machine, and its steps to the observers.

use crate::machines::encoder_file::Push;
use crate::machines::machine_file::MachineFile;
use crate::programs::setup::{self, ClosedEngine, MappedEngine};
use crate::simulation::mechanics::Mechanics;
use husillo_gcode::SpindleDirection;
use husillo_machine::{Event, Followed, Origin, Output, Probed, StepEvent};
use husillo_sim::geometry::nurbs::NurbsPath;
use husillo_sim::observers::AXES;
use husillo_sim::observers::deviation::Deviation;
use husillo_sim::observers::encoders::EncoderReports;
use husillo_sim::observers::moves::Moves;
use husillo_sim::observers::phases::Phases;
use husillo_sim::observers::picture::Picture;
use husillo_sim::observers::recording::Recording;
use husillo_sim::observers::speed::Speed;
use husillo_sim::observers::statistics::Statistics;
use husillo_sim::observers::symmetry::Symmetry;
use husillo_sim::observers::trace::Trace;
use husillo_sim::observers::{Begun, Now, Observer};
use std::io::{self, Write};

/// The observers of a run.
pub struct Observers {
    /// Extents and take-ups.
    pub statistics: Statistics,
    /// Deviation of feed moves.
    pub deviation: Deviation,
    /// Picture of the path.
    pub picture: Picture,
    /// Speed along the path.
    pub speed: Speed,
    /// The moves, for the viewer.
    pub recording: Recording,
    /// Currents of the first steps.
    pub phases: Phases,
    /// Comparison of the two sides of the work, if requested.
    pub symmetry: Option<Symmetry>,
    trace: Option<Trace<Box<dyn Write>>>,
    /// An observer of the caller.
    pub additional: Option<Box<dyn Observer>>,
}

/// Calls a method of each observer directly. There are millions of steps, and dynamic calls would
/// not be inlined.
macro_rules! each {
    ($observers:ident, $observer:ident => $call:expr) => {{
        each!(@ $call, $observer, $observers: statistics deviation picture speed recording phases);
        each!(@ $call, $observer, $observers: symmetry trace additional);
    }};
    (@ $call:expr, $observer:ident, $observers:ident: $($name:ident)*) => {$({
        let $observer = &mut $observers.$name;
        $call;
    })*};
}

impl Observer for Observers {
    fn begin(&mut self, begun: &Begun<'_>) {
        each!(self, observer => observer.begin(begun));
    }

    #[inline]
    fn step(&mut self, now: &Now<'_>) -> io::Result<()> {
        each!(self, observer => observer.step(now)?);
        Ok(())
    }

    fn dwell(&mut self, ticks: u64) {
        each!(self, observer => observer.dwell(ticks));
    }

    fn finish(&mut self) -> io::Result<()> {
        each!(self, observer => observer.finish()?);
        Ok(())
    }
}

impl std::fmt::Debug for Observers {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Observers")
            .field("statistics", &self.statistics)
            .field("deviation", &self.deviation)
            .finish_non_exhaustive()
    }
}

/// A run and its results.
#[derive(Debug)]
pub struct Run {
    letters: [char; AXES],
    /// The simulated machine.
    pub mechanics: Mechanics,
    moves: Moves,
    /// The observers.
    pub observers: Observers,
    /// The reports of the encoders.
    pub encoders: EncoderReports,
    /// What the probe has found, in the order of the program.
    pub probed: Vec<Probed<AXES>>,
}

impl Run {
    /// A homed machine at rest. It has the backlash of its file or, if worn, that of
    /// `[simulated_backlash]`. `trace` gets every step.
    ///
    /// # Errors
    ///
    /// A driver does not have the step mode of the machine file, a worn machine has no
    /// `[simulated_backlash]`, or the trace cannot be written.
    pub fn new(
        machine: &MachineFile,
        is_worn: bool,
        trace: Option<Box<dyn Write>>,
    ) -> Result<Self, String> {
        let mechanics = Mechanics::new(machine, is_worn)?;
        let ramps = machine.axes.iter().filter_map(|axis| axis.acceleration);
        let trace = trace.map(|out| Trace::new(out, machine.timer_hz, &machine.letters));
        let observers = Observers {
            statistics: Statistics::default(),
            deviation: Deviation::default(),
            picture: Picture::new(machine.view),
            speed: Speed::new(machine.timer_hz, ramps.max()),
            recording: Recording::new(machine.timer_hz),
            phases: Phases::new(setup::phases(machine), machine.timer_hz, mechanics.levels()),
            symmetry: None,
            trace: trace.transpose().map_err(|error| error.to_string())?,
            additional: None,
        };
        let step = machine.axes[0].step;
        Ok(Self {
            letters: machine.each('?', |axis| char::from(axis.letter)),
            mechanics,
            moves: Moves::new(0.5 * (step.num as f64 / step.den as f64)),
            observers,
            encoders: EncoderReports::default(),
            probed: Vec::new(),
        })
    }

    /// Puts the tool at these steps before the run.
    pub fn start_at(&mut self, steps: [i32; AXES]) {
        self.mechanics.start_at(steps);
        self.observers.statistics.start_at(self.mechanics.tool());
        self.observers.recording.start_at(self.mechanics.tool());
        self.moves.start_at(self.mechanics.tool());
    }

    /// Sets the curves of several commands in the order in which they are made.
    pub fn set_curves(&mut self, curves: Vec<NurbsPath>) {
        self.moves.set_curves(curves);
    }

    /// Sets the simulated losses.
    pub fn set_pushes(&mut self, pushes: &[Push]) {
        self.mechanics.set_pushes(pushes);
    }

    /// Takes one entry of a machine with encoders. Returns the counts after it.
    ///
    /// # Errors
    ///
    /// The trace cannot be written.
    pub fn followed(
        &mut self,
        machine: &ClosedEngine,
        entry: &Followed<AXES>,
    ) -> io::Result<[i64; AXES]> {
        match entry {
            Followed::Event(Event::Step(step)) if machine.is_correcting() => {
                self.mechanics.step(step);
            }
            Followed::Event(event) => self.event(machine.machine(), event)?,
            report => {
                let events = self.mechanics.events();
                self.encoders.add(report, self.letters, events);
            }
        }
        Ok(self.mechanics.counts())
    }

    /// Takes one event of the machine.
    ///
    /// # Errors
    ///
    /// The trace cannot be written.
    #[inline]
    pub fn event(&mut self, machine: &MappedEngine, event: &Event<AXES>) -> io::Result<()> {
        match event {
            Event::Step(step) => self.step(machine, step),
            Event::Dwell { wait_ticks } => {
                self.mechanics.rest(*wait_ticks);
                self.observers.dwell(self.mechanics.ticks());
                Ok(())
            }
            Event::Output(Output::Spindle {
                direction,
                milli_rpm,
            }) => {
                let is_on = *direction != SpindleDirection::Off;
                self.moves.milli_rpm = if is_on { *milli_rpm } else { 0 };
                Ok(())
            }
            Event::Probed { .. } => {
                self.probed.push(*machine.probed());
                // The next move begins where this one has stopped.
                self.moves.start_at(machine.position_steps());
                self.moves.sent(machine.position_steps());
                Ok(())
            }
            _ => Ok(()),
        }
    }

    #[inline]
    fn step(&mut self, machine: &MappedEngine, step: &StepEvent<AXES>) -> io::Result<()> {
        self.mechanics.step(step);
        let origin = machine.origin();
        let is_turn = self.moves.is_turn(origin);
        if is_turn {
            let executing = machine.executing().copied();
            if let Some(begun) = self.moves.turn(executing, machine.config(), origin) {
                self.observers.begin(&begun.begun());
            }
        }
        let is_take_up = origin == Origin::TakeUp;
        let begins_take_up = is_take_up && self.moves.takes_up(step);
        let sent = machine.position_steps();
        if !is_take_up {
            self.moves.sent(sent);
        }
        let tool = self.mechanics.tool();
        self.observers.step(&Now {
            step,
            origin,
            is_turn,
            begins_take_up,
            event: self.mechanics.events(),
            ticks: self.mechanics.ticks(),
            tool,
            tool_nm: self.mechanics.in_nm(tool),
            sent,
            levels: self.mechanics.levels(),
        })
    }

    /// Writes the rest of the trace.
    ///
    /// # Errors
    ///
    /// The trace cannot be written.
    pub fn finish(&mut self) -> io::Result<()> {
        self.observers.finish()
    }
}

#[cfg(test)]
mod tests;
