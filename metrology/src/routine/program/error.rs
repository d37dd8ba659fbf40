//! Errors of measuring programs.

use crate::routine::Failure;
use std::fmt;
use std::ops::Range;

/// An error of a line of a program.
#[derive(Debug)]
pub struct ProgramError {
    /// Number of the line, from 1.
    pub line: usize,
    /// The line.
    pub text: Vec<u8>,
    /// The fault.
    pub fault: ProgramFault,
}

/// The fault of a line.
#[derive(Debug)]
pub enum ProgramFault {
    /// The line is not valid G-code.
    Code(husillo_gcode::Error),
    /// A measuring machine does not have this function. The bytes are those of its word. `None`:
    /// the whole line.
    Foreign(Option<Range<usize>>),
    /// The call of a cycle is wrong.
    Call {
        /// The message.
        message: &'static str,
        /// The right call of the cycle, or a sentence about its arguments.
        expected: Option<String>,
    },
    /// The line was not carried out.
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

/// A line that is carried out.
#[derive(Clone, Copy, Debug)]
pub(super) struct At<'a> {
    /// Number of the line, from 1.
    pub line: usize,
    /// The line.
    pub text: &'a [u8],
}

impl At<'_> {
    /// An error of this line.
    pub fn error(&self, fault: ProgramFault) -> ProgramError {
        ProgramError {
            line: self.line,
            text: self.text.to_vec(),
            fault,
        }
    }

    /// A failure of this line.
    pub fn failed(&self, failure: impl Into<Failure>) -> Box<ProgramError> {
        Box::new(self.error(ProgramFault::Failed(failure.into())))
    }

    /// The error that a measuring machine cannot carry out this line.
    pub fn foreign(&self) -> Box<ProgramError> {
        Box::new(self.error(ProgramFault::Foreign(None)))
    }
}
