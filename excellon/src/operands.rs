//! The coordinate words of a line, before it is known what they are for.

use crate::error::{Error, ErrorKind};
use crate::scanner::Word;

/// At most one word a letter.
#[derive(Copy, Clone, Debug, Default)]
pub(crate) struct Operands {
    pub x: Option<Word>,
    pub y: Option<Word>,
    pub a: Option<Word>,
    pub i: Option<Word>,
    pub j: Option<Word>,
}

impl Operands {
    /// Keeps a word; an error for a letter that is there already.
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

    /// The first word of the list of letters that is there.
    pub(crate) fn first(&self) -> Option<Word> {
        self.x.or(self.y).or(self.of_arc())
    }

    /// The first word that only an arc has.
    pub(crate) fn of_arc(&self) -> Option<Word> {
        self.a.or(self.i).or(self.j)
    }

    /// Whether there is a coordinate.
    pub(crate) fn has_point(&self) -> bool {
        self.x.is_some() || self.y.is_some()
    }

    /// An error about all of the words.
    pub(crate) fn error(&self, kind: ErrorKind) -> Error {
        let words = [self.x, self.y, self.a, self.i, self.j];
        let words = words.iter().flatten();
        let at = words.clone().map(|word| word.at).min().unwrap_or(0);
        let end = words.map(|word| word.end).max().unwrap_or(at);
        Error { kind, at, end }
    }
}
