//! Why a machine file cannot be loaded.

use crate::diagnostics::Finding;
use std::io;

/// Why a machine file cannot be loaded.
#[derive(Debug)]
pub enum LoadError {
    /// The file cannot be read.
    File(String),
    /// The file has mistakes.
    Findings(Vec<Finding>),
}

/// Reads the text of a machine file with `read`. `kind` says what kind of machine it is for, and `built_in`
/// lists the built-in machines of that kind. Both are for the message.
///
/// # Errors
///
/// The file cannot be read.
pub fn read_text(
    path: &str,
    kind: &str,
    built_in: &str,
    read: impl FnOnce(&str) -> io::Result<String>,
) -> Result<String, LoadError> {
    read(path).map_err(|error| {
        LoadError::File(match error.kind() {
            io::ErrorKind::NotFound => {
                format!("no {kind} `{path}`: {built_in} are built in, and there is no such file")
            }
            _ => format!("`{path}` as the file of a {kind}: {error}; {built_in} are built in"),
        })
    })
}
