//! Files that a command writes: all of them whole, or none.
//!
//! Each is written beside its place under another name and renamed when all of the command are
//! whole, in the order in which they were begun. Until then, and where the program is killed or the
//! device is full, the old files are what they were. What is no plain file (a terminal, a pipe,
//! `/dev/null`, `-`) is written as it comes.

use crate::console;
use crate::console::stop::on_request;
use crate::input::{self, Identity};
use std::fs::{File, Metadata, OpenOptions};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

/// Names of files that are not whole yet: what Ctrl-C removes.
static UNFINISHED: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

/// Exit status of a program that was asked to end: 128 and the number of the signal of Ctrl-C.
const INTERRUPTED: i32 = 130;

/// Room of a writer, so that rows of a table do not go to the system one by one.
const BUFFER: usize = 1 << 18;

/// The files of one command.
#[derive(Debug, Default)]
pub struct Outputs {
    files: Vec<Unfinished>,
    /// What went wrong with what is written as it comes.
    direct: Vec<Fault>,
    /// A file may take the place of the one it was read from, as in `format`.
    rewrites: bool,
    /// Nobody else listens to Ctrl-C.
    listens: bool,
}

/// The first error of a writer, with the name of its file.
type Fault = Arc<OnceLock<(io::ErrorKind, String)>>;

/// A file that is not in its place yet.
#[derive(Debug)]
struct Unfinished {
    /// As it was named.
    name: String,
    /// Where it goes, behind all links.
    place: PathBuf,
    /// Where it is written.
    beside: PathBuf,
    /// Which file it replaces.
    old: Option<Identity>,
    /// For the order to write it down.
    file: File,
    fault: Fault,
}

/// Where the bytes of one output go. What it still holds is written when it is dropped.
pub struct Writer {
    name: String,
    out: BufWriter<Box<dyn Write + Send>>,
    fault: Fault,
}

impl Outputs {
    /// No file yet.
    pub fn new() -> Self {
        let mut outputs = Self::default();
        outputs.listens = true;
        outputs
    }

    /// The same, and a file may take the place of one that was read: nothing of it is lost.
    pub fn rewriting() -> Self {
        let mut outputs = Self::new();
        outputs.rewrites = true;
        outputs
    }

