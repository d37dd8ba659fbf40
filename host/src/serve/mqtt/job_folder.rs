//! The jobs that were ever taken, in a folder: a file for each id.
//!
//! A file that exists is the proof that its id was used. It is made before anything else happens,
//! and it can be made only once, also by several servers that share the folder.

use super::job::{JobState, Report};
use serde::{Deserialize, Serialize};
use std::fmt::Write as _;
use std::fs::{self, File, OpenOptions};
use std::io::{ErrorKind, Write as _};
use std::path::{Path, PathBuf};

/// Longest id, bytes. The name of its file is twice as long.
const LONGEST_ID: usize = 64;

/// The folder.
#[derive(Clone, Debug)]
pub struct JobFolder(PathBuf);

/// What is kept of a job.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
pub struct Record {
    /// The server that has taken it.
    pub node: String,
    /// Number of its machine.
    pub machine: u32,
    /// Name of its program.
    pub name: String,
    /// Its last report.
    #[serde(flatten)]
    pub report: Report,
}

/// Whether an id was used before.
#[derive(Debug, PartialEq)]
pub enum Claim {
    /// It was not.
    First,
    /// It was. This is its last report.
    Used(Report),
}

impl JobFolder {
    /// This folder. It is made if it is not there.
    ///
    /// # Errors
    ///
    /// A sentence about it.
    pub fn new(path: PathBuf) -> Result<Self, String> {
        match fs::create_dir_all(&path) {
            Ok(()) => Ok(Self(path)),
            Err(error) => Err(format!("{}: {error}", path.display())),
        }
    }

    /// Uses an id. At most one call for an id ever returns [`Claim::First`].
    ///
    /// # Errors
    ///
    /// A sentence: the id has a form that is not allowed, or it cannot be noted.
    pub fn claim(&self, record: &Record) -> Result<Claim, String> {
        let id = &record.report.id;
        if !(1..=LONGEST_ID).contains(&id.len()) || id.chars().any(char::is_control) {
            return Err(format!(
                "an id has 1 to {LONGEST_ID} bytes without control characters"
            ));
        }
        let path = self.path(id, "json");
        let made = OpenOptions::new().write(true).create_new(true).open(&path);
        match made {
            Ok(file) => {
                write(file, record)
                    .and_then(|()| self.sync())
                    .map_err(|why| said(&path, why))?;
                Ok(Claim::First)
            }
            Err(error) if error.kind() == ErrorKind::AlreadyExists => {
                let report = read(&path).map(|record| record.report);
                // A server that was killed at this moment has not started it.
                Ok(Claim::Used(report.unwrap_or_else(|| Report {
                    id: id.clone(),
                    state: JobState::Refused,
                    message: "this id was used".into(),
                    line: None,
                })))
            }
            Err(error) => Err(said(&path, error)),
        }
    }

    /// Keeps the program of a job.
    ///
    /// # Errors
    ///
    /// A sentence about the file.
    pub fn keep_program(&self, id: &str, text: &[u8]) -> Result<(), String> {
        let path = self.path(id, "nc");
        let written = File::create(&path).and_then(|mut file| {
            file.write_all(text)?;
            file.sync_all()
        });
        written.map_err(|error| said(&path, error))
    }

    /// The program of a job that has not ended.
    ///
    /// # Errors
    ///
    /// A sentence about the file.
    pub fn program(&self, id: &str) -> Result<Vec<u8>, String> {
        let path = self.path(id, "nc");
        fs::read(&path).map_err(|error| said(&path, error))
    }

    /// Notes the state of a job. The program of one that has ended is not kept.
    ///
    /// # Errors
    ///
    /// A sentence about the file.
    pub fn note(&self, record: &Record) -> Result<(), String> {
        let id = &record.report.id;
        let (path, beside) = (self.path(id, "json"), self.path(id, "new"));
        let written = File::create(&beside)
            .and_then(|file| write(file, record))
            .and_then(|()| fs::rename(&beside, &path));
        written.map_err(|error| said(&path, error))?;
        if !matches!(
            record.report.state,
            JobState::Running | JobState::Interrupted
        ) {
            self.forget_program(id);
        }
        Ok(())
    }

