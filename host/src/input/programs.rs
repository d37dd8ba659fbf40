//! Programs in files, or from standard input.

use super::{bounded, open, stdin};
use crate::console::progress;
use husillo_simulator::programs::source::{Source, expect_text};
use std::io::{self, BufRead, BufReader};

/// Opens a program: a file, or standard input for `-`. Progress is shown while it is read.
///
/// # Errors
///
/// As [`open_bytes`].
pub fn program(path: &str) -> io::Result<Source> {
    Ok(Source::from_reader(open_bytes(path)?).with_watch(progress::reading()))
}

/// Opens the bytes of a program: a file, or standard input for `-`.
///
/// # Errors
///
/// The file cannot be opened, is a directory, or is text in UTF-16. Reading it fails after 512 MiB
/// if it is no regular file.
pub fn open_bytes(path: &str) -> io::Result<Box<dyn BufRead>> {
    let mut reader: Box<dyn BufRead> = if path == "-" {
        Box::new(BufReader::new(bounded(stdin())))
    } else {
        let file = open(path)?;
        match file.metadata()?.is_file() {
            // A regular file has an end, and is not kept in memory.
            true => Box::new(BufReader::with_capacity(1 << 18, file)),
            false => Box::new(BufReader::with_capacity(1 << 18, bounded(file))),
        }
    };
    expect_text(&mut *reader)?;
    Ok(reader)
}
