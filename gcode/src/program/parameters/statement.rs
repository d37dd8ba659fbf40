//! Lines with control flow: `o100 while [#1 lt 10]`.

use super::cursor::Cursor;
use super::expression::Reader;
use super::table::{Key, is_same_name};
use super::value::Value;
use crate::codes::dialect::Dialect;
use crate::error::Error;
use crate::error::parameters::Fault;
use crate::features::EXTENDED;
use crate::words::comment::comment_length;
#[cfg(feature = "extended")]
use crate::words::word::words;

/// The label of an O-word: a number, or a name as written in the text.
#[derive(Copy, Clone, Debug)]
pub(super) enum Label<'t> {
    Number(u32),
    Name(&'t [u8]),
}

impl Label<'_> {
    /// Whether two labels are the same; case and blanks of names are ignored.
    pub(super) fn is(self, other: Label<'_>) -> bool {
        match (self, other) {
            (Label::Number(left), Label::Number(right)) => left == right,
            (Label::Name(left), Label::Name(right)) => is_same_name(left, right),
            _ => false,
        }
    }
}

/// The keyword of an O-word.
#[derive(Copy, Clone, Eq, PartialEq, Debug)]
pub(super) enum Keyword {
    Sub,
    EndSub,
    Call,
    Return,
    If,
    ElseIf,
    Else,
    EndIf,
    While,
    EndWhile,
    Do,
    Repeat,
    EndRepeat,
    Break,
    Continue,
}

/// Names in capitals.
const NAMES: [(&[u8], Keyword); 15] = [
    (b"SUB", Keyword::Sub),
    (b"ENDSUB", Keyword::EndSub),
    (b"CALL", Keyword::Call),
    (b"RETURN", Keyword::Return),
    (b"IF", Keyword::If),
    (b"ELSEIF", Keyword::ElseIf),
    (b"ELSE", Keyword::Else),
    (b"ENDIF", Keyword::EndIf),
    (b"WHILE", Keyword::While),
    (b"ENDWHILE", Keyword::EndWhile),
    (b"DO", Keyword::Do),
    (b"REPEAT", Keyword::Repeat),
    (b"ENDREPEAT", Keyword::EndRepeat),
    (b"BREAK", Keyword::Break),
    (b"CONTINUE", Keyword::Continue),
];

/// A line that begins with an O-word, up to its keyword.
#[derive(Copy, Clone, Debug)]
pub(super) struct Statement<'t> {
    pub(super) label: Label<'t>,
    pub(super) keyword: Keyword,
    /// Position of the `O`.
    pub(super) at: usize,
    /// Position after the keyword.
    pub(super) end: usize,
}

/// The position of the `O` of a line, after `/`, comments and `N`; `None` for other lines. `/` is
/// skipped where lines with it are executed. A number without a keyword is that of the program.
pub(super) fn place(text: &[u8], passes_delete: bool) -> Option<usize> {
    let (mut at, mut number) = (0usize, false);
    loop {
        let byte = text.get(at).copied()?;
        match byte {
            b'o' | b'O' if is_program_number(text.get(at.wrapping_add(1)..)?) => return None,
            b'o' | b'O' => return Some(at),
            b' ' | b'\t' | b'\r' => {}
            b'/' if passes_delete && !number => {}
            b'n' | b'N' if !number => number = true,
            b'0'..=b'9' | b'.' if number => {}
            b'(' => {
                let length = comment_length(text.get(at..)?)?;
                at = at.wrapping_add(length);
                continue;
            }
            _ => return None,
        }
        at = at.wrapping_add(1);
    }
}

/// Whether the text after an `O` is a whole number, and at most a comment follows it.
fn is_program_number(text: &[u8]) -> bool {
    let text = text.trim_ascii_start();
    let digits = text.iter().take_while(|byte| byte.is_ascii_digit()).count();
    let rest = text.get(digits..).unwrap_or_default().trim_ascii();
    let is_comment = match rest.first() {
        None | Some(b';') => true,
        // A call may follow a comment.
        Some(b'(') => comment_length(rest) == Some(rest.len()),
        Some(_) => false,
    };
    digits > 0 && is_comment
}

/// Whether a line needs a [`Program`](super::Program): it has a parameter or a bracket outside
/// comments, begins with an O-word, or has M70 to M73, M98 or M99. Always `false` in a dialect
/// without them.
///
/// # Cost
/// One check per byte.
pub fn needs_program(line: &[u8], dialect: &Dialect) -> bool {
    if !dialect.has_parameters()
        || (dialect.block_delete() && line.trim_ascii_start().starts_with(b"/"))
    {
        return false;
    }
    if place(line, !dialect.block_delete()).is_some()
        && (dialect.has_flow() || seen(line, false).is_some())
    {
        return true;
    }
    let mut depth = 0_usize; // of comments
    for (at, byte) in (1usize..).zip(line) {
        match byte {
            b'(' => depth = depth.wrapping_add(1), // at most the length of the line
            b')' => depth = depth.saturating_sub(1),
            _ if depth > 0 => {}
            b';' => return false,
            b'#' | b'[' => return true,
            b'm' | b'M' if EXTENDED && is_flow_code(line, at) => return true,
            _ => {}
        }
    }
    false
}

