//! Coordinate words of a line, before their use is known.

use crate::error::{Error, ErrorKind};
use crate::scanner::Word;

/// Coordinate words, at most one per letter.
#[derive(Copy, Clone, Debug, Default)]
pub(crate) struct Operands {
    pub x: Option<Word>,
    pub y: Option<Word>,
    pub a: Option<Word>,
    pub i: Option<Word>,
    pub j: Option<Word>,
}

impl Operands {
    /// Stores a word. Returns an error if its letter is already present.
    pub(crate) fn set(&mut self, word: Word) -> Result<(), Error> {
        let room = match word.letter {
            b'X' => &mut self.x,
            b'Y' => &mut self.y,
            b'A' => &mut self.a,
            b'I' => &mut self.i,
            _ => &mut self.j,
        };
        if room.is_some() {
            return Err(word.error(ErrorKind::RepeatedWord(word.letter)));
        }
        *room = Some(word);
        Ok(())
    }

    /// Returns the first present word in the order of the fields.
    pub(crate) fn first(&self) -> Option<Word> {
        self.x.or(self.y).or(self.of_arc())
    }

    /// Returns the first present word that only arcs have.
    pub(crate) fn of_arc(&self) -> Option<Word> {
        self.a.or(self.i).or(self.j)
    }

    /// Whether there is a coordinate.
    pub(crate) fn has_point(&self) -> bool {
        self.x.is_some() || self.y.is_some()
    }

    /// Returns an error about all words.
    pub(crate) fn error(&self, kind: ErrorKind) -> Error {
        let words = [self.x, self.y, self.a, self.i, self.j];
        let words = words.iter().flatten();
        let at = words.clone().map(|word| word.at).min().unwrap_or(0);
        let end = words.map(|word| word.end).max().unwrap_or(at);
        Error { kind, at, end }
    }
}
