//! Mistakes in the lines of a routine.

use std::ops::Range;

/// A mistake in a line, and its position.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Wrong {
    /// The kind of mistake, one of [`code`].
    pub code: &'static str,
    /// The message, lower case, without a full stop.
    pub message: String,
    /// The bytes of the line with the mistake.
    pub span: Range<usize>,
    /// A remark at these bytes. It may be empty.
    pub label: String,
    /// Advice on what to write instead.
    pub help: Option<String>,
}

/// A line of a routine with a mistake.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Mistake {
    /// Number of the line, from 1.
    pub line: usize,
    /// The mistake.
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
    /// An unknown word, or a word in the wrong place.
    pub const WORD: &str = "E1001";
    /// A wrong number or unit.
    pub const NUMBER: &str = "E1002";
    /// Something is missing.
    pub const MISSING: &str = "E1003";
    /// A wrong name.
    pub const NAME: &str = "E1004";
    /// A wrong tolerance.
    pub const TOLERANCE: &str = "E1005";
    /// Something is given twice.
    pub const TWICE: &str = "E1006";
    /// A failure of the machine or of a fit.
    pub const MACHINE: &str = "E1010";
}