/// Whether the text after an `M`, from `at` on, is the number of M70 to M73, M98 or M99.
fn is_flow_code(line: &[u8], at: usize) -> bool {
    let mut number = 0u32;
    for byte in line.get(at..).unwrap_or_default() {
        match byte {
            b'0'..=b'9' => {
                let digit = u32::from(byte.wrapping_sub(b'0'));
                number = number.saturating_mul(10).saturating_add(digit);
            }
            b' ' | b'\t' => {}
            _ => break,
        }
    }
    matches!(number, 70..=73 | 98 | 99)
}

/// The number of a program: that of a line with `O1234` alone, after `/`, comments and `N`.
#[cfg(feature = "extended")]
pub(super) fn program_number(text: &[u8]) -> Option<u32> {
    let mut words = words(text);
    let mut word = words.next()?.ok()?;
    if word.letter == b'N' {
        word = words.next()?.ok()?;
    }
    let number = word.value.whole().filter(|_| word.letter == b'O')?;
    match words.next() {
        None => u32::try_from(number).ok(),
        Some(_) => None,
    }
}

/// The number after `N` at the beginning of a line.
#[cfg(feature = "extended")]
pub(super) fn line_number(text: &[u8]) -> Option<u32> {
    let word = words(text).next()?.ok()?;
    let number = word.value.whole().filter(|_| word.letter == b'N')?;
    u32::try_from(number).ok()
}

/// Whether a line begins with an O-word of control flow, and if so whether its keyword is valid; a
/// computed label is not evaluated. `None` for other lines.
pub(crate) fn is_flow(text: &[u8], dialect: &Dialect) -> Option<Result<(), Error>> {
    let at = place(text, !dialect.block_delete()).filter(|_| dialect.has_flow())?;
    let mut label = Cursor::new(text, at.wrapping_add(1));
    Some(match label.peek() {
        Some(b'#' | b'[') => Ok(()),
        _ => read(&mut Reader::new(text, at, |_| None)).map(|_| ()),
    })
}

/// Reads label and keyword; `reader` is at the `O`.
pub(super) fn read<'t, F>(reader: &mut Reader<'t, F>) -> Result<Statement<'t>, Error>
where
    F: Fn(Key<'t>) -> Option<Value>,
{
    let at = reader.at();
    reader.advance();
    let label = match reader.peek() {
        Some(b'<') => Label::Name(reader.name(at)?),
        Some(b'0'..=b'9' | b'#' | b'[') => {
            let number = reader
                .value()?
                .whole()
                .and_then(|number| u32::try_from(number).ok());
            Label::Number(number.ok_or_else(|| reader.error(Fault::MalformedLabel, at))?)
        }
        _ => return Err(reader.error_here(Fault::MalformedLabel)),
    };
    reader.pass_comments()?;
    reader.peek();
    let from = reader.at();
    let name = reader.letters();
    let Some((_, keyword)) = NAMES.iter().find(|(known, _)| *known == name.bytes()) else {
        return Err(match name.bytes() {
            [] => reader.error(Fault::UnknownKeyword, at),
            _ => reader.error(Fault::UnknownKeyword, from),
        });
    };
    Ok(Statement {
        label,
        keyword: *keyword,
        at,
        end: reader.end(),
    })
}

/// Label and keyword of a line that is only read in a search for another. Computed labels are not
/// found.
pub(super) fn seen(text: &[u8], passes_delete: bool) -> Option<Statement<'_>> {
    let at = place(text, passes_delete)?;
    let mut cursor = Cursor::new(text, at);
    cursor.advance();
    let label = match cursor.peek()? {
        b'<' => Label::Name(cursor.name(at).ok()?),
        b'0'..=b'9' => {
            let mut number = 0u32;
            while let Some(digit @ b'0'..=b'9') = cursor.peek() {
                let digit = u32::from(digit.wrapping_sub(b'0'));
                number = number.checked_mul(10)?.checked_add(digit)?;
                cursor.advance();
            }
            Label::Number(number)
        }
        _ => return None,
    };
    cursor.pass_comments().ok()?;
    let name = cursor.letters();
    let (_, keyword) = NAMES.iter().find(|(known, _)| *known == name.bytes())?;
    Some(Statement {
        label,
        keyword: *keyword,
        at,
        end: cursor.end(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Which lines have control flow, and whether their keyword is valid; a computed label is not
    /// evaluated.
    /// A number alone is that of the program, not a block of flow.
    #[test]
    fn a_program_number_is_no_flow() {
        for line in ["O1", "o0001 (BRACKET)", "N5 O77 ; bracket", " O 12 "] {
            assert!(!needs_program(line.as_bytes(), &Dialect::RS274), "{line}");
        }
        for line in [
            "O1 sub",
            "O1 (a) sub",
            "O<a>",
            "O#1",
            "O1 (a) (b) call",
            "O1 x",
        ] {
            assert!(needs_program(line.as_bytes(), &Dialect::RS274), "{line}");
        }
    }

    #[test]
    fn lines_that_steer() {
        let shown = Dialect::RS274;
        let executed = shown.with_block_delete(false);
        for (line, dialect, expected) in [
            ("o1 call", shown, Some(true)),
            ("o1 cell", shown, Some(false)),
            ("o#<nobody> call", shown, Some(true)),
            ("o[1/0] call", shown, Some(true)),
            ("/o1 call", shown, None),
            ("/o1 call", executed, Some(true)),
            ("X1", shown, None),
            ("o1 call", Dialect::ISO, None),
        ] {
            let is_right = is_flow(line.as_bytes(), &dialect).map(|result| result.is_ok());
            assert_eq!(is_right, expected, "{line}");
        }
    }
}
