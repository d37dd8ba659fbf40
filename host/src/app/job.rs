//! A program of the command line with its machine, and the files of both.

use super::Failure;
use super::reporting::{self, count};
use crate::cli::{Target, Zero};
use crate::console::progress;
use crate::input;
use crate::microfactory;
use husillo_gcode::Dialect;
use husillo_simulator::diagnostics::Findings;
use husillo_simulator::job::{self, JobError, Program};
use husillo_simulator::machines::machine_file::{LoadError, MachineFile};
use husillo_simulator::programs::check::Facts;
use husillo_simulator::programs::library::Subroutines;
use husillo_simulator::programs::watch::Watch;
use husillo_simulator::text::name;
use std::io::{self, BufRead, Cursor};
use std::ops::{Deref, DerefMut};
use std::path::Path;
use std::rc::Rc;

/// A job whose program is a file or standard input. Its notes are printed.
pub struct Job {
    job: job::Job,
    pub file: String,
    /// Further folders with files of subroutines.
    include: Vec<String>,
    /// Only a check whether the machine accepts the program: no message is printed.
    pub(super) is_trial: bool,
    /// The messages of a trial.
    pub(super) notes: Vec<String>,
    /// The result of the check, where it is known.
    pub(super) checked: Option<(Facts, Findings)>,
    /// Standard input is read once and kept, because a run reads its program twice. For a list of
    /// moves this is the program made from it.
    pub input: Option<Rc<[u8]>>,
    /// How often the program was opened.
    #[cfg(test)]
    pub opened: Rc<std::cell::Cell<u32>>,
}

/// The file of a program, or standard input.
#[derive(Debug)]
struct FileProgram {
    file: String,
    include: Vec<String>,
    input: Option<Rc<[u8]>>,
    #[cfg(test)]
    opened: Rc<std::cell::Cell<u32>>,
}

impl Program for FileProgram {
    fn name(&self) -> &str {
        displayed(&self.file)
    }

    fn bytes(&self) -> io::Result<Box<dyn BufRead>> {
        match &self.input {
            Some(input) => Ok(Box::new(Cursor::new(Rc::clone(input)))),
            None => input::open_bytes(&self.file),
        }
    }

    fn subroutines(&self) -> Subroutines {
        input::folders(&self.file, &self.include)
    }

    fn watch(&self) -> Watch {
        #[cfg(test)]
        self.opened.set(self.opened.get() + 1);
        match &self.input {
            Some(_) => Watch::default(),
            None => progress::reading(),
        }
    }
}

impl Deref for Job {
    type Target = job::Job;

    fn deref(&self) -> &job::Job {
        &self.job
    }
}

impl DerefMut for Job {
    fn deref_mut(&mut self) -> &mut job::Job {
        &mut self.job
    }
}

impl From<JobError> for Failure {
    fn from(error: JobError) -> Self {
        match error {
            JobError::Io(error) => error.into(),
            JobError::Message(message) => message.into(),
        }
    }
}

impl Job {
    pub fn new(file: &str, target: &Target, default_machine: &str) -> Result<Self, Failure> {
        let name = target.machine.as_deref().unwrap_or(default_machine);
        let machine = load(name)?;
        let settings = microfactory::settings_of(&machine);
        #[cfg(test)]
        let opened = Rc::default();
        let mut program = FileProgram {
            file: file.to_owned(),
            include: target.include.clone(),
            input: None,
            #[cfg(test)]
            opened: Rc::clone(&opened),
        };
        let input: Option<Rc<[u8]>> = match settings {
            Some(settings) => microfactory::program(file, &settings)?,
            None if microfactory::is_list(file) => return Err(super::only_microfactory(file)),
            None => None,
        }
        .map(|text| text.into_bytes().into());
        program.input.clone_from(&input);
        Ok(Self {
            job: job::Job::new(program, machine, target.dialect.as_deref())?,
            file: file.to_owned(),
            include: target.include.clone(),
            is_trial: false,
            notes: Vec::new(),
            checked: None,
            input,
            #[cfg(test)]
            opened,
        })
    }

    /// The same program for another machine.
    pub(super) fn on(&self, machine: &str, target: &Target) -> Result<Self, Failure> {
        let mut job = Self::new(&self.file, target, machine)?;
        if let (None, Some(input)) = (&job.input, &self.input) {
            job.keep(Rc::clone(input));
        }
        Ok(job)
    }

    /// The file, or what is kept of it.
    fn program(&self) -> FileProgram {
        FileProgram {
            file: self.file.clone(),
            include: self.include.clone(),
            input: self.input.clone(),
            #[cfg(test)]
            opened: Rc::clone(&self.opened),
        }
    }

    fn keep(&mut self, input: Rc<[u8]>) {
        self.input = Some(input);
        let program = self.program();
        self.job.read_from(program);
    }

    /// Replaces the program by one in RS-274 that was made from it.
    pub fn replace(&mut self, text: String) {
        self.keep(text.into_bytes().into());
        self.job.start.dialect = Dialect::RS274;
        self.job.config.dialect = Dialect::RS274;
    }

    /// Keeps what can be read once only in memory: standard input, pipes.
    pub fn keep_input(&mut self) -> Result<(), Failure> {
        let metadata = std::fs::metadata(name::path(Path::new(&self.file)));
        let is_pipe = metadata.is_ok_and(|file| !file.is_file() && !file.is_dir());
        if self.input.is_none() && (self.file == "-" || is_pipe) {
            self.keep(whole(&self.file)?.into());
        }
        Ok(())
    }

    /// Puts work zero where it is asked for; see [`job::Job::place`].
    pub fn place(&mut self, zero: Option<Zero>) -> Result<(), Failure> {
        self.keep_input()?;
        let placed = self.job.place(zero);
        self.tell();
        Ok(placed?)
    }

    /// Checks the program; see [`job::Job::check`].
    pub fn check(&mut self, findings: &mut Findings) -> Result<Facts, Failure> {
        if let Some((facts, found)) = self.checked.take() {
            *findings = found;
            return Ok(facts);
        }
        let checked = self.job.check(findings);
        self.tell();
        Ok(checked?)
    }

    /// Prints the notes of the job. Those of a trial are kept.
    fn tell(&mut self) {
        for note in self.job.take_notes() {
            match self.is_trial {
                true => self.notes.push(note),
                false => eprintln!("{note}"),
            }
        }
    }
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
