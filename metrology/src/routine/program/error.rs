//! What is wrong with a measuring program, or went wrong in it.

use crate::routine::Failure;
use std::fmt;
use std::ops::Range;

/// What is wrong with a line of a program, or went wrong at it.
#[derive(Debug)]
pub struct ProgramError {
    /// Number of the line, from 1.
    pub line: usize,
    /// The line.
    pub text: Vec<u8>,
    /// What is wrong.
    pub fault: ProgramFault,
}

/// What is wrong with a line.
#[derive(Debug)]
pub enum ProgramFault {
    /// It is no G-code.
    Code(husillo_gcode::Error),
    /// It asks for what no measuring machine does: the bytes of the word, or the whole line.
    Foreign(Option<Range<usize>>),
    /// A cycle is not called as it has to be.
    Call {
        /// What is wrong.
        message: &'static str,
        /// How the cycle is called, or what its arguments must be, where that helps.
        expected: Option<String>,
    },
    /// It was not carried out.
    Failed(Failure),
}

impl fmt::Display for ProgramFault {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Code(error) => error.fmt(out),
            Self::Foreign(_) => out.write_str("not on a measuring machine"),
            Self::Call { message, .. } => out.write_str(message),
            Self::Failed(failure) => failure.fmt(out),
        }
    }
}

impl fmt::Display for ProgramError {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(out, "line {}: {}", self.line, self.fault)
    }
}

impl std::error::Error for ProgramError {}

/// A line while it is carried out.
#[derive(Clone, Copy, Debug)]
pub(super) struct At<'a> {
    /// Number of the line, from 1.
    pub line: usize,
    /// The line.
    pub text: &'a [u8],
}

impl At<'_> {
    /// What is wrong with the line.
    pub fn error(&self, fault: ProgramFault) -> ProgramError {
        ProgramError {
            line: self.line,
            text: self.text.to_vec(),
            fault,
        }
    }

    /// A failure at it.
    pub fn failed(&self, failure: impl Into<Failure>) -> Box<ProgramError> {
        Box::new(self.error(ProgramFault::Failed(failure.into())))
    }

    /// It asks for what spindles do.
    pub fn foreign(&self) -> Box<ProgramError> {
        Box::new(self.error(ProgramFault::Foreign(None)))
    }
}
