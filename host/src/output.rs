//! Files that a command writes: either all of them completely, or none.
//!
//! Each file is written under a temporary name in its own folder. When all files of the command are
//! complete and on the device, they are renamed in the order in which they were begun. Until then
//! the old files stay unchanged, also if the program is killed or the device is full. If a file
//! cannot be renamed, the files before it are put back. Outputs that are not regular files (a
//! terminal, a pipe, `/dev/null`, `-`) are written directly.
//!
//! No file system renames several files at once. If the power fails, or the program is killed
//! without a request to end, between two of the renames, the first files are new and the others
//! old, each of them whole. The old files are then kept beside the new ones, as `NAME.*.old`. The
//! next run that writes the same files removes them when its own files are complete.

mod replacing;

use crate::console;
use crate::console::stop::{INTERRUPTED, on_request};
use crate::input::{self, Identity};
use husillo_simulator::text::name::path;
use std::fs::{File, Metadata, OpenOptions};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

/// Temporary files that are not complete yet.
static UNFINISHED: Mutex<Vec<Begun>> = Mutex::new(Vec::new());

/// A temporary file.
struct Begun {
    beside: PathBuf,
    /// Its final path if it is worth keeping at every instant: a record of what happened.
    record: Option<PathBuf>,
}

/// Buffer of a writer, bytes. It keeps rows of a table from going to the system one by one.
const BUFFER: usize = 1 << 18;

/// The files of one command.
#[derive(Debug, Default)]
pub struct Outputs {
    files: Vec<Unfinished>,
    /// Errors of outputs that are written directly.
    direct: Vec<Fault>,
    /// An output may replace the file that was read, as in `format`.
    rewrites: bool,
    /// A record of what happens, which is complete whenever the command ends. Another part of the
    /// program handles Ctrl-C.
    is_record: bool,
}

/// The first error of a writer, with the name of its file.
type Fault = Arc<OnceLock<(io::ErrorKind, String)>>;

/// A file that is not renamed yet.
#[derive(Debug)]
struct Unfinished {
    /// Its name as given by the user.
    name: String,
    /// Its final path, with all links resolved.
    place: PathBuf,
    /// Its temporary path.
    beside: PathBuf,
    /// The file that it replaces.
    old: Option<Identity>,
    /// The open file, to flush it to the device.
    file: File,
    fault: Fault,
}

/// Writes one output. It flushes its buffer when it is dropped.
pub struct Writer {
    name: String,
    out: BufWriter<Box<dyn Write + Send>>,
    fault: Fault,
}

impl Outputs {
    /// Starts without files.
    pub fn new() -> Self {
        Self::default()
    }

    /// The record of what happens while a command runs. At Ctrl-C it ends as it is.
    pub fn record() -> Self {
        let mut outputs = Self::default();
        outputs.is_record = true;
        outputs
    }

    /// As [`Outputs::new`], but an output may replace a file that was read. It is complete by then,
    /// so nothing is lost.
    pub fn rewriting() -> Self {
        let mut outputs = Self::new();
        outputs.rewrites = true;
        outputs
    }

    /// Begins a file; `-` is standard output.
    ///
    /// # Errors
    ///
    /// The file would replace one that was read, or another output, or it cannot be written.
    pub fn create(&mut self, name: &str) -> io::Result<Writer> {
        if matches!(name, "-" | "/dev/stdout") {
            return Ok(self.direct(name, console::data()));
        }
        let named = |error| named(name, &error);
        let path = &*path(Path::new(name));
        let old = std::fs::metadata(path).ok();
        if old.as_ref().is_some_and(Metadata::is_dir) {
            return Err(named(io::ErrorKind::IsADirectory.into()));
        }
        // Handles of this process lead to files that another program has opened.
        let handles = ["/dev/fd/", "/dev/stderr", "/proc/"];
        let is_handle = handles.iter().any(|start| name.starts_with(start));
        if is_handle || old.as_ref().is_some_and(|old| !old.is_file()) {
            let file = OpenOptions::new().write(true).open(path).map_err(named)?;
            return Ok(self.direct(name, Box::new(file)));
        }
        let place = place(path).map_err(named)?;
        let old_file = old.as_ref().and_then(|old| Identity::of(&place, old));
        self.expect_own(name, &place, old_file.as_ref())?;
        if old.is_some() {
            // A file without write permission must not be replaced either.
            OpenOptions::new().write(true).open(&place).map_err(named)?;
        }
        let (file, beside) = begun(&place, old, self.is_record).map_err(named)?;
        let fault = Fault::default();
        let copy = file.try_clone();
        self.files.push(Unfinished {
            name: name.to_owned(),
            place,
            beside,
            old: old_file,
            file,
            fault: Arc::clone(&fault),
        });
        Ok(Writer::new(name, Box::new(copy.map_err(named)?), fault))
    }

