//! Checksums and line numbers of a link that may lose bytes, as used by 3D printers.

use crate::error::framing::FramingError;
use crate::words::word::words;

/// The checks of a line: plain data. By default nothing is checked.
#[derive(Copy, Clone, Eq, PartialEq, Debug, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Framing {
    /// `*` and the exclusive or of all bytes before it, in decimal, at the end of a line:
    /// `N3 G1 X1*98`.
    pub checksum: Rule,
    /// `N` at the start of a line, one more than that of the line before.
    pub number: Rule,
}

impl Framing {
    /// The rules of 3D printers: both are checked if they are given, and a numbered line must have
    /// a checksum.
    pub const PRINTER: Framing = Framing {
        checksum: Rule::WhereGiven,
        number: Rule::WhereGiven,
    };

    /// Both are required on every line.
    pub const STRICT: Framing = Framing {
        checksum: Rule::Always,
        number: Rule::Always,
    };
}

/// When a checksum or a number is checked.
#[derive(Copy, Clone, Eq, PartialEq, Debug, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Rule {
    /// Never: a `*` stays in the line, and the parser refuses it.
    #[default]
    Never,
    /// If it is given.
    WhereGiven,
    /// Always: a line without it is refused. Blank lines need nothing.
    Always,
}

/// The receiver of a link: checks each line and counts the lines. Size: 12 bytes.
///
/// # Examples
/// ```
/// use husillo_gcode::{Framing, FramingError, Receiver};
/// let mut receiver = Receiver::new(Framing::PRINTER);
/// assert_eq!(receiver.check(b"N1 G28*18"), Ok(&b"N1 G28"[..]));
/// let lost = FramingError::Number { given: 3, expected: 2 };
/// assert_eq!(receiver.check(b"N3 T0*57"), Err(lost));
/// assert_eq!(receiver.expected(), 2); // the sender is asked for this line again
/// ```
#[derive(Copy, Clone, Eq, PartialEq, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Receiver {
    framing: Framing,
    expected: u32,
}

impl Receiver {
    /// Creates a receiver that expects line 1.
    pub const fn new(framing: Framing) -> Receiver {
        Receiver {
            framing,
            expected: 1,
        }
    }

    /// The number of the next line, which is to be requested after an error.
    pub const fn expected(&self) -> u32 {
        self.expected
    }

    /// Sets the expected number, for a reader of a file, which cannot request a line again.
    pub fn expect(&mut self, number: u32) {
        self.expected = number;
    }

    /// Checks a line and returns its text without the checksum. A comment after the checksum is
    /// removed with it. `M110` with an `N` sets the number of its own line, so that a sender can
    /// restart: `N0 M110`, `M110 N0`. A refused line is not counted.
    ///
    /// A `*` inside `[ ]` or a comment is not a checksum.
    ///
    /// # Errors
    /// [`FramingError`]; the line must not be executed.
    ///
    /// # Cost
    /// One pass over the line if the checksum is checked, and over its words if the number is
    /// checked.
    pub fn check<'a>(&mut self, line: &'a [u8]) -> Result<&'a [u8], FramingError> {
        if line.iter().all(u8::is_ascii_whitespace) {
            return Ok(line);
        }
        let (text, summed) = self.sum(line)?;
        if self.framing.number == Rule::Never {
            return Ok(text);
        }
        match number(text) {
            Number::None if self.framing.number == Rule::Always => Err(FramingError::NoNumber),
            Number::None => Ok(text),
            Number::Malformed => Err(FramingError::NoNumber),
            _ if !summed && self.framing.checksum != Rule::Never => Err(FramingError::NoChecksum),
            Number::Given(given) if given != self.expected => Err(FramingError::Number {
                given,
                expected: self.expected,
            }),
            Number::Given(given) | Number::Set(given) => {
                // The last of 2^32 lines is followed by line 0.
                self.expected = given.wrapping_add(1);
                Ok(text)
            }
        }
    }

    /// The text before the checksum, and whether there is one.
    fn sum<'a>(&self, line: &'a [u8]) -> Result<(&'a [u8], bool), FramingError> {
        if self.framing.checksum == Rule::Never {
            return Ok((line, false));
        }
        let (star, computed) = match last_star(line) {
            Some(found) => found,
            None if self.framing.checksum == Rule::Always => return Err(FramingError::NoChecksum),
            None => return Ok((line, false)),
        };
        let text = line.get(..star).unwrap_or_default();
        let tail = line.get(star.wrapping_add(1)..).unwrap_or_default();
        let given = byte_number(tail).ok_or(FramingError::MalformedChecksum)?;
        if given != computed {
            return Err(FramingError::Checksum { given, computed });
        }
        Ok((text, true))
    }
}

/// The position of the last `*` outside brackets and comments, and the exclusive or of the bytes
/// before it.
fn last_star(line: &[u8]) -> Option<(usize, u8)> {
    let (mut sum, mut depth, mut comments, mut found) = (0, 0_u32, 0_u32, None);
    for (at, &byte) in (0..line.len()).zip(line) {
        match byte {
            b')' => comments = comments.saturating_sub(1),
            b'(' => comments = comments.saturating_add(1),
            _ if comments > 0 => {}
            b';' => break,
            b'[' => depth = depth.saturating_add(1),
            b']' => depth = depth.saturating_sub(1),
            b'*' if depth == 0 => found = Some((at, sum)),
            _ => {}
        }
        sum ^= byte;
    }
    found
}

