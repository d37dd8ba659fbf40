//! The end of a value, without its value, for code that only copies it.

use super::cursor::Cursor;
use crate::error::parameters::Fault;
use crate::error::{Error, ErrorKind};
use crate::values::decimal::Decimal;
use crate::words::word::{Word, words};

/// The position after the word or the assignment that begins at `at`. The contents of brackets are
/// not checked.
///
/// # Errors
/// A bracket without its counterpart, no value, or an assignment without `=`.
pub(crate) fn extent(text: &[u8], at: usize) -> Result<usize, Error> {
    let mut reader = Cursor::new(text, at);
    if reader.peek() == Some(b'#') {
        pass_value(&mut reader)?;
        if !reader.take(b'=') {
            return Err(reader.error(Fault::NoAssignment, at));
        }
    } else {
        reader.advance();
    }
    pass_value(&mut reader)?;
    Ok(reader.end())
}

/// Skips signs, `#`, and the number, name, bracket or function after them.
fn pass_value(reader: &mut Cursor<'_>) -> Result<(), Error> {
    let from = reader.at();
    let mut is_index = false;
    loop {
        match reader.peek() {
            Some(b'+' | b'-') => reader.advance(),
            Some(b'#') => {
                reader.advance();
                is_index = true;
                continue;
            }
            Some(b'<') if is_index => return reader.name(from).map(|_| ()),
            Some(b'[') => return pass_bracket(reader),
            Some(b'0'..=b'9' | b'.') => {
                while matches!(reader.peek(), Some(b'0'..=b'9' | b'.')) {
                    reader.advance();
                }
                return Ok(());
            }
            Some(b'A'..=b'Z') => {
                let name = reader.letters();
                if reader.peek() != Some(b'[') {
                    return Err(reader.error_here(Fault::NoBracket));
                }
                pass_bracket(reader)?;
                if name.bytes() == b"ATAN" {
                    if !reader.take(b'/') {
                        return Err(reader.error(Fault::NoSecondValue, from));
                    }
                    pass_bracket(reader)?;
                }
                return Ok(());
            }
            _ => return Err(reader.error_here(Fault::NoValue)),
        }
        is_index = false;
    }
}

/// Skips the bracket that comes next, with its contents.
fn pass_bracket(reader: &mut Cursor<'_>) -> Result<(), Error> {
    reader.peek();
    let from = reader.at();
    let mut depth = 0u32;
    let mut before = 0;
    while let Some(byte) = reader.peek() {
        match byte {
            b'<' if before == b'#' => {
                reader.name(from)?;
                before = 0;
                continue;
            }
            b'[' => depth = depth.saturating_add(1),
            b']' => depth = depth.saturating_sub(1),
            _ => {}
        }
        reader.advance();
        before = byte;
        if depth == 0 {
            break;
        }
    }
    match (depth, before) {
        (0, b']') => Ok(()),
        (0, _) => Err(reader.error_here(Fault::NoBracket)),
        _ => Err(reader.error(Fault::OpenBracket, from)),
    }
}

/// The words of a line with expressions, as far as they are known without values: an expression
/// counts as 1, and a computed code is omitted. For
/// [`Block::from_words`](crate::Block::from_words).
pub(crate) fn program_words(text: &[u8]) -> impl Iterator<Item = Result<Word, Error>> + '_ {
    let (mut reader, mut start) = (Cursor::new(text, 0), true);
    core::iter::from_fn(move || next_word(text, &mut reader, &mut start).transpose())
}