    fn direct(&mut self, name: &str, out: Box<dyn Write + Send>) -> Writer {
        let fault = Fault::default();
        self.direct.push(Arc::clone(&fault));
        Writer::new(name, out, fault)
    }

    /// Writes a whole file, which is renamed together with the others.
    ///
    /// # Errors
    ///
    /// As [`Outputs::create`], or the file cannot be written.
    pub fn write(&mut self, name: &str, bytes: &[u8]) -> io::Result<()> {
        let mut out = self.create(name)?;
        out.write_all(bytes)?;
        out.flush()
    }

    /// Renames all files to their final names. Their writers must be dropped or flushed before.
    ///
    /// # Errors
    ///
    /// A file is not complete, or cannot be renamed. Then all old files are as before.
    pub fn finish(mut self) -> io::Result<()> {
        let faults = self.files.iter().map(|file| &file.fault);
        if let Some((kind, message)) = faults.chain(&self.direct).find_map(|fault| fault.get()) {
            return Err(io::Error::new(*kind, message.clone()));
        }
        for file in &self.files {
            // The file may have been read after the output was begun.
            if let Some(old) = &file.old {
                self.expect_not_read(&file.name, old)?;
            }
            file.file
                .sync_all()
                .map_err(|error| named(&file.name, &error))?;
        }
        // The lock makes Ctrl-C wait until all are renamed.
        let mut unfinished = UNFINISHED.lock().unwrap_or_else(PoisonError::into_inner);
        let renamed = replacing::rename_all(&self.files, |from, to| std::fs::rename(from, to));
        if renamed.is_ok() {
            let files = std::mem::take(&mut self.files);
            unfinished.retain(|begun| files.iter().all(|file| file.beside != begun.beside));
        }
        // `self` is dropped on return and needs the lock.
        drop(unfinished);
        renamed
    }

    /// Checks that a path belongs to no other output of this command, and to no input.
    fn expect_own(&self, name: &str, place: &Path, old: Option<&Identity>) -> io::Result<()> {
        let mut others = self.files.iter();
        let same = others
            .find(|other| other.place == place || (old.is_some() && other.old.as_ref() == old));
        if let Some(other) = same {
            let message = "two outputs of this command are the same file";
            return Err(refused(format!("{name} and {}: {message}", other.name)));
        }
        old.map_or(Ok(()), |old| self.expect_not_read(name, old))
    }

    fn expect_not_read(&self, name: &str, old: &Identity) -> io::Result<()> {
        match input::name_of(old).filter(|_| !self.rewrites) {
            None => Ok(()),
            Some(read) => Err(refused(format!(
                "{name} would replace {}, which is read: nothing is written",
                read.display()
            ))),
        }
    }
}

impl Drop for Outputs {
    fn drop(&mut self) {
        let mut unfinished = UNFINISHED.lock().unwrap_or_else(PoisonError::into_inner);
        for file in &self.files {
            // It may be gone already.
            let _ = std::fs::remove_file(&file.beside);
            unfinished.retain(|begun| begun.beside != file.beside);
        }
    }
}

impl Writer {
    fn new(name: &str, out: Box<dyn Write + Send>, fault: Fault) -> Self {
        Self {
            name: name.to_owned(),
            out: BufWriter::with_capacity(BUFFER, out),
            fault,
        }
    }

    fn noted<T>(&self, result: io::Result<T>) -> io::Result<T> {
        result.map_err(|error| {
            let error = named(&self.name, &error);
            // The first one is kept.
            let _ = self.fault.set((error.kind(), error.to_string()));
            error
        })
    }
}

impl Write for Writer {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let result = self.out.write(bytes);
        self.noted(result)
    }

    fn flush(&mut self) -> io::Result<()> {
        let result = self.out.flush();
        self.noted(result)
    }
}

impl Drop for Writer {
    fn drop(&mut self) {
        // An error is kept for `Outputs::finish`.
        let _ = self.flush();
    }
}

