//! Lines in normal form: nothing is lost, and every number keeps its digits.

use crate::blocks::block::Block;
use crate::codes::dialect::{Dialect, Flavour};
#[cfg(feature = "extended")]
use crate::codes::printer;
use crate::error::Error;
use crate::program::parameters::{extent, is_flow, is_plain, needs_program, program_words};
use crate::words::comment::comment_length;
use crate::words::word::words;

/// Returns the pieces of a line in its normal form. Concatenated, they are the line without a line
/// end. They borrow from the line, so no memory is needed. Bytes that are not text are preserved.
///
/// - Letters become capitals. There is one space between words and comments, and none after `/`.
///   Indentation stays.
/// - Numbers lose blanks, a plus sign, zeros before the first digit and the sign of zero; `.5`
///   becomes `0.5`. The value is never computed. **Decimal places stay**: `1.50` means hundredths,
///   which matters for the tolerance of arcs ([`Arc::resolution`](crate::Arc::resolution)), and
///   `5.` is not 5 on controls that count in smallest units. G and M codes lose places that are
///   zeros: `G01.0` is `G1`.
/// - Comments, expressions, assignments, lines with O-words, and the digits after `N`, `O` and `T`
///   stay unchanged.
/// - A deleted line (`/`) with errors stays unchanged.
/// - The strings of `micromill` get no blanks and keep their numbers as written, because their form
///   is that of a link.
///
/// The normal form of a normal form is itself, and the [`Block`]s of both are equal.
///
/// # Cost
/// Two passes over the line and one block.
///
/// # Examples
/// ```
/// use husillo_gcode::{Dialect, formatted};
/// let pieces = formatted(b"n010g01x+1.50 y-.5(cut)f 1 00 ; end", &Dialect::RS274)?;
/// assert_eq!(pieces.collect::<Vec<_>>().concat(), b"N010 G1 X1.50 Y-0.5 (cut) F100 ; end");
/// # Ok::<(), husillo_gcode::Error>(())
/// ```
///
/// # Errors
/// That of [`Block::parse`], with columns in the whole line: such a line has no normal form and
/// should be kept. In lines with expressions the contents of brackets and the values of parameters
/// are not checked.
pub fn formatted<'a>(line: &'a [u8], dialect: &Dialect) -> Result<Formatted<'a>, Error> {
    let all = dialect.with_block_delete(false);
    match check(line, &all) {
        Ok(kind) => Ok(Formatted::new(line, &all, kind)),
        Err(error) => {
            // Deleted lines may contain anything.
            let deleted = dialect.block_delete() && check(line, dialect).is_ok();
            deleted
                .then(|| Formatted::new(line, &all, Kind::Whole))
                .ok_or(error)
        }
    }
}

/// Treatment of a line.
#[derive(Copy, Clone, Eq, PartialEq, Debug)]
enum Kind {
    /// Words and comments.
    Words,
    /// The same with expressions and assignments.
    Expressions,
    /// Unchanged.
    Whole,
}

fn check(line: &[u8], dialect: &Dialect) -> Result<Kind, Error> {
    if needs_program(line, dialect) {
        if let Some(checked) = is_flow(line, dialect) {
            return checked.map(|()| Kind::Whole);
        }
        Block::from_words(program_words(line), dialect)?;
        return Ok(Kind::Expressions);
    }
    if dialect.flavour == Flavour::Printer && has_rest(line) {
        // Axes without values, messages and settings.
        Block::parse(line, dialect)?;
        return Ok(Kind::Whole);
    }
    for (offset, text) in dialect.blocks(line) {
        // Columns are inside the line, so their sums are below its length.
        Block::parse(text, dialect).map_err(|error| Error {
            at: error.at.wrapping_add(offset),
            end: error.end.wrapping_add(offset),
            ..error
        })?;
    }
    Ok(Kind::Words)
}

