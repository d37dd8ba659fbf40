//! A program with the machine that it is for: checked, listed, simulated.
//!
//! [`Job`] is all that a program needs that works with programs, such as the page for browsers. The
//! modules of [`crate::programs`] and [`crate::simulation`] are its parts.

mod columns;
mod compare;
mod losses;
mod place;
mod program;
mod results;
mod run;
mod steps;
mod zero;

pub use columns::{Batches, Columns, Kind};
pub use program::{Program, Text};
pub use results::{Order, Results, Touch};
pub use run::{Options, Simulated};
pub use steps::{Instant, Rows, Steps};
pub use zero::{LETTERS, Zero};

use crate::diagnostics::Findings;
use crate::machines::machine_file::MachineFile;
use crate::programs::check::{self, Facts, Part};
use crate::programs::program::Start;
use crate::programs::setup::{self, MappedEngine};
use crate::programs::source::Source;
use crate::programs::{commands, language, steps as step_list, zero as travel};
use crate::simulation::work_piece::WorkPiece;
use husillo_gcode::Nm;
use husillo_machine::Config;
use husillo_sim::observers::AXES;
use std::fmt;
use std::io::{self, Read, Write};
use std::rc::Rc;

/// Why a job ends without a result. Mistakes of the program are [`Findings`], not errors.
#[derive(Debug)]
pub enum JobError {
    /// Writing failed.
    Io(io::Error),
    /// A sentence: the program cannot be read, or it does not suit the machine or the options.
    Message(String),
}

impl fmt::Display for JobError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Io(error) => error.fmt(f),
            Self::Message(message) => message.fmt(f),
        }
    }
}

impl std::error::Error for JobError {}

impl From<io::Error> for JobError {
    fn from(error: io::Error) -> Self {
        Self::Io(error)
    }
}

impl From<String> for JobError {
    fn from(message: String) -> Self {
        Self::Message(message)
    }
}

/// A program with the machine that it is for.
#[derive(Clone, Debug)]
pub struct Job {
    program: Rc<dyn Program>,
    /// The machine.
    pub machine: MachineFile,
    /// The limits of the machine.
    pub config: Config<AXES>,
    /// The language of the program, and its position on the machine.
    pub start: Start,
    is_placed: bool,
    /// No position was requested: if the program does not fit at machine zero, it is moved.
    may_move: bool,
    notes: Vec<String>,
}

impl Job {
    /// A program for a machine, which is homed, with work zero at machine zero. `dialect` is the
    /// name of the program's language; without it the name of the program and the machine decide.
    ///
    /// # Errors
    ///
    /// The language is not known, the program is a drill file, or the machine has a step or a jerk
    /// that is out of range.
    pub fn new(
        program: impl Program + 'static,
        machine: MachineFile,
        dialect: Option<&str>,
    ) -> Result<Self, JobError> {
        let dialect = setup::dialect(dialect, program.name(), Some(&machine))?;
        let config = setup::config(&machine, dialect)?;
        let mut start = Start::from(setup::on_axes(dialect, &machine));
        start.frames = machine.work;
        for (place, tool) in start.tools.iter_mut().zip(&machine.tools) {
            *place = Some(*tool);
        }
        Ok(Self {
            program: Rc::new(program),
            machine,
            config,
            start,
            is_placed: false,
            may_move: false,
            notes: Vec::new(),
        })
    }

    /// Reads the program from elsewhere.
    pub fn read_from(&mut self, program: impl Program + 'static) {
        self.program = Rc::new(program);
    }

    /// Name of the program in messages.
    pub fn name(&self) -> &str {
        self.program.name()
    }

    /// What was done without being asked for, such as a move to the middle of the table. Each
    /// sentence is returned once.
    pub fn take_notes(&mut self) -> Vec<String> {
        std::mem::take(&mut self.notes)
    }

    /// Opens the program to read it from its begin.
    ///
    /// # Errors
    ///
    /// It cannot be read.
    pub fn open(&self) -> Result<Source, JobError> {
        let bytes = self.program.bytes().map_err(|error| self.unread(&error))?;
        Ok(Source::from_reader(bytes)
            .with_subroutines(self.program.subroutines())
            .with_watch(self.program.watch()))
    }

    /// The first bytes of the program, at most `most`.
    ///
    /// # Errors
    ///
    /// It cannot be read.
    pub fn head(&self, most: usize) -> Result<Vec<u8>, JobError> {
        let mut head = Vec::new();
        let bytes = self.program.bytes();
        bytes
            .and_then(|bytes| bytes.take(most as u64).read_to_end(&mut head))
            .map_err(|error| self.unread(&error))?;
        Ok(head)
    }