    /// Does not keep the program of a job any more. Its id stays used.
    pub fn forget_program(&self, id: &str) {
        let _ = fs::remove_file(self.path(id, "nc"));
    }

    /// The jobs of a server that have not ended: accepted ones, and begun ones with their programs.
    ///
    /// # Errors
    ///
    /// A sentence about the folder.
    pub fn open(&self, node: &str) -> Result<Vec<Record>, String> {
        let entries = fs::read_dir(&self.0).map_err(|error| said(&self.0, error))?;
        let paths = entries.filter_map(|entry| Some(entry.ok()?.path()));
        let records = paths
            .filter(|path| path.extension().is_some_and(|end| end == "json"))
            .filter_map(|path| read(&path));
        let is_open = |record: &Record| match record.report.state {
            JobState::Accepted => record.node == node,
            JobState::Running | JobState::Interrupted => {
                record.node == node && self.path(&record.report.id, "nc").exists()
            }
            _ => false,
        };
        Ok(records.filter(is_open).collect())
    }

    fn path(&self, id: &str, end: &str) -> PathBuf {
        let mut name = String::new();
        for byte in id.bytes() {
            // Writing to a text does not fail.
            let _ = write!(name, "{byte:02x}");
        }
        self.0.join(format!("{name}.{end}"))
    }

    /// A new file survives a loss of power only if its folder is written too.
    fn sync(&self) -> std::io::Result<()> {
        match cfg!(unix) {
            true => File::open(&self.0)?.sync_all(),
            false => Ok(()),
        }
    }
}

fn write(mut file: File, record: &Record) -> std::io::Result<()> {
    file.write_all(serde_json::to_string(record)?.as_bytes())?;
    file.sync_all()
}

fn read(path: &Path) -> Option<Record> {
    serde_json::from_slice(&fs::read(path).ok()?).ok()
}

fn said(path: &Path, error: std::io::Error) -> String {
    format!("{}: {error}", path.display())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn record(id: &str, state: JobState) -> Record {
        Record {
            node: "mill".into(),
            machine: 1,
            name: "part.nc".into(),
            report: Report {
                id: id.into(),
                state,
                message: String::new(),
                line: Some(7),
            },
        }
    }

    #[test]
    fn an_id_is_used_once() {
        let path = std::env::temp_dir().join(format!("husillo-jobs-{}", std::process::id()));
        let folder = JobFolder::new(path.clone()).unwrap();
        let accepted = record("a/7 ñ", JobState::Accepted);
        // Of many at the same time, one is the first.
        let firsts = std::thread::scope(|scope| {
            let claim = || folder.claim(&accepted) == Ok(Claim::First);
            let threads: Vec<_> = (0..8).map(|_| scope.spawn(claim)).collect();
            let mut firsts = 0;
            for thread in threads {
                firsts += usize::from(thread.join().unwrap());
            }
            firsts
        });
        assert_eq!(firsts, 1);
        folder.keep_program("a/7 ñ", b"G0 X1").unwrap();
        folder.note(&record("a/7 ñ", JobState::Running)).unwrap();
        let again = JobFolder::new(path.clone()).unwrap();
        let Ok(Claim::Used(report)) = again.claim(&accepted) else {
            panic!("it was used")
        };
        assert_eq!((report.state, report.line), (JobState::Running, Some(7)));
        assert_eq!(again.open("mill").unwrap().len(), 1);
        assert!(again.open("other").unwrap().is_empty());
        assert_eq!(again.program("a/7 ñ").unwrap(), b"G0 X1");
        again.note(&record("a/7 ñ", JobState::Done)).unwrap();
        assert!(again.program("a/7 ñ").is_err());
        assert!(again.open("mill").unwrap().is_empty());
        // A file that was never completed counts too.
        fs::write(again.path("b", "json"), "").unwrap();
        assert!(matches!(
            again.claim(&record("b", JobState::Accepted)),
            Ok(Claim::Used(_))
        ));
        for wrong in ["", "a\n", &"x".repeat(65)] {
            assert!(folder.claim(&record(wrong, JobState::Accepted)).is_err());
        }
        fs::remove_dir_all(&path).unwrap();
    }
}
