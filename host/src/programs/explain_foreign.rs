//! Explains constructs of programs for other controllers that are not G-code here.

use husillo_gcode::{Error, ErrorKind};

/// Advice about a construct of another controller.
pub struct Advice {
    /// What the marked text is.
    pub label: &'static str,
    /// What to write.
    pub help: String,
    /// The text in place of the marked one, if it removes the error.
    pub fix: Option<&'static str>,
}

/// Recognises a construct of another controller in a block with an error.
pub fn advice(error: &Error, text: &[u8]) -> Option<Advice> {
    if is_macro(text) {
        return Some(Advice {
            label: "a statement of Fanuc macros",
            help: "write O-words instead: `o1 while [#1 LT 6]` to `o1 endwhile`, \
                   `o2 if [#1 EQ 6]` to `o2 endif`"
                .to_owned(),
            fix: None,
        });
    }
    match error.kind {
        ErrorKind::UnknownWord(b'E') | ErrorKind::UnusedWord(b'E') => {
            is_exponent(error, text).then(|| Advice {
                label: "the exponent of a number, which G-code does not have",
                help: "write the number with all its digits, as in `0.000012`".to_owned(),
                // No fix: without its exponent the number would have another value.
                fix: None,
            })
        }
        ErrorKind::NotALetter(b':') => Some(Advice {
            label: "the program number of older controllers",
            help: "write `O` in place of `:`".to_owned(),
            fix: Some("O"),
        }),
        ErrorKind::NotALetter(b'*' | b'/' | b'+' | b'-') => {
            let (name, value) = assignment(error.at, text)?;
            Some(Advice {
                label: "an expression outside of brackets",
                help: format!("write `{name}=[{value}]`"),
                fix: None,
            })
        }
        _ => None,
    }
}

/// Whether a block is a statement of Fanuc macros. No other language that is read here begins a
/// line with these words.
fn is_macro(text: &[u8]) -> bool {
    let text = text.trim_ascii().to_ascii_uppercase();
    let words = [&b"WHILE"[..], b"IF", b"GOTO", b"END"];
    words.iter().any(|word| text.starts_with(word))
}

/// Whether a word is an exponent: it directly follows a number, and its own number is whole.
fn is_exponent(word: &Error, text: &[u8]) -> bool {
    let before = word.at.checked_sub(1).and_then(|at| text.get(at));
    let value = text.get(word.at + 1..word.end).unwrap_or_default();
    let digits = value.strip_prefix(b"-").unwrap_or(value);
    let digits = digits.strip_prefix(b"+").unwrap_or(digits);
    let is_short = digits.len() < 4 && digits.iter().all(u8::is_ascii_digit);
    matches!(before, Some(b'0'..=b'9' | b'.')) && is_short
}

/// The parameter and the value of an assignment with an operator at this byte.
fn assignment(at: usize, text: &[u8]) -> Option<(String, String)> {
    let equals = text.get(..at)?.iter().position(|byte| *byte == b'=')?;
    let value = text.get(equals + 1..)?.split(|byte| *byte == b'(').next()?;
    let shown = |bytes: &[u8]| String::from_utf8_lossy(bytes.trim_ascii()).into_owned();
    let name = shown(text.get(..equals)?);
    name.starts_with('#').then(|| (name, shown(value)))
}