    fn unread(&self, error: &io::Error) -> JobError {
        JobError::Message(format!("{}: {error}", self.name()))
    }

    /// Checks the program, and returns its figures. One that does not fit at machine zero is moved
    /// to the middle of the table, if it fits there and no zero was asked for.
    ///
    /// # Errors
    ///
    /// The program cannot be read, or its text is in a language of other machines.
    pub fn check(&mut self, findings: &mut Findings) -> Result<Facts, JobError> {
        // A program that is moved is checked at its new place, so that the rest of it does not
        // count here.
        let part = match self.may_move && findings.is_empty() {
            true => Part::WithinTravel,
            false => Part::Whole,
        };
        let mut facts = self.check_here(part, findings)?;
        if part == Part::Whole || facts.beyond.is_none() {
            self.expect_language(findings)?;
        }
        if facts.beyond.is_none() {
            return Ok(facts);
        }
        if let Some((facts, found)) = self.check_moved(findings)? {
            *findings = found;
            self.expect_language(findings)?;
            return Ok(facts);
        }
        if part == Part::WithinTravel {
            *findings = findings.restarted();
            facts = self.check_here(Part::Whole, findings)?;
            self.expect_language(findings)?;
        }
        let Some(first) = &facts.beyond else {
            return Ok(facts);
        };
        travel::report_beyond(
            &mut self.open()?,
            self.name(),
            self.start,
            &self.machine,
            &self.config,
            first,
            findings,
        )?;
        Ok(facts)
    }

    /// # Errors
    ///
    /// The program has errors because it is in a language of other machines.
    fn expect_language(&self, findings: &mut Findings) -> Result<(), JobError> {
        if findings.errors == 0 {
            return Ok(());
        }
        let Some(language) = language::of(&self.head(language::HEAD)?) else {
            return Ok(());
        };
        // The errors of its lines have one cause.
        *findings = findings.restarted();
        Err(format!("{}: {language}", self.name()).into())
    }

    fn check_here(&self, part: Part, findings: &mut Findings) -> Result<Facts, JobError> {
        Ok(check::check(
            &mut self.open()?,
            self.name(),
            self.start,
            &self.machine,
            &self.config,
            part,
            findings,
        )?)
    }

    /// Writes the commands of the program, one a line, as text or as JSON objects.
    ///
    /// # Errors
    ///
    /// Reading or writing fails.
    pub fn write_commands(
        &self,
        is_json: bool,
        findings: &mut Findings,
        out: &mut impl Write,
    ) -> Result<(), JobError> {
        let mut source = self.open()?;
        let (name, start) = (self.name(), self.start);
        Ok(commands::print(
            &mut source,
            name,
            start,
            is_json,
            findings,
            out,
        )?)
    }

    /// Writes the step events of a checked program as CSV, as [`step_list::write`] does; with
    /// `levels` also the inputs of the drivers. Returns their number.
    ///
    /// # Errors
    ///
    /// Reading or writing fails, or a driver does not have the step mode of the machine.
    pub fn write_steps(
        &self,
        compensation: bool,
        levels: bool,
        out: &mut impl Write,
    ) -> Result<u64, JobError> {
        let mut source = self.open()?;
        let mut engine = self.engine(compensation)?;
        let motors = levels.then(|| setup::motors(&self.machine)).transpose()?;
        Ok(step_list::write(
            &mut source,
            &mut engine,
            &self.piece(),
            motors,
            out,
        )?)
    }

    /// The machine before the program, with or without compensation of backlash.
    ///
    /// # Errors
    ///
    /// A backlash is out of range, or the position of the program is.
    pub fn engine(&self, compensation: bool) -> Result<MappedEngine, JobError> {
        let mut machine = setup::with_maps(self.config, setup::maps(&self.machine)?);
        machine.set_compensation(compensation);
        if self.is_placed {
            (machine.place(self.start.zero, self.start.at)).map_err(|error| error.to_string())?;
        }
        for (system, zero) in (0..).zip(self.start.frames) {
            if let Some(zero) = zero {
                machine.set_work_zero(system, zero);
            }
        }
        for (number, tool) in self.start.tools.into_iter().flatten() {
            machine.set_tool(number, tool);
        }
        machine.set_tip(setup::tip(&self.machine));
        Ok(machine)
    }

    /// What the simulated probe touches.
    pub fn piece(&self) -> WorkPiece {
        let [x, y, z, ..] = self.start.zero.map(|Nm(nm)| nm);
        WorkPiece::new(self.machine.probe.as_ref(), [x, y, z])
    }
}
