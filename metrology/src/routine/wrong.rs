//! What is wrong with a line of a routine.

use std::ops::Range;

/// What is wrong with a line, and where.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Wrong {
    /// The kind of mistake, one of [`code`].
    pub code: &'static str,
    /// What is wrong, lower case, no full stop.
    pub message: String,
    /// The bytes of the line that it is about.
    pub span: Range<usize>,
    /// What is to be said beside these bytes; may be empty.
    pub label: String,
    /// What to write instead.
    pub help: Option<String>,
}

/// A line of a routine that is not understood.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Mistake {
    /// Number of the line, from 1.
    pub line: usize,
    /// What is wrong with it.
    pub wrong: Wrong,
}

impl Wrong {
    pub(super) fn new(code: &'static str, message: impl Into<String>, span: Range<usize>) -> Self {
        Self {
            code,
            message: message.into(),
            span,
            label: String::new(),
            help: None,
        }
    }

    pub(super) fn label(mut self, label: impl Into<String>) -> Self {
        self.label = label.into();
        self
    }

    pub(super) fn help(mut self, help: impl Into<String>) -> Self {
        self.help = Some(help.into());
        self
    }
}

/// Codes of mistakes.
pub mod code {
    /// A word that is none.
    pub const WORD: &str = "E1001";
    /// A number or a unit.
    pub const NUMBER: &str = "E1002";
    /// Something that is not there.
    pub const MISSING: &str = "E1003";
    /// A name.
    pub const NAME: &str = "E1004";
    /// A tolerance.
    pub const TOLERANCE: &str = "E1005";
    /// Something that is there twice.
    pub const TWICE: &str = "E1006";
    /// The machine, or what was measured.
    pub const MACHINE: &str = "E1010";
}
