//! Where the text of a program comes from.

use crate::input;
use crate::programs::library::Subroutines;
use crate::programs::watch::Watch;
use std::fmt::Debug;
use std::io::{self, BufRead, Cursor};
use std::rc::Rc;

/// The text of a program. It is read several times.
pub trait Program: Debug {
    /// Its name in messages. The ending may decide its language.
    fn name(&self) -> &str;

    /// Opens it at its begin.
    ///
    /// # Errors
    ///
    /// It cannot be read, or is no text.
    fn bytes(&self) -> io::Result<Box<dyn BufRead>>;

    /// The files of its subroutines. There are none by default.
    fn subroutines(&self) -> Subroutines {
        Subroutines::default()
    }

    /// What is called while it is read. Nothing is by default.
    fn watch(&self) -> Watch {
        Watch::default()
    }
}

/// A program in memory.
#[derive(Clone)]
pub struct Text {
    name: String,
    bytes: Rc<[u8]>,
}

impl Text {
    /// A program of these bytes.
    pub fn new(name: impl Into<String>, bytes: impl Into<Rc<[u8]>>) -> Self {
        Self {
            name: name.into(),
            bytes: bytes.into(),
        }
    }
}

impl Debug for Text {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Text")
            .field("name", &self.name)
            .finish_non_exhaustive()
    }
}

impl Program for Text {
    fn name(&self) -> &str {
        &self.name
    }

    fn bytes(&self) -> io::Result<Box<dyn BufRead>> {
        input::expect_bytes_of_text(&self.bytes)?;
        Ok(Box::new(Cursor::new(Rc::clone(&self.bytes))))
    }
}
