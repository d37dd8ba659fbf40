//! A program with the machine it is for, and the files of both.

use super::{Failure, reporting};
use crate::cli::Target;
use crate::cli::Zero;
use crate::diagnostics::Findings;
use crate::input;
use crate::machines::machine_file::{LoadError, MachineFile};
use crate::microfactory;
use crate::programs::check::{self, Facts};
use crate::programs::program::Start;
use crate::programs::setup::{self, Micromill};
use crate::programs::source::Source;
use crate::programs::zero;
use husillo_machine::Config;
use std::io::{self, Read};

/// A program and the machine it is for.
pub struct Job {
    pub file: String,
    pub machine: MachineFile,
    pub config: Config<3>,
    /// Its language, and where it lies on the machine.
    pub start: Start,
    is_placed: bool,
    /// Standard input is read once and kept, as a run reads its program twice; of a list of moves
    /// the program.
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
        Ok(Self {
            file: file.to_owned(),
            machine,
            config,
            start: dialect.into(),
            is_placed: false,
            input: input.map(String::into_bytes),
            #[cfg(test)]
            opened: std::cell::Cell::new(0),
        })
    }

    /// Keeps what can be read once only in memory: standard input, pipes.
    pub fn keep_input(&mut self) -> Result<(), Failure> {
        let metadata = std::fs::metadata(&self.file);
        let is_pipe = metadata.is_ok_and(|file| !file.is_file() && !file.is_dir());
        if self.input.is_none() && (self.file == "-" || is_pipe) {
            self.input = Some(whole(&self.file)?);
        }
        Ok(())
    }

    /// Puts work zero where it is asked for, and the tool to it, as far as the travel goes.
    pub fn place(&mut self, zero: Option<Zero>) -> Result<(), Failure> {
        self.keep_input()?;
        let zero = match zero {
            None => return Ok(()),
            Some(Zero::At(zero)) => zero,
            Some(Zero::Fit) => {
                let mut source = self.open()?;
                let dialect = self.start.dialect;
                let zero = zero::fitting(&mut source, self.name(), dialect, &self.config)?;
                let Some(zero) = zero else { return Ok(()) };
                let [x, y, z] = zero;
                eprintln!("{}: --zero X{x}Y{y}Z{z}", self.name());
                zero
            }
        };
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
        Ok(())
    }

    pub fn open(&self) -> Result<Source, Failure> {
        #[cfg(test)]
        self.opened.set(self.opened.get() + 1);
        match &self.input {
            Some(input) => Ok(Source::from_reader(Box::new(io::Cursor::new(
                input.clone(),
            )))),
            None => Source::open(&self.file)
                .map_err(|error| Failure::Usage(format!("{}: {error}", self.file))),
        }
    }

    /// How the file is called in messages.
    pub fn name(&self) -> &str {
        displayed(&self.file)
    }

    pub fn check(&self, findings: &mut Findings) -> Result<Facts, Failure> {
        let mut source = self.open()?;
        let facts = check::check(
            &mut source,
            self.name(),
            self.start,
            &self.machine,
            &self.config,
            findings,
        )?;
        if let Some(first) = &facts.beyond {
            zero::report_beyond(
                &mut self.open()?,
                self.name(),
                self.start,
                &self.machine,
                &self.config,
                first,
                findings,
            )?;
        }
        Ok(facts)
    }

    pub fn new_machine(&self, compensation: bool) -> Result<Micromill, Failure> {
        let mut machine = setup::with_maps(self.config, setup::maps(&self.machine)?);
        machine.set_compensation(compensation);
        if self.is_placed {
            (machine.place(self.start.zero, self.start.at)).map_err(|error| error.to_string())?;
        }
        Ok(machine)
    }
}

/// How a file is called in messages.
pub fn displayed(file: &str) -> &str {
    if file == "-" { "<input>" } else { file }
}

/// A whole file, or standard input.
pub fn whole(file: &str) -> Result<Vec<u8>, Failure> {
    let mut text = Vec::new();
    let read = match file {
        "-" => input::stdin().read_to_end(&mut text),
        _ => input::open(file).and_then(|mut file| file.read_to_end(&mut text)),
    };
    read.map_err(|error| Failure::Usage(format!("{file}: {error}")))?;
    Ok(text)
}

pub fn load(machine: &str) -> Result<MachineFile, Failure> {
    match MachineFile::load(machine) {
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
            format!("{machine}: {} errors", found.len())
        }
    }))
}