    /// Begins a file; `-` is standard output.
    ///
    /// # Errors
    ///
    /// It would take the place of a file that was read, or of another output, or cannot be written.
    pub fn create(&mut self, name: &str) -> io::Result<Writer> {
        if matches!(name, "-" | "/dev/stdout") {
            return Ok(self.direct(name, console::data()));
        }
        let named = |error| named(name, &error);
        let old = std::fs::metadata(name).ok();
        if old.as_ref().is_some_and(Metadata::is_dir) {
            return Err(named(io::ErrorKind::IsADirectory.into()));
        }
        // Handles of this process lead to files that somebody else has opened.
        let handles = ["/dev/fd/", "/dev/stderr", "/proc/"];
        let is_handle = handles.iter().any(|start| name.starts_with(start));
        if is_handle || old.as_ref().is_some_and(|old| !old.is_file()) {
            let file = OpenOptions::new().write(true).open(name).map_err(named)?;
            return Ok(self.direct(name, Box::new(file)));
        }
        let place = place(Path::new(name)).map_err(named)?;
        let old_file = old.as_ref().and_then(|old| Identity::of(&place, old));
        self.expect_own(name, &place, old_file.as_ref())?;
        if old.is_some() {
            // A file that may not be written may not be replaced, either.
            OpenOptions::new().write(true).open(&place).map_err(named)?;
        }
        let (file, beside) = begun(&place, old, self.listens).map_err(named)?;
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

    /// Writes a whole file, which comes to its place with the others.
    ///
    /// # Errors
    ///
    /// Those of [`Outputs::create`], or it cannot be written.
    pub fn write(&mut self, name: &str, bytes: &[u8]) -> io::Result<()> {
        let mut out = self.create(name)?;
        out.write_all(bytes)?;
        out.flush()
    }

    /// Begins a file that others may read while it grows: it is in its place from now on, empty.
    ///
    /// # Errors
    ///
    /// Those of [`Outputs::create`] and [`Outputs::finish`].
    pub fn stream(name: &str) -> io::Result<Writer> {
        let mut outputs = Self::default();
        let writer = outputs.create(name)?;
        outputs.finish()?;
        Ok(writer)
    }

    /// Puts all files into their places. Their writers must have been dropped, or flushed.
    ///
    /// # Errors
    ///
    /// A file is not whole, and then none is put anywhere; or one cannot be put into its place, and
    /// then those before it were.
    pub fn finish(mut self) -> io::Result<()> {
        let faults = self.files.iter().map(|file| &file.fault);
        if let Some((kind, message)) = faults.chain(&self.direct).find_map(|fault| fault.get()) {
            return Err(io::Error::new(*kind, message.clone()));
        }
        for file in &self.files {
            // Read after the output was begun.
            if let Some(old) = &file.old {
                self.expect_not_read(&file.name, old)?;
            }
            file.file
                .sync_all()
                .map_err(|error| named(&file.name, &error))?;
        }
        // Ctrl-C waits until all are renamed.
        let mut unfinished = UNFINISHED.lock().unwrap_or_else(PoisonError::into_inner);
        while let Some(file) = self.files.first() {
            if let Err(error) = std::fs::rename(&file.beside, &file.place) {
                let error = named(&file.name, &error);
                // Which is wanted where the rest is dropped.
                drop(unfinished);
                return Err(error);
            }
            unfinished.retain(|path| *path != file.beside);
            self.files.remove(0);
        }
        Ok(())
    }

    /// Whether a place is that of no other output of this command, and of no input.
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
                "{name} would take the place of {}, which is read: nothing is written",
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
            unfinished.retain(|path| *path != file.beside);
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

/// An error with the name of its file.
fn named(name: &str, error: &io::Error) -> io::Error {
    io::Error::new(error.kind(), format!("{name}: {error}"))
}

fn refused(message: String) -> io::Error {
    io::Error::new(io::ErrorKind::InvalidInput, message)
}

/// The path of a file behind all links, with its folder as the system names it. The file need not
/// be there, nor its folder, which is made then.
fn place(path: &Path) -> io::Result<PathBuf> {
    let mut path = path.to_owned();
    for _ in 0..MOST_LINKS {
        let folder = match path.parent() {
            Some(folder) if !folder.as_os_str().is_empty() => folder,
            _ => Path::new("."),
        };
        if !folder.exists() {
            // One folder, such as `out`, and no path that was mistyped.
            std::fs::create_dir(folder).map_err(|error| {
                io::Error::new(
                    error.kind(),
                    format!("no folder {}: {error}", folder.display()),
                )
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

/// Links behind one another: as many as Linux follows.
const MOST_LINKS: u32 = 40;

/// A new file beside a place, with the permissions of the old one.
fn begun(place: &Path, old: Option<Metadata>, listens: bool) -> io::Result<(File, PathBuf)> {
    let mut number = 0;
    loop {
        let mut name = place.as_os_str().to_owned();
        name.push(format!(".{}-{number}.new", std::process::id()));
        let beside = PathBuf::from(name);
        // The list is locked so that Ctrl-C finds what is made here.
        let mut unfinished = UNFINISHED.lock().unwrap_or_else(PoisonError::into_inner);
        match OpenOptions::new()
            .write(true)
            .create_new(true)
            .open(&beside)
        {
            Ok(file) => {
                if listens && unfinished.is_empty() {
                    remove_when_interrupted();
                }
                unfinished.push(beside.clone());
                if let Some(old) = old {
                    let set = file.set_permissions(old.permissions());
                    set.inspect_err(|_| {
                        // Nothing was written to it.
                        let _ = std::fs::remove_file(&beside);
                        unfinished.pop();
                    })?;
                }
                return Ok((file, beside));
            }
            // Left by a program that was killed, and had the same number.
            Err(error) if error.kind() == io::ErrorKind::AlreadyExists && number < 1000 => {
                number += 1
            }
            Err(error) => return Err(error),
        }
    }
}

/// From now on Ctrl-C, or a request to end, removes what is not whole and ends the program. Where
/// somebody listens already, that is an orderly end, in which this happens, too.
fn remove_when_interrupted() {
    let _ = on_request(|| {
        // Kept locked: nothing comes to its place any more.
        let mut unfinished = UNFINISHED.lock().unwrap_or_else(PoisonError::into_inner);
        for path in unfinished.drain(..) {
            let _ = std::fs::remove_file(path);
        }
        std::process::exit(INTERRUPTED);
    });
}
