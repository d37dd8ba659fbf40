//! Lines with numbers and checksums, for links that may lose or change bytes.

use husillo_gcode::{Framing, FramingError, Receiver};
use husillo_transports::grbl::{ErrorCode, Message};

use super::Grbl;
use super::lines::Outcome;

/// State of checked lines. They are off after each reset.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Checks {
    /// `None`: lines are not checked.
    receiver: Option<Receiver>,
    /// Number of the present line. `None`: its answer has no number.
    number: Option<u32>,
}

impl<const QUEUE: usize> Grbl<QUEUE> {
    /// Executes `$L`, which reports the number of the next line, `$L=1`, which begins with line 1,
    /// and `$L=0`.
    ///
    /// # Errors
    /// Fails with the error that answers the line.
    pub(super) fn switch_checks(&mut self, text: &[u8]) -> Result<Outcome, ErrorCode> {
        if !self.options.has_checked_lines {
            return Err(ErrorCode::InvalidStatement);
        }
        match (text, self.checks.receiver) {
            (b"", Some(receiver)) => self.send(&Message::NextLine(receiver.expected())),
            (b"=1", _) => self.checks.receiver = Some(Receiver::new(Framing::STRICT)),
            (b"=0", _) => self.checks.receiver = None,
            _ => return Err(ErrorCode::InvalidStatement),
        }
        Ok(Outcome::Done)
    }

    /// Switches checked lines off.
    pub(super) fn drop_checks(&mut self) {
        self.checks = Checks::default();
    }

    /// Checks a received line. Returns the text to be executed, or `None` for a line that was
    /// answered: a wrong one, or one that was received before.
    pub(super) fn checked<'a>(&mut self, line: &'a [u8]) -> Option<&'a [u8]> {
        self.checks.number = None;
        let Some(receiver) = &mut self.checks.receiver else {
            return Some(line);
        };
        // A blank line is not answered, because noise may end a line twice.
        if line.trim_ascii().is_empty() {
            return None;
        }
        // A changed command that moves nothing does no harm, so people may type it.
        if matches!(line, [b'$', rest @ ..] if !matches!(rest, [b'J' | b'N', ..])) {
            return Some(line);
        }
        match receiver.check(line) {
            Ok(text) => {
                self.checks.number = Some(receiver.expected().wrapping_sub(1));
                Some(without_number_of_dollar(text))
            }
            Err(FramingError::Number { given, expected }) if given < expected => {
                self.send(&Message::Answer(expected.wrapping_sub(1), None));
                None
            }
            Err(_) => {
                let expected = receiver.expected();
                self.send(&Message::Resend(expected));
                None
            }
        }
    }

    /// Answers the line of the host.
    pub(super) fn answer(&mut self, error: Option<ErrorCode>) {
        match (self.checks.number.take(), error) {
            (Some(number), error) => self.send(&Message::Answer(number, error)),
            (None, Some(error)) => self.send(&Message::Error(error)),
            (None, None) => self.send(&Message::Ok),
        }
    }
}

/// Removes the number before a `$`. A block keeps its number, which reports contain.
fn without_number_of_dollar(text: &[u8]) -> &[u8] {
    let digits = text.strip_prefix(b"N").unwrap_or(text);
    let rest = digits.iter().position(|byte| !byte.is_ascii_digit());
    match rest.and_then(|at| digits.get(at..)) {
        Some(rest @ [b'$', ..]) => rest,
        _ => text,
    }
}
