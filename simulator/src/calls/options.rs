//! What a call says about a program.

use super::Failed;
use crate::diagnostics::Findings;
use crate::job::{Job, Text};
use crate::machines::machine_file::{LoadError, MachineFile};
use crate::programs::library::{Files, Subroutines};
use serde::Deserialize;
use std::collections::BTreeMap;
use std::io::{self, BufRead};
use std::rc::Rc;

/// Findings of a program that are kept, without an option.
const MOST_FINDINGS: u64 = 1000;

/// A program and its machine.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Options {
    /// Name in messages.
    #[serde(default = "unnamed")]
    pub name: String,
    /// Name of a built-in machine.
    #[serde(default = "free")]
    machine: String,
    /// The text of a machine file, instead.
    machine_text: Option<String>,
    /// Name of that file in messages.
    #[serde(default = "machine_file")]
    machine_file: String,
    dialect: Option<String>,
    zero: Option<String>,
    /// Most findings.
    limit: Option<u64>,
    /// The controller compensates backlash.
    #[serde(default = "yes")]
    pub compensation: bool,
    /// The screws have the backlash of `[simulated_backlash]` of the machine file.
    #[serde(default)]
    pub worn: bool,
    /// Files of subroutines by name.
    #[serde(default)]
    files: BTreeMap<String, String>,
}

fn unnamed() -> String {
    "program.nc".to_owned()
}

fn machine_file() -> String {
    "machine.toml".to_owned()
}

fn free() -> String {
    "free".to_owned()
}

const fn yes() -> bool {
    true
}

impl Options {
    /// No findings, with the limit of the options.
    pub fn findings(&self) -> Findings {
        Findings::new(self.limit.unwrap_or(MOST_FINDINGS))
    }

    /// The machine.
    ///
    /// # Errors
    ///
    /// There is no such machine, or its file has mistakes.
    pub fn machine(&self) -> Result<MachineFile, Failed> {
        let made = match &self.machine_text {
            Some(text) => MachineFile::parse(&self.machine_file, text).map_err(LoadError::Findings),
            None => MachineFile::load(&self.machine, |_| Err(io::ErrorKind::NotFound.into())),
        };
        made.map_err(|error| match error {
            LoadError::File(why) => why.into(),
            LoadError::Findings(found) => {
                let count = found.len();
                Failed::found(format!("the machine file has mistakes: {count}"), &found)
            }
        })
    }

    /// The job of a program, placed.
    ///
    /// # Errors
    ///
    /// The machine or an option is wrong, or the program cannot be read.
    pub fn job(&self, program: &[u8]) -> Result<Job, Failed> {
        let program = Pasted {
            text: Text::new(&*self.name, program),
            files: Rc::new(self.files.clone()),
        };
        let mut job = Job::new(program, self.machine()?, self.dialect.as_deref())?;
        let zero = self.zero.as_deref().filter(|zero| !zero.is_empty());
        job.place(zero.map(str::parse).transpose()?)?;
        Ok(job)
    }
}

/// A program with files of subroutines.
#[derive(Clone, Debug)]
struct Pasted {
    text: Text,
    files: Rc<BTreeMap<String, String>>,
}

impl crate::job::Program for Pasted {
    fn name(&self) -> &str {
        self.text.name()
    }

    fn bytes(&self) -> io::Result<Box<dyn BufRead>> {
        self.text.bytes()
    }

    fn subroutines(&self) -> Subroutines {
        Subroutines::new(Named(Rc::clone(&self.files)))
    }
}

/// Files by name, with or without their ending.
#[derive(Debug)]
struct Named(Rc<BTreeMap<String, String>>);

impl Files for Named {
    fn find(&self, name: &str) -> Option<(String, Vec<u8>)> {
        let names = [format!("{name}.ngc"), format!("{name}.nc"), name.to_owned()];
        let found = names
            .into_iter()
            .find_map(|name| self.0.get_key_value(&name));
        found.map(|(name, text)| (name.clone(), text.clone().into_bytes()))
    }
}
