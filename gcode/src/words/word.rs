//! Words: a letter and a number, with their columns in the text.

use crate::error::Error;
use crate::values::decimal::Decimal;
use crate::words::scanner::Scanner;

/// A letter and its number. `at..end` are the bytes of the text, counted from 0, from the letter to
/// the last digit.
#[derive(Copy, Clone, Eq, PartialEq, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Word {
    /// Upper-case letter, or `@` or `^`.
    pub letter: u8,
    /// The number, exactly.
    pub value: Decimal,
    /// Position of the letter.
    pub at: usize,
    /// Position after the number.
    pub end: usize,
}

/// The words of one line in order. Blanks are ignored everywhere, also inside words. Comments `( )`
/// and `;` are skipped. A `/` before everything else marks a deleted block. A `%` alone (or after
/// `N`) is an empty line. Ends after the first error.
///
/// # Examples
/// ```
/// let words: Result<Vec<_>, _> = husillo_gcode::words(b"g1 x - 1 . 5 (cut)").collect();
/// let printed = words?.into_iter().map(|word| (word.letter, word.value.to_string()));
/// assert_eq!(printed.collect::<Vec<_>>(), [(b'G', "1".into()), (b'X', "-1.5".into())]);
/// # Ok::<(), husillo_gcode::Error>(())
/// ```
#[inline]
pub fn words(line: &[u8]) -> Words<'_> {
    Words {
        scanner: Scanner::new(line),
    }
}

/// Iterator over the words of a line; see [`words`].
#[derive(Clone, Debug)]
pub struct Words<'a> {
    scanner: Scanner<'a, false>,
}

impl Words<'_> {
    /// Whether a `/` (block delete) precedes the first word; known once the first word was
    /// requested.
    pub const fn is_deleted(&self) -> bool {
        self.scanner.deleted
    }
}

impl Iterator for Words<'_> {
    type Item = Result<Word, Error>;

    #[inline(always)]
    fn next(&mut self) -> Option<Self::Item> {
        match self.scanner.next()? {
            Ok(Token::Word(word)) => Some(Ok(word)),
            Ok(Token::EndOfLine) => None,
            Err(error) => Some(Err(error)),
        }
    }
}

impl core::iter::FusedIterator for Words<'_> {}

/// An element of a program.
#[derive(Copy, Clone, Eq, PartialEq, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Token {
    /// A word; its positions are those in the whole text.
    Word(Word),
    /// The end of a line: CR, LF or CR LF, or the end of a text that ends without one.
    EndOfLine,
}

/// The words of a whole program with the ends of its lines, in one pass. It gives the same as
/// [`words`] for each line, without searching for the ends of lines first. An error ends only its
/// own line. Then the next line is read.
///
/// # Examples
/// ```
/// use husillo_gcode::{Token, tokens};
/// let lines = tokens(b"G1 X1\nX\nX2").filter(|token| *token == Ok(Token::EndOfLine)).count();
/// let words = tokens(b"G1 X1\nX\nX2").filter(|token| matches!(token, Ok(Token::Word(_)))).count();
/// assert_eq!((lines, words), (3, 3));
/// ```
#[inline]
pub fn tokens(text: &[u8]) -> Tokens<'_> {
    Tokens {
        scanner: Scanner::new(text),
    }
}

/// Iterator over the words and line ends of a program; see [`tokens`].
#[derive(Clone, Debug)]
pub struct Tokens<'a> {
    scanner: Scanner<'a, true>,
}

impl Tokens<'_> {
    /// Whether a `/` (block delete) precedes the first word of this line; known from the request of
    /// its first word until that of the word after its end.
    pub const fn is_deleted(&self) -> bool {
        self.scanner.deleted
    }
}

impl Iterator for Tokens<'_> {
    type Item = Result<Token, Error>;

    #[inline(always)]
    fn next(&mut self) -> Option<Self::Item> {
        self.scanner.next()
    }
}