/// What to do about a file that cannot be written.
const ADVICE: [(io::ErrorKind, &str); 4] = [
    (
        io::ErrorKind::PermissionDenied,
        "you may not write this file: name one in a folder of yours",
    ),
    (
        io::ErrorKind::IsADirectory,
        "this is a folder: name a file in it",
    ),
    (
        io::ErrorKind::NotADirectory,
        "a part of this path is a file and no folder: name another one",
    ),
    (
        io::ErrorKind::StorageFull,
        "No space left on device: make room, or name a file on another one",
    ),
];

/// An error with the name of its file.
fn named(name: &str, error: &io::Error) -> io::Error {
    let kind = error.kind();
    let advice = ADVICE.iter().find(|(known, _)| *known == kind);
    // A text of this module says already what to do.
    let advice = advice.filter(|_| error.get_ref().is_none());
    match advice {
        Some((_, advice)) => io::Error::new(kind, format!("{name}: {advice}")),
        None => io::Error::new(kind, format!("{name}: {error}")),
    }
}

fn refused(message: String) -> io::Error {
    io::Error::new(io::ErrorKind::InvalidInput, message)
}

/// The path of a file with all links resolved. The file need not exist. A missing folder is made.
fn place(path: &Path) -> io::Result<PathBuf> {
    let mut path = path.to_owned();
    for _ in 0..MOST_LINKS {
        let folder = match path.parent() {
            Some(folder) if !folder.as_os_str().is_empty() => folder,
            _ => Path::new("."),
        };
        if !folder.exists() {
            // Makes one folder, such as `out`, but no chain of folders, which may be mistyped.
            std::fs::create_dir(folder).map_err(|error| {
                let folder = folder.display();
                let why = format!("there is no folder {folder}, and none is made: name another");
                io::Error::new(error.kind(), why)
            })?;
        }
        let folder = folder.canonicalize()?;
        let name = path.file_name().ok_or(io::ErrorKind::InvalidFilename)?;
        let whole = folder.join(name);
        match std::fs::read_link(&whole) {
            Ok(target) => path = folder.join(target),
            Err(_) => return Ok(whole),
        }
    }
    Err(io::Error::other("too many links"))
}

/// Longest chain of links; Linux follows as many.
const MOST_LINKS: u32 = 40;

/// Makes a temporary file in the folder of `place`, with the permissions of the old file.
fn begun(place: &Path, old: Option<Metadata>, is_record: bool) -> io::Result<(File, PathBuf)> {
    let mut number = 0;
    loop {
        let mut name = place.as_os_str().to_owned();
        name.push(format!(".{}-{number}.new", std::process::id()));
        let beside = PathBuf::from(name);
        // The list is locked, so that Ctrl-C finds the new file.
        let mut unfinished = UNFINISHED.lock().unwrap_or_else(PoisonError::into_inner);
        match OpenOptions::new()
            .write(true)
            .create_new(true)
            .open(&beside)
        {
            Ok(file) => {
                if !is_record && unfinished.is_empty() {
                    end_when_interrupted();
                }
                unfinished.push(Begun {
                    beside: beside.clone(),
                    record: is_record.then(|| place.to_owned()),
                });
                if let Some(old) = old {
                    let set = file.set_permissions(old.permissions());
                    set.inspect_err(|_| {
                        // The new file is still empty.
                        let _ = std::fs::remove_file(&beside);
                        unfinished.pop();
                    })?;
                }
                return Ok((file, beside));
            }
            // A killed program with the same process number has left this file.
            Err(error) if error.kind() == io::ErrorKind::AlreadyExists && number < 1000 => {
                number += 1
            }
            Err(error) => return Err(error),
        }
    }
}

/// From now on Ctrl-C, or a request to end, ends the files and the program. If the program already
/// has a handler, its orderly end does this too.
fn end_when_interrupted() {
    let _ = on_request(|| exit(INTERRUPTED));
}

/// Ends the program at once: records get their final names, other incomplete files are removed.
pub fn exit(status: u8) -> ! {
    // The lock is kept, so that no file is renamed any more.
    let mut unfinished = UNFINISHED.lock().unwrap_or_else(PoisonError::into_inner);
    for begun in unfinished.drain(..) {
        let _ = match begun.record {
            Some(place) => std::fs::rename(begun.beside, place),
            None => std::fs::remove_file(begun.beside),
        };
    }
    std::process::exit(status.into());
}
