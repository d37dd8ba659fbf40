//! A program with its machine, and the files of both.

use super::Failure;
use super::reporting::{self, count};
use crate::cli::Target;
use crate::cli::{LETTERS, Zero};
use crate::input;
use crate::microfactory;
use husillo_gcode::Nm;
use husillo_machine::Config;
use husillo_sim::observers::AXES;
use husillo_simulator::diagnostics::Findings;
use husillo_simulator::machines::machine_file::{LoadError, MachineFile};
use husillo_simulator::programs::check::{self, Facts};
use husillo_simulator::programs::language;
use husillo_simulator::programs::program::Start;
use husillo_simulator::programs::setup::{self, MappedEngine};
use husillo_simulator::programs::source::Source;
use husillo_simulator::programs::zero::{self, Lie, Placing};
use husillo_simulator::simulation::work_piece::WorkPiece;
use husillo_simulator::text::name;
use std::io::{self, Read};
use std::path::Path;

/// A program and its machine.
pub struct Job {
    pub file: String,
    /// Further folders with files of subroutines.
    include: Vec<String>,
    pub machine: MachineFile,
    pub config: Config<AXES>,
    /// Its language, and its position on the machine.
    pub start: Start,
    is_placed: bool,
    /// No position was requested: if the program does not fit at machine zero, it is moved.
    may_move: bool,
    /// Only a check whether the machine accepts the program: no message is printed.
    pub(super) is_trial: bool,
    /// The messages of a trial.
    pub(super) notes: Vec<String>,
    /// The result of the check, where it is known.
    pub(super) checked: Option<(Facts, Findings)>,
    /// Standard input is read once and kept, because a run reads its program twice. For a list of
    /// moves this is the program made from it.
    pub input: Option<Vec<u8>>,
    /// How often the program was opened.
    #[cfg(test)]
    pub opened: std::cell::Cell<u32>,
}

impl Job {
    pub fn new(file: &str, target: &Target, default_machine: &str) -> Result<Self, Failure> {
        let name = target.machine.as_deref().unwrap_or(default_machine);
        let machine = load(name)?;
        let dialect = setup::dialect(target.dialect.as_deref(), file, Some(&machine))?;
        let config = setup::config(&machine, dialect)?;
        let input = match microfactory::settings_of(&machine) {
            Some(settings) => microfactory::program(file, &settings)?,
            None if microfactory::is_list(file) => return Err(super::only_microfactory(file)),
            None => None,
        };
        let mut start = Start::from(setup::on_axes(dialect, &machine));
        start.frames = machine.work;
        for (place, tool) in start.tools.iter_mut().zip(&machine.tools) {
            *place = Some(*tool);
        }
        Ok(Self {
            file: file.to_owned(),
            include: target.include.clone(),
            config,
            start,
            machine,
            is_placed: false,
            may_move: false,
            is_trial: false,
            notes: Vec::new(),
            checked: None,
            input: input.map(String::into_bytes),
            #[cfg(test)]
            opened: std::cell::Cell::new(0),
        })
    }

    /// The same program for another machine.
    pub(super) fn on(&self, machine: &str, target: &Target) -> Result<Self, Failure> {
        let mut job = Self::new(&self.file, target, machine)?;
        if job.input.is_none() {
            job.input.clone_from(&self.input);
        }
        Ok(job)
    }

    /// The first bytes of the program.
    pub(super) fn head(&self, most: usize) -> Result<Vec<u8>, Failure> {
        if let Some(input) = &self.input {
            return Ok(input.iter().take(most).copied().collect());
        }
        let mut head = Vec::new();
        let read =
            input::open(&self.file).and_then(|file| file.take(most as u64).read_to_end(&mut head));
        read.map_err(|error| Failure::Usage(format!("{}: {error}", self.file)))?;
        Ok(head)
    }

    /// Keeps what can be read once only in memory: standard input, pipes.
    pub fn keep_input(&mut self) -> Result<(), Failure> {
        let metadata = std::fs::metadata(name::path(Path::new(&self.file)));
        let is_pipe = metadata.is_ok_and(|file| !file.is_file() && !file.is_dir());
        if self.input.is_none() && (self.file == "-" || is_pipe) {
            self.input = Some(whole(&self.file)?);
        }
        Ok(())
    }

    /// Puts work zero where it is asked for, and the tool to it, as far as the travel goes. Without
    /// a zero the program begins at machine zero, and [`check`](Self::check) may move it.
    pub fn place(&mut self, zero: Option<Zero>) -> Result<(), Failure> {
        self.keep_input()?;
        let lie = match zero {
            None => {
                self.may_move = self.start.frames[0].is_none();
                return Ok(());
            }
            Some(Zero::At(zero)) => {
                self.start.frames[0] = None;
                self.put(of_letters(&zero, &self.machine)?);
                return Ok(());
            }
            Some(Zero::Fit) => Lie::Middle,
            Some(Zero::Centre) => Lie::ZeroInMiddle,
            Some(Zero::Corner) => Lie::ZeroAtCorner,
        };
        self.start.frames[0] = None;
        let placing = self.placing(lie)?;
        if placing.is_certain {
            let zero = placing.zero;
            self.note(format!("{}: --zero {}", self.name(), self.typed(zero)));
            self.put(zero);
        }
        Ok(())
    }

    /// Prints a message. That of a trial is kept.
    fn note(&mut self, note: String) {
        match self.is_trial {
            true => self.notes.push(note),
            false => eprintln!("{note}"),
        }
    }

    fn placing(&self, lie: Lie) -> Result<Placing, Failure> {
        let mut source = self.open()?;
        Ok(zero::placing(
            &mut source,
            self.name(),
            self.start,
            &self.config,
            lie,
        )?)
    }