impl core::iter::FusedIterator for Tokens<'_> {}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use std::string::{String, ToString};
    use std::vec::Vec;

    fn show(line: &str) -> Result<String, (u16, usize, usize)> {
        let words: Result<Vec<Word>, Error> = words(line.as_bytes()).collect();
        let words = words.map_err(|e| (e.kind.code(), e.at, e.end))?;
        let text: Vec<_> = words
            .iter()
            .map(|w| char::from(w.letter).to_string() + &w.value.to_string())
            .collect();
        Ok(text.join(" "))
    }

    #[test]
    fn reads_words() {
        assert_eq!(
            show("N10 g01x1.50Y-.5 (a;b) F+ 1 0 ; rest ("),
            Ok("N10 G1 X1.50 Y-0.5 F10".into())
        );
        assert_eq!(show("% \r\n"), Ok(String::new()));
        assert_eq!(show("N28 %"), Ok("N28".into()));
        assert_eq!(show("/ G0 X1."), Ok("G0 X1".into()));
        assert_eq!(show("(\u{e9})G1"), Ok("G1".into()));
        assert_eq!(
            show("X1.000000000000000000000000000000000"),
            Ok("X1.000000000000000000".into())
        );
    }

    #[test]
    fn says_what_is_wrong_and_where() {
        assert_eq!(show("N030 G01 X1.2.3"), Err((102, 13, 15)));
        assert_eq!(show("G1 X99999999999999999999 Y1"), Err((103, 4, 24)));
        assert_eq!(show("G1 X"), Err((102, 3, 4)));
        assert_eq!(show("G1 X Y1"), Err((102, 3, 4)));
        assert_eq!(show("X--5"), Err((102, 2, 4)));
        assert_eq!(show("G1 \u{e9}"), Err((101, 3, 4)));
        assert_eq!(show("G1 (a (b)"), Ok("G1".to_string()));
        assert_eq!(show("G1 (a (b) c) X2 (d (e) f"), Err((105, 16, 24)));
        assert_eq!(show("G1 (a"), Err((105, 3, 5)));
        assert_eq!(show("X#1"), Err((102, 1, 3)));
        assert_eq!(show("%1"), Err((101, 1, 2)));
        assert_eq!(show("G1 %"), Err((101, 3, 4)));
        assert_eq!(show("N1 G1 %"), Err((101, 6, 7)));
    }

    /// Letters, numbers and ends of lines (`|`); errors by their code and columns.
    fn show_all(text: &str) -> String {
        let show = |token| match token {
            Ok(Token::Word(w)) => std::format!("{}{}", char::from(w.letter), w.value),
            Ok(Token::EndOfLine) => "|".into(),
            Err(Error { kind, at, end }) => std::format!("E{}@{at}..{end}", kind.code()),
        };
        tokens(text.as_bytes())
            .map(show)
            .collect::<Vec<_>>()
            .join(" ")
    }

    #[test]
    fn a_program_is_its_lines() {
        assert_eq!(
            show_all("G1 X1.5\r\n(a) Y 1 0;b\n\n%\nN1%\rX2"),
            "G1 X1.5 | Y10 | | | N1 | X2 |"
        );
        assert_eq!(
            show_all("X1 \n2\nX\n1 Y1\nZ1"),
            "X1 | E101@4..5 | E102@6..7 | E101@8..9 | Z1 |"
        );
        assert_eq!(
            show_all("(a\nG1)X1\n%X1 Y1\n"),
            "E105@0..2 | G1 E101@5..6 | E101@10..11 |"
        );
        assert_eq!(show_all("\n\r\n\n\r"), "| | | |");
        assert_eq!(show_all(" "), "|");
        assert_eq!(show_all(""), "");
    }

    #[test]
    fn a_deleted_line_says_so_until_the_next() {
        let mut program = tokens(b"/X1\nX2\n/\n\n");
        let deleted: Vec<bool> =
            core::iter::from_fn(|| program.next().map(|_| program.is_deleted())).collect();
        assert_eq!(deleted, [true, true, false, false, true, false]);
    }
}
