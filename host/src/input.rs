//! Files that a command reads. They are remembered, so that no output replaces one of them.

pub mod columns;

use std::fs::{File, Metadata};
use std::io::{self, Read};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

/// Some editors write these bytes before a text in UTF-8. They are not part of the program.
pub const BYTE_ORDER_MARK: &[u8] = b"\xef\xbb\xbf";

/// The identity of a file, which does not depend on its name.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Identity {
    /// Device, and number on the device.
    #[cfg(unix)]
    number: (u64, u64),
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
            Some(Self { number })
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

/// Opens a file for reading.
///
/// # Errors
///
/// The file cannot be opened, or is a directory.
pub fn open(path: impl AsRef<Path>) -> io::Result<File> {
    let path = path.as_ref();
    let file = File::open(path)?;
    let metadata = file.metadata()?;
    if metadata.is_dir() {
        let kind = io::ErrorKind::InvalidInput;
        return Err(io::Error::new(kind, "is a directory"));
    }
    keep(path, &metadata);
    Ok(file)
}

/// Most bytes that are read as a whole. A device such as `/dev/zero` has no end.
const MOST_BYTES: u64 = 512 << 20;

/// Reads the bytes of a file.
///
/// # Errors
///
/// The file cannot be read, or is larger than 512 MiB.
pub fn read(path: impl AsRef<Path>) -> io::Result<Vec<u8>> {
    to_end(open(path)?)
}

/// Reads to the end.
///
/// # Errors
///
/// Reading fails, or there are more than 512 MiB.
pub fn to_end(input: impl Read) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    input.take(MOST_BYTES + 1).read_to_end(&mut bytes)?;
    if bytes.len() as u64 > MOST_BYTES {
        let kind = io::ErrorKind::FileTooLarge;
        return Err(io::Error::new(
            kind,
            "more than 512 MiB, the most that is read as a whole",
        ));
    }
    Ok(bytes)
}

/// Reads the text of a file.
///
/// # Errors
///
/// The file cannot be read, or is not text in UTF-8.
pub fn read_to_string(path: impl AsRef<Path>) -> io::Result<String> {
    let text = String::from_utf8(read(path)?);
    text.map_err(|_| io::Error::new(io::ErrorKind::InvalidData, "the file is not text in UTF-8"))
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