    /// A work zero as the user types it. X, Y and Z are always there.
    fn typed(&self, zero: [Nm; AXES]) -> String {
        let letters = self.machine.letters.letters().map(char::from);
        let axes = letters.zip(zero).enumerate();
        axes.filter(|(axis, (_, at))| *axis < 3 || *at != Nm(0))
            .map(|(_, (letter, at))| format!("{letter}{at}"))
            .collect()
    }

    /// The tool stands `at` this position, and work zero is at `zero`.
    pub(super) fn stand(&mut self, zero: [Nm; AXES], at: [Nm; AXES]) {
        self.start = Start {
            zero,
            at,
            ..self.start
        };
        self.is_placed = true;
    }

    /// Puts work zero here.
    fn put(&mut self, zero: [Nm; AXES]) {
        let mut at = zero;
        for (at, axis) in at.iter_mut().zip(&self.config.axes) {
            if let Some([low, high]) = axis.travel {
                *at = (*at).clamp(low, high);
            }
        }
        self.start = Start {
            zero,
            at,
            ..self.start
        };
        self.is_placed = true;
    }

    pub fn open(&self) -> Result<Source, Failure> {
        #[cfg(test)]
        self.opened.set(self.opened.get() + 1);
        let source = match &self.input {
            Some(input) => Source::from_reader(Box::new(io::Cursor::new(input.clone()))),
            None => input::program(&self.file)
                .map_err(|error| Failure::Usage(format!("{}: {error}", self.file)))?,
        };
        Ok(source.with_subroutines(input::folders(&self.file, &self.include)))
    }

    /// Name of the file in messages.
    pub fn name(&self) -> &str {
        displayed(&self.file)
    }

    /// Checks the program. One that does not fit at machine zero is moved to the middle of the
    /// table, if it fits there and no zero was asked for.
    pub fn check(&mut self, findings: &mut Findings) -> Result<Facts, Failure> {
        if let Some((facts, found)) = self.checked.take() {
            *findings = found;
            return Ok(facts);
        }
        let facts = self.check_here(findings)?;
        if findings.errors > 0 {
            if let Some(language) = language::of(&self.head(language::HEAD)?) {
                // The errors of its lines have one cause.
                *findings = findings.restarted();
                return Err(Failure::Usage(format!("{}: {language}", self.name())));
            }
        }
        let Some(first) = &facts.beyond else {
            return Ok(facts);
        };
        if let Some((facts, found)) = self.check_moved(findings)? {
            *findings = found;
            return Ok(facts);
        }
        zero::report_beyond(
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

    fn check_here(&self, findings: &mut Findings) -> Result<Facts, Failure> {
        let mut source = self.open()?;
        Ok(check::check(
            &mut source,
            self.name(),
            self.start,
            &self.machine,
            &self.config,
            findings,
        )?)
    }

    /// Moves the program to the middle of the table. `None`: it does not fit there either, or its
    /// zero was asked for.
    fn check_moved(&mut self, before: &Findings) -> Result<Option<(Facts, Findings)>, Failure> {
        if !self.may_move {
            return Ok(None);
        }
        let Placing { zero, is_certain } = self.placing(Lie::Middle)?;
        let start = self.start;
        self.put(zero);
        let mut findings = before.restarted();
        let facts = self.check_here(&mut findings)?;
        if facts.beyond.is_some() {
            self.start = start;
            self.is_placed = false;
            return Ok(None);
        }
        // With other errors nothing runs, and the position of the part is not one of them.
        if is_certain {
            let (name, machine, zero) = (self.name(), &self.machine.name, self.typed(zero));
            self.note(format!(
                "{name}: placed in the middle of {machine}, as with --zero {zero}"
            ));
        }
        Ok(Some((facts, findings)))
    }

    pub fn new_machine(&self, compensation: bool) -> Result<MappedEngine, Failure> {
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

/// The requested work zero on the axes of a machine.
fn of_letters(
    zero: &[Option<Nm>; LETTERS.len()],
    machine: &MachineFile,
) -> Result<[Nm; AXES], Failure> {
    let mut wanted = [Nm(0); AXES];
    for (letter, at) in LETTERS.bytes().zip(zero) {
        let Some(at) = at else { continue };
        let axis = machine.letters.index(letter).ok_or_else(|| {
            let letter = char::from(letter);
            Failure::Usage(format!("--zero: {} has no axis {letter}", machine.name))
        })?;
        wanted[axis] = *at;
    }
    Ok(wanted)
}

/// Name of a file in messages.
pub fn displayed(file: &str) -> &str {
    if file == "-" { "<input>" } else { file }
}

/// A whole file, or standard input.
pub fn whole(file: &str) -> Result<Vec<u8>, Failure> {
    let read = match file {
        "-" => input::to_end(input::bounded(input::stdin())),
        _ => input::read(file),
    };
    read.map_err(|error| Failure::Usage(format!("{file}: {error}")))
}

pub fn load(machine: &str) -> Result<MachineFile, Failure> {
    match MachineFile::load(machine, input::read_to_string) {
        Ok(machine) => Ok(machine),
        Err(error) => Err(not_loaded(machine, error)?),
    }
}

/// Prints the mistakes of a machine file.
pub fn not_loaded(machine: &str, error: LoadError) -> io::Result<Failure> {
    Ok(Failure::Usage(match error {
        LoadError::File(message) => message,
        LoadError::Findings(found) => {
            reporting::print(&found)?;
            format!("{machine}: {}", count(found.len() as u64, "error"))
        }
    }))
}
