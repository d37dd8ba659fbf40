//! Files that a command reads. They are remembered, so that no output replaces one of them.

pub mod columns;
mod folders;
mod programs;

use husillo_simulator::text::name;
use std::fs::{File, Metadata};
use std::io;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};
#[cfg(unix)]
use std::time::SystemTime;

pub use folders::folders;
pub use husillo_simulator::input::{bounded, bounded_by, to_end};
pub use programs::{open_bytes, program};

/// The identity of a file, which does not depend on its name.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Identity {
    /// Device, and number on the device.
    #[cfg(unix)]
    number: (u64, u64),
    /// When it was created, where the system says so: it gives the number of a deleted file to a
    /// new one.
    #[cfg(unix)]
    created: Option<SystemTime>,
    /// Path without links.
    #[cfg(not(unix))]
    path: PathBuf,
}

impl Identity {
    /// The identity of a regular file. `None` for anything else, which may be read and written at
    /// the same time.
    pub fn of(path: &Path, metadata: &Metadata) -> Option<Self> {
        if !metadata.is_file() {
            return None;
        }
        #[cfg(unix)]
        {
            use std::os::unix::fs::MetadataExt;
            let _ = path;
            let number = (metadata.dev(), metadata.ino());
            let created = metadata.created().ok();
            Some(Self { number, created })
        }
        #[cfg(not(unix))]
        {
            let path = path.canonicalize().ok()?;
            Some(Self { path })
        }
    }
}

/// The files that were read, with their names.
static READ: Mutex<Vec<(Identity, PathBuf)>> = Mutex::new(Vec::new());

/// Opens a file for reading. `path` is the text of its name, see [`name`].
///
/// # Errors
///
/// The file cannot be opened, or is a directory.
pub fn open(path: impl AsRef<Path>) -> io::Result<File> {
    let path = &*name::path(path.as_ref());
    let file = File::open(path).map_err(|error| advised(error, &ADVICE))?;
    let metadata = file.metadata()?;
    if metadata.is_dir() {
        let kind = io::ErrorKind::InvalidInput;
        return Err(io::Error::new(kind, "this is a folder: name a file in it"));
    }
    keep(path, &metadata);
    Ok(file)
}

/// What to do about a file that cannot be opened.
const ADVICE: [(io::ErrorKind, &str); 3] = [
    (
        io::ErrorKind::NotFound,
        "there is no such file: check its name and its folder",
    ),
    (
        io::ErrorKind::PermissionDenied,
        "you may not read this file: change its permissions, or name another one",
    ),
    (
        io::ErrorKind::NotADirectory,
        "a part of this path is a file and no folder: check its name",
    ),
];

/// An error with the sentence for its kind, if there is one.
pub fn advised(error: io::Error, advice: &[(io::ErrorKind, &str)]) -> io::Error {
    let kind = error.kind();
    match advice.iter().find(|(known, _)| *known == kind) {
        Some((_, advice)) => io::Error::new(kind, *advice),
        None => error,
    }
}

/// Most bytes of any other text: machine files, manifests, routines, figures, readings.
const MOST_TEXT: u64 = 64 << 20;

/// Reads the bytes of a program or a drill file.
///
/// # Errors
///
/// The file cannot be read, is larger than 512 MiB, or is text in UTF-16.
pub fn read(path: impl AsRef<Path>) -> io::Result<Vec<u8>> {
    to_end(bounded(open(path)?))
}

/// Reads the text of a file other than a program; `-` is standard input.
///
/// # Errors
///
/// The file cannot be read, is larger than 64 MiB, or is not text in UTF-8.
pub fn read_to_string(path: &str) -> io::Result<String> {
    let bytes = match path == "-" {
        true => to_end(bounded_by(stdin(), MOST_TEXT))?,
        false => to_end(bounded_by(open(path)?, MOST_TEXT))?,
    };
    String::from_utf8(bytes).map_err(|_| {
        let why = "this is no text in UTF-8: save it as UTF-8, or name another file";
        io::Error::new(io::ErrorKind::InvalidData, why)
    })
}

/// Standard input. If it comes from a file, that file is remembered too.
pub fn stdin() -> io::Stdin {
    let stdin = io::stdin();
    #[cfg(unix)]
    {
        use std::os::fd::AsFd;
        let file = stdin.as_fd().try_clone_to_owned().map(File::from);
        if let Ok(metadata) = file.and_then(|file| file.metadata()) {
            keep(Path::new("standard input"), &metadata);
        }
    }
    stdin
}

fn keep(path: &Path, metadata: &Metadata) {
    if let Some(identity) = Identity::of(path, metadata) {
        let mut read = READ.lock().unwrap_or_else(PoisonError::into_inner);
        if !read.iter().any(|(known, _)| *known == identity) {
            read.push((identity, path.to_owned()));
        }
    }
}

/// The name under which a file was read. `None` if it was not read.
pub fn name_of(identity: &Identity) -> Option<PathBuf> {
    let read = READ.lock().unwrap_or_else(PoisonError::into_inner);
    let known = read.iter().find(|(known, _)| known == identity);
    known.map(|(_, path)| path.clone())
}