/// Whether a line of a printer is kept as it is: it has text that is no word, or the text after its
/// code is not read as words, as in `M117 100 %`.
fn has_rest(line: &[u8]) -> bool {
    words(line).any(|word| word.is_err()) || has_code_with_rest(line)
}

#[cfg(feature = "extended")]
fn has_code_with_rest(line: &[u8]) -> bool {
    let mut words = words(line).flatten();
    let code = words.find(|word| matches!(word.letter, b'G' | b'M'));
    let text = code.and_then(|word| line.get(word.at..));
    let known = text.and_then(printer::code_at);
    known.is_some_and(|(letter, number)| printer::rest(letter, number).is_some())
}

#[cfg(not(feature = "extended"))]
const fn has_code_with_rest(_line: &[u8]) -> bool {
    false
}

/// Iterator over the pieces of a line in its normal form; see [`formatted`].
#[derive(Clone, Debug)]
pub struct Formatted<'a> {
    text: &'a [u8],
    at: usize,
    kind: Kind,
    /// Strings of a link: no blanks, `;` ends one, numbers unchanged.
    strings: bool,
    /// A space comes before the next part.
    spaced: bool,
    /// Small pieces that come next, and the number of them already returned.
    heads: [&'a [u8]; 3],
    given: usize,
    /// The text that follows them.
    body: &'a [u8],
    /// Whether the body loses its blanks.
    dense: bool,
}

/// The capitals, from which single letters are borrowed.
const CAPITALS: &[u8; 26] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZ";

const fn is_blank(byte: u8) -> bool {
    matches!(byte, b' ' | b'\t' | b'\r' | b'\n')
}

/// Text without the blanks at its end.
fn trimmed(mut text: &[u8]) -> &[u8] {
    while let [rest @ .., last] = text {
        if !is_blank(*last) {
            break;
        }
        text = rest;
    }
    text
}

impl<'a> Formatted<'a> {
    fn new(line: &'a [u8], dialect: &Dialect, kind: Kind) -> Self {
        let strings = dialect.has_strings();
        let mut pieces = Formatted {
            text: line,
            at: 0,
            kind,
            strings,
            spaced: false,
            heads: [&[]; 3],
            given: 0,
            body: &[],
            dense: false,
        };
        if kind == Kind::Whole {
            (pieces.body, pieces.at) = (line, line.len());
        } else if !strings && !trimmed(line).is_empty() {
            let indentation = line
                .iter()
                .take_while(|&&byte| matches!(byte, b' ' | b'\t'));
            // At most the length of the line.
            let width = indentation.fold(0usize, |width, _| width.wrapping_add(1));
            pieces.body = line.get(..width).unwrap_or_default();
            pieces.at = width;
        }
        pieces
    }

    /// Prepares the next word, comment or sign of the line; `None` at its end.
    fn part(&mut self) -> Option<()> {
        let (byte, rest) = loop {
            let rest = self.text.get(self.at..).unwrap_or_default();
            let byte = *rest.first()?;
            if !is_blank(byte) {
                break (byte, rest);
            }
            self.at = self.at.wrapping_add(1); // below the length
        };
        let space: &[u8] = if self.spaced && !self.strings {
            b" "
        } else {
            b""
        };
        self.spaced = byte != b'/';
        self.dense = false;
        self.given = 0;
        self.heads = [space, &[], &[]];
        let length = match byte {
            b'A'..=b'Z' | b'a'..=b'z' => {
                let place = usize::from(byte.to_ascii_uppercase().wrapping_sub(b'A'));
                let letter = CAPITALS.get(place..=place).unwrap_or_default();
                self.heads = [space, letter, &[]];
                self.word(rest, letter)
            }
            b'@' | b'^' if !self.strings => {
                let letter = rest.get(..1).unwrap_or_default();
                self.heads = [space, letter, &[]];
                self.word(rest, letter)
            }
            b'(' => comment_length(rest).unwrap_or(rest.len()),
            b';' if !self.strings => rest.len(),
            b'#' => {
                // Checked before: the line has expressions, and there is an end.
                let end = extent(self.text, self.at).unwrap_or(self.text.len());
                end.wrapping_sub(self.at)
            }
            _ => 1,
        };
        let is_word = byte.is_ascii_alphabetic() || !self.strings && matches!(byte, b'@' | b'^');
        if !is_word {
            self.body = rest.get(..length).unwrap_or(rest);
        }
        // Parts end inside the line.
        self.at = self.at.wrapping_add(length);
        Some(())
    }

