//! Explains constructs of programs for other controllers that are not G-code here.

use husillo_gcode::{Error, ErrorKind, Word, words};

/// Advice about a construct of another controller.
#[derive(Debug)]
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
        ErrorKind::UnknownCode(letter, Some(tenths)) => of_code(letter, tenths),
        ErrorKind::UnusedWord(b'Q') if words(text).flatten().any(is_look_ahead) => Some(Advice {
            label: "the look-ahead of Fanuc controls, not a curve",
            help: "leave the line out: speed is always planned ahead here".to_owned(),
            fix: None,
        }),
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

/// Codes of other controllers: the letter, ten times the number, what the code is, what to do.
const CODES: [(u8, u16, &str, &str); 17] = [
    (b'G', 120, "the circular pocket of Haas and Mach3", CIRCLE),
    (b'G', 130, "the circular pocket of Haas and Mach3", CIRCLE),
    (
        b'G',
        1540,
        "the further work offsets of Haas",
        "write G54 to G59.3",
    ),
    (b'G', 1870, "the smoothness of Haas", PLANNED),
    (b'G', 3320, "rigid tapping of Sinumerik", "write G33.1"),
    (b'M', 100, "the clamp of a rotary axis", NO_SUCH_PART),
    (b'M', 110, "the clamp of a rotary axis", NO_SUCH_PART),
    (b'M', 170, "the motors of a printer", NO_SUCH_PART),
    (b'M', 180, "the motors of a printer", NO_SUCH_PART),
    (
        b'M',
        290,
        "rigid tapping of Fanuc",
        "leave the code out: G84 taps with the spindle's speed, G33.1 with its angle",
    ),
    (b'M', 410, "the gear of a spindle", NO_SUCH_PART),
    (b'M', 420, "the gear of a spindle", NO_SUCH_PART),
    (b'M', 840, "the motors of a printer", NO_SUCH_PART),
    (
        b'M',
        970,
        "the call of a subprogram of Haas",
        "write M98 P and the number of the subprogram, and O and this number before it",
    ),
    (b'M', 1170, "a message of printers", "write (MSG, text)"),
    (
        b'M',
        1350,
        "rigid tapping of Mitsubishi",
        "leave the code out: G84 taps with the spindle's speed, G33.1 with its angle",
    ),
    (
        b'M',
        4000,
        "waits until printers stand still",
        "leave the code out: each command waits for those before it",
    ),
];

const CIRCLE: &str = "write the moves of the pocket, a circle as G2 or G3 with I";
const PLANNED: &str = "leave the code out: speed is always planned ahead here";
const NO_SUCH_PART: &str = "leave the code out: this machine has no such part";

/// What to do about a code of another controller.
fn of_code(letter: u8, tenths: u16) -> Option<Advice> {
    let mut codes = CODES.iter();
    let (_, _, label, help) = codes.find(|code| (code.0, code.1) == (letter, tenths))?;
    Some(Advice {
        label,
        help: (*help).to_owned(),
        fix: None,
    })
}

/// Whether a word is G5.1, which is a quadratic curve here.
fn is_look_ahead(word: Word) -> bool {
    word.letter == b'G' && (word.value.digits(), word.value.places()) == (51, 1)
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