fn next_word<'t>(
    text: &'t [u8],
    reader: &mut Cursor<'t>,
    start: &mut bool,
) -> Result<Option<Word>, Error> {
    loop {
        let Some(byte) = reader.peek() else {
            return Ok(None);
        };
        let at = reader.at();
        match byte {
            b'(' => {
                reader.pass_comment()?;
                continue;
            }
            b';' => return Ok(None),
            b'/' if *start => reader.advance(),
            b'#' => *reader = Cursor::new(text, extent(text, at)?),
            b'A'..=b'Z' | b'@' | b'^' => {
                *start = false;
                let end = extent(text, at)?;
                *reader = Cursor::new(text, end);
                let word = text.get(at..end).unwrap_or_default();
                if is_plain(word.get(1..).unwrap_or_default()) {
                    // Columns inside the line.
                    let moved = |place: usize| place.wrapping_add(at);
                    return match words(word).next().transpose() {
                        Ok(word) => Ok(word.map(|word| Word {
                            at: moved(word.at),
                            end: moved(word.end),
                            ..word
                        })),
                        Err(error) => Err(Error {
                            at: moved(error.at),
                            end: moved(error.end),
                            ..error
                        }),
                    };
                }
                if !matches!(byte, b'G' | b'M') {
                    let one = Decimal::new(1, 0).unwrap_or_default();
                    return Ok(Some(Word {
                        letter: byte,
                        value: one,
                        at,
                        end,
                    }));
                }
            }
            b'[' | b']' => return Err(reader.error_here(Fault::OpenBracket)),
            _ => {
                return Err(Error {
                    kind: ErrorKind::NotALetter(text.get(at).copied().unwrap_or(byte)),
                    at,
                    end: at.wrapping_add(1),
                });
            }
        }
        *start = false;
    }
}

/// Whether a value is a number, with or without leading signs.
pub(crate) fn is_plain(value: &[u8]) -> bool {
    let signs = |byte: &&u8| matches!(byte, b' ' | b'\t' | b'\r' | b'\n' | b'+' | b'-');
    let first = value.iter().find(|byte| !signs(byte));
    matches!(first, Some(b'0'..=b'9' | b'.'))
}

#[cfg(test)]
mod tests {
    extern crate std;

    use super::*;
    use std::borrow::ToOwned;
    use std::string::ToString;
    use std::vec;
    use std::vec::Vec;

    /// The end of a word or an assignment, or its error: code, start, end.
    #[test]
    fn ends_of_words() {
        for (text, expected) in [
            ("X<a>", Err((610, 1, 2))),
            ("X#<a>", Ok(5)),
            ("X#-<a>", Err((610, 3, 4))),
            ("X-#<a> Y1", Ok(6)),
            ("X[1 < 2]", Ok(8)),
            ("X[#<]>] ]", Ok(7)),
            ("X[#<a]", Err((613, 1, 6))),
            ("X[[1]", Err((611, 1, 5))),
            ("XATAN[1]/[2]Y", Ok(12)),
            ("XATAN[1]/2", Err((610, 10, 10))),
            ("XATAN[1]/", Err((610, 9, 9))),
            ("XATAN[1]2", Err((610, 1, 8))),
            ("#1=2", Ok(4)),
            ("#1 X2", Err((615, 0, 2))),
        ] {
            let found = extent(text.as_bytes(), 0);
            let found = found.map_err(|error| (error.kind.code(), error.at, error.end));
            assert_eq!(found, expected, "{text}");
        }
    }

    /// The words of a line with their columns, or its error.
    #[test]
    fn words_and_their_places() {
        let read = |text: &str| {
            let words: Result<Vec<_>, _> = program_words(text.as_bytes()).collect();
            match words {
                Ok(words) => Ok(words
                    .iter()
                    .map(|word| (word.letter, word.value.to_string(), word.at, word.end))
                    .collect::<Vec<_>>()),
                Err(error) => Err((error.kind, error.at, error.end)),
            }
        };
        let word = |letter, value: &str, at, end| (letter, value.to_owned(), at, end);
        assert_eq!(
            read("/ X1 (a) #1=2 Y-2.5 Z[3] G#4 ; X9"),
            Ok(vec![
                word(b'X', "1", 2, 4),
                word(b'Y', "-2.5", 14, 19),
                word(b'Z', "1", 20, 24)
            ])
        );
        let program = ErrorKind::Program;
        for (text, kind, at, end) in [
            ("X1 /Y2", ErrorKind::NotALetter(b'/'), 3, 4),
            ("X1 ]", program(Fault::OpenBracket), 3, 4),
            ("X1 [2]", program(Fault::OpenBracket), 3, 4),
            ("X1 Y1.2.3", ErrorKind::MalformedNumber, 7, 9),
            ("X1 (", ErrorKind::UnclosedComment, 3, 4),
        ] {
            assert_eq!(read(text), Err((kind, at, end)), "{text}");
        }
    }
}