/// A decimal number up to 255, with optional blanks around it and an optional comment after it.
fn byte_number(text: &[u8]) -> Option<u8> {
    let text = text.split(|&byte| byte == b';').next()?.trim_ascii();
    if text.is_empty() || text.len() > 3 {
        return None;
    }
    let digit = |&byte: &u8| Some(u32::from(byte.wrapping_sub(b'0'))).filter(|&digit| digit < 10);
    let value = text.iter().try_fold(0_u32, |value, byte| {
        // At most three digits.
        Some(value.wrapping_mul(10).wrapping_add(digit(byte)?))
    })?;
    u8::try_from(value).ok()
}

/// The line number of a line.
enum Number {
    None,
    Malformed,
    /// `N` at the start.
    Given(u32),
    /// With M110: sets the number of this line, whatever was expected.
    Set(u32),
}

fn number(text: &[u8]) -> Number {
    let (mut number, mut set) = (Number::None, false);
    let mut first = true;
    for word in words(text) {
        // The free text of a code such as M117 is irrelevant here.
        let Ok(word) = word else { break };
        let whole = word.value.whole();
        set |= word.letter == b'M' && whole == Some(110);
        if word.letter == b'N' && (first || set) {
            number = match whole.and_then(|whole| u32::try_from(whole).ok()) {
                Some(given) => Number::Given(given),
                None => return Number::Malformed,
            };
        }
        first = false;
    }
    match number {
        Number::Given(given) if set => Number::Set(given),
        number => number,
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use std::string::ToString;

    #[test]
    fn errors_say_what_is_wrong() {
        let (given, computed, expected) = (57, 56, 2);
        for (error, part) in [
            (FramingError::NoChecksum, "without a checksum"),
            (FramingError::MalformedChecksum, "0 to 255"),
            (
                FramingError::Checksum { given, computed },
                "57, the line has 56",
            ),
            (FramingError::NoNumber, "without a number"),
            (FramingError::Number { given: 3, expected }, "3, expected 2"),
        ] {
            assert!(error.to_string().contains(part), "{error}");
        }
    }

    #[test]
    fn checksums_are_the_exclusive_or_of_what_stands_before() {
        let mut receiver = Receiver::new(Framing {
            checksum: Rule::Always,
            number: Rule::Never,
        });
        // The checksums of a widely quoted example.
        assert_eq!(receiver.check(b"N3 T0*57"), Ok(&b"N3 T0"[..]));
        assert_eq!(
            receiver.check(b"N4 G92 E0*67 ; reset\r"),
            Ok(&b"N4 G92 E0"[..])
        );
        assert_eq!(receiver.check(b" \r"), Ok(&b" \r"[..]));
        for (line, error) in [
            (
                &b"N3 T1*57"[..],
                FramingError::Checksum {
                    given: 57,
                    computed: 56,
                },
            ),
            (b"G1 X1", FramingError::NoChecksum),
            (b"G1 X1 (*57)", FramingError::NoChecksum),
            (b"G1 X[2*57]", FramingError::NoChecksum),
            (b"G1 X1*", FramingError::MalformedChecksum),
            (b"G1 X1*256", FramingError::MalformedChecksum),
            (b"G1 X1*0057", FramingError::MalformedChecksum),
            (b"G1 X1*5 7", FramingError::MalformedChecksum),
        ] {
            assert_eq!(receiver.check(line), Err(error));
        }
    }

    #[test]
    fn numbers_go_up_by_one() {
        let mut receiver = Receiver::new(Framing {
            checksum: Rule::Never,
            number: Rule::WhereGiven,
        });
        let expect = |given, expected| Err(FramingError::Number { given, expected });
        assert_eq!(receiver.check(b"n 1 G0"), Ok(&b"n 1 G0"[..]));
        assert_eq!(receiver.check(b"G0"), Ok(&b"G0"[..]));
        assert_eq!(receiver.check(b"N1 G0"), expect(1, 2));
        assert_eq!(receiver.check(b"N3 G0"), expect(3, 2));
        assert_eq!(receiver.check(b"N2 G0"), Ok(&b"N2 G0"[..]));
        assert_eq!(receiver.check(b"N2.5"), Err(FramingError::NoNumber));
        assert_eq!(receiver.check(b"N0 M110"), Ok(&b"N0 M110"[..]));
        assert_eq!(receiver.expected(), 1);
        assert_eq!(receiver.check(b"N1 M110 N40"), Ok(&b"N1 M110 N40"[..]));
        assert_eq!(receiver.expected(), 41);
        assert_eq!(
            receiver.check(b"N41 M117 100 % (done"),
            Ok(&b"N41 M117 100 % (done"[..])
        );
        receiver.expect(50);
        assert_eq!(receiver.expected(), 50);
        assert_eq!(receiver.check(b"N50 M105 N7"), Ok(&b"N50 M105 N7"[..]));
        assert_eq!(receiver.expected(), 51);
        assert_eq!(
            Receiver::new(Framing::default()).check(b"N9 G1*7"),
            Ok(&b"N9 G1*7"[..])
        );
    }

    #[test]
    fn a_numbered_line_of_a_printer_has_a_checksum() {
        let mut receiver = Receiver::new(Framing::PRINTER);
        assert_eq!(receiver.check(b"N1 G28"), Err(FramingError::NoChecksum));
        assert_eq!(receiver.check(b"G28"), Ok(&b"G28"[..]));
        assert_eq!(receiver.check(b"N1 G28*18"), Ok(&b"N1 G28"[..]));
        assert_eq!(
            Receiver::new(Framing::STRICT).check(b"G28*77"),
            Err(FramingError::NoNumber)
        );
    }
}