    /// Prepares the value of the word at the start of `rest` and returns the length of the word.
    fn word(&mut self, rest: &'a [u8], letter: &'a [u8]) -> usize {
        let behind = rest.get(1..).unwrap_or_default();
        if self.kind == Kind::Expressions {
            let value = behind.trim_ascii_start();
            if !is_plain(value) {
                let end = extent(self.text, self.at).unwrap_or(self.text.len());
                let length = end.wrapping_sub(self.at);
                let blanks = behind.len().wrapping_sub(value.len());
                self.body = rest.get(blanks.wrapping_add(1)..length).unwrap_or_default();
                return length;
            }
        }
        let part = |byte: &u8| {
            matches!(
                *byte,
                b'0'..=b'9' | b'.' | b'+' | b'-' | b' ' | b'\t' | b'\r' | b'\n'
            )
        };
        let mut next = behind;
        while let [first, rest @ ..] = next {
            if !part(first) {
                break;
            }
            next = rest;
        }
        // `next` is the end of `behind` and the end of `rest`.
        let length = rest.len().wrapping_sub(next.len());
        let number = behind.get(..length.wrapping_sub(1)).unwrap_or_default();
        self.number(trimmed(number.trim_ascii_start()), letter);
        length
    }

    /// Prepares a number.
    fn number(&mut self, mut number: &'a [u8], letter: &[u8]) {
        self.dense = true;
        self.body = number;
        if self.strings || matches!(letter, b"N" | b"O" | b"T") {
            return;
        }
        let is_zero = !number.iter().any(|byte| matches!(byte, b'1'..=b'9'));
        let mut negative = false;
        // The sign and the zeros before the first significant digit.
        while let [
            byte @ (b'+' | b'-' | b'0' | b' ' | b'\t' | b'\r' | b'\n'),
            rest @ ..,
        ] = number
        {
            negative |= *byte == b'-';
            number = rest;
        }
        if matches!(letter, b"G" | b"M") && number.contains(&b'.') {
            while let [rest @ .., b'0' | b' ' | b'\t' | b'\r' | b'\n'] = number {
                number = rest;
            }
            if let [rest @ .., b'.'] = number {
                number = trimmed(rest);
            }
        }
        let needs_zero = !matches!(number.first(), Some(b'0'..=b'9'));
        // The sign of a zero is a direction on wrapped rotary axes.
        let signed = negative && (!is_zero || matches!(letter, b"A" | b"B" | b"C"));
        let lead: &[u8] = match (signed, needs_zero) {
            (true, true) => b"-0",
            (true, false) => b"-",
            (false, true) => b"0",
            (false, false) => b"",
        };
        let [_, _, slot] = &mut self.heads;
        *slot = lead;
        self.body = number;
    }
}

impl<'a> Iterator for Formatted<'a> {
    type Item = &'a [u8];

    #[inline]
    fn next(&mut self) -> Option<&'a [u8]> {
        loop {
            while let Some(&head) = self.heads.get(self.given) {
                self.given = self.given.wrapping_add(1); // at most three
                if !head.is_empty() {
                    return Some(head);
                }
            }
            while let [first, rest @ ..] = self.body {
                if self.dense && is_blank(*first) {
                    self.body = rest;
                    continue;
                }
                let whole = self.body;
                let mut parts = whole.splitn(2, |&byte| self.dense && is_blank(byte));
                let piece = parts.next().unwrap_or(whole);
                self.body = parts.next().unwrap_or_default();
                return Some(piece);
            }
            self.part()?;
        }
    }
}

