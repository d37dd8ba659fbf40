//! One line with expressions: its words, and the assignments that take effect after it.

use super::expression::Reader;
use super::table::Key;
use super::value::Value;
use crate::error::parameters::Fault;
use crate::error::{Error, ErrorKind};
use crate::words::word::Word;

/// Largest number of assignments on a line.
const ASSIGNMENTS: usize = 10;

/// `#n = value`, to be made after its line was read.
#[derive(Copy, Clone, Debug)]
pub(super) struct Assignment<'t> {
    pub(super) key: Key<'t>,
    pub(super) value: Value,
    pub(super) at: usize,
    pub(super) end: usize,
}

/// The assignments of one line, in order.
#[derive(Debug)]
pub(super) struct Assignments<'t> {
    entries: [Option<Assignment<'t>>; ASSIGNMENTS],
}

impl<'t> Assignments<'t> {
    pub(super) const NONE: Assignments<'t> = Assignments {
        entries: [None; ASSIGNMENTS],
    };

    fn push(&mut self, assignment: Assignment<'t>) -> Result<(), Fault> {
        let slot = self.entries.iter_mut().find(|entry| entry.is_none());
        *slot.ok_or(Fault::TooManyAssignments)? = Some(assignment);
        Ok(())
    }

    pub(super) fn iter(&self) -> impl Iterator<Item = &Assignment<'t>> {
        self.entries.iter().flatten()
    }
}

/// The words of a line, evaluated. Assignments go to `assignments`: within the line the old values
/// hold, as in RS-274/NGC.
pub(super) struct Evaluated<'a, 't, F> {
    text: &'t [u8],
    reader: Reader<'t, F>,
    assignments: &'a mut Assignments<'t>,
    /// Whether only blanks and comments were read so far.
    start: bool,
}

impl<'a, 't, F: Fn(Key<'t>) -> Option<Value>> Evaluated<'a, 't, F> {
    pub(super) const fn new(
        text: &'t [u8],
        assignments: &'a mut Assignments<'t>,
        lookup: F,
    ) -> Self {
        Evaluated {
            text,
            reader: Reader::new(text, 0, lookup),
            assignments,
            start: true,
        }
    }

    /// The next word; `None` after the last one.
    pub(super) fn word(&mut self) -> Result<Option<Word>, Error> {
        loop {
            let Some(byte) = self.reader.peek() else {
                return Ok(None);
            };
            let at = self.reader.at();
            match byte {
                b'(' => self.reader.pass_comment()?,
                b';' => return Ok(None),
                b'/' if self.start => {
                    self.start = false;
                    self.reader.advance();
                }
                b'#' => {
                    self.start = false;
                    self.assignment(at)?;
                }
                b'A'..=b'Z' | b'@' | b'^' => {
                    self.start = false;
                    self.reader.advance();
                    let value = match self.reader.peek() {
                        Some(b'0'..=b'9' | b'.' | b'+' | b'-' | b'#' | b'[' | b'A'..=b'Z') => {
                            self.reader.value()?
                        }
                        _ => {
                            return Err(Error {
                                kind: ErrorKind::MissingNumber(byte),
                                at,
                                end: self.reader.end(),
                            });
                        }
                    };
                    return Ok(Some(Word {
                        letter: byte,
                        value: value.to_decimal(),
                        at,
                        end: self.reader.end(),
                    }));
                }
                b'[' | b']' => return Err(self.reader.error_here(Fault::OpenBracket)),
                _ => {
                    let original = self.text.get(at).copied().unwrap_or(byte);
                    return Err(Error {
                        kind: match original {
                            b',' if !self.start => ErrorKind::DecimalComma,
                            _ => ErrorKind::NotALetter(original),
                        },
                        at,
                        end: at.wrapping_add(1),
                    });
                }
            }
        }
    }

    fn assignment(&mut self, at: usize) -> Result<(), Error> {
        self.reader.advance();
        let key = self.reader.key(at)?;
        if !self.reader.take(b'=') {
            return Err(self.reader.error(Fault::NoAssignment, at));
        }
        let value = self.reader.value()?;
        let end = self.reader.end();
        self.assignments
            .push(Assignment {
                key,
                value,
                at,
                end,
            })
            .map_err(|fault| self.reader.error(fault, at))
    }
}