impl core::iter::FusedIterator for Formatted<'_> {}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use std::string::String;
    use std::vec::Vec;

    fn form(dialect: Dialect, line: &str) -> Result<String, (u16, usize, usize)> {
        let pieces = formatted(line.as_bytes(), &dialect)
            .map_err(|error| (error.kind.code(), error.at, error.end))?;
        let bytes = pieces.collect::<Vec<_>>().concat();
        Ok(String::from_utf8(bytes).expect("text"))
    }

    #[test]
    #[cfg(feature = "extended")]
    fn words_have_one_form() {
        for (line, expected) in [
            ("", ""),
            (" \t\r", ""),
            ("g01x1y2", "G1 X1 Y2"),
            ("G00 X+007.250 Y-0 Z-0.00 F.5", "G0 X7.250 Y0 Z0.00 F0.5"),
            ("g 0 1 x - 1 . 5 0", "G1 X-1.50"),
            ("G59.30 G1.0 M03.", "G59.3 G1 M3"),
            ("g38.20 x5. f-0.", "G38.2 X5. F0."),
            ("N0010 T007 M6", "N0010 T007 M6"),
            ("  g1   x1 ( c  ; d )y2;e  ", "  G1 X1 ( c  ; d ) Y2 ;e  "),
            ("/ n5g1x.0", "/N5 G1 X0.0"),
            ("/ M117 hello 007", "/ M117 hello 007"),
            ("%", "%"),
            ("n28  % (end)", "N28 % (end)"),
            ("X00000000000000000000000000000000.10", "X0.10"),
        ] {
            let found = form(Dialect::RS274, line);
            assert_eq!(found, Ok(expected.into()), "{line}");
            assert_eq!(form(Dialect::RS274, expected), Ok(expected.into()));
        }
    }

    #[test]
    fn what_has_an_error_has_no_form() {
        assert_eq!(form(Dialect::RS274, "g1 x1.2.3"), Err((102, 7, 9)));
        assert_eq!(form(Dialect::RS274, "M117 H1"), Err((202, 0, 4)));
        assert_eq!(form(Dialect::GRBL, "g1 x#1"), Err((102, 4, 6)));
        assert_eq!(form(Dialect::MICROMILL, "G90;G1 X--1"), Err((102, 9, 11)));
    }

    #[test]
    fn strings_of_a_link_have_no_blanks() {
        let form = |line| form(Dialect::MICROMILL, line);
        assert_eq!(
            form("g90; g00 x02650.00 y-0; M05 "),
            Ok("G90;G00X02650.00Y-0;M05".into())
        );
    }

    #[test]
    fn expressions_stay_as_they_are() {
        for (line, expected) in [
            ("#1=+05.0 #<a]b> = [ 1+2 ]", "#1=+05.0 #<a]b> = [ 1+2 ]"),
            ("g01x[#1 + 2]y-.5", "G1 X[#1 + 2] Y-0.5"),
            (
                "x - sin[ 3 ]y#-1z atan[1] / [2]f##2 (x)",
                "X- sin[ 3 ] Y#-1 Zatan[1] / [2] F##2 (x)",
            ),
            ("g[#1]x+00", "G[#1] X0"),
            ("  o100 While [#1 lt 05]", "  o100 While [#1 lt 05]"),
            ("N5 o<a> call [1]", "N5 o<a> call [1]"),
            ("/#1=1x01", "/#1=1 X1"),
        ] {
            let found = form(Dialect::RS274, line);
            assert_eq!(found, Ok(expected.into()), "{line}");
            assert_eq!(form(Dialect::RS274, expected), Ok(expected.into()));
        }
        for line in [
            "x[1",
            "#1",
            "o100 whale",
            "x1 y[1]] z",
            "x[1] x2",
            "g77 z[1]",
            "x--5 #1=1",
            "x[1]y1.2.3",
        ] {
            let found = form(Dialect::RS274, line);
            assert!(found.is_err(), "{line}: {found:?}");
        }
    }
}
