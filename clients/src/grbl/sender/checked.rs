//! Lines with numbers and checksums. A line that the link loses or changes is sent again, and no
//! line is carried out twice.

use super::{Operator, SYNCHRONISE, Sender, Sent, described};
use crate::grbl::session::Heard;
use husillo_transports::grbl::{LINE_CHARACTERS, Message, RECEIVE_BYTES};
use std::time::Duration;

/// After a line was lost, the answers to the lines behind it end with a silence of this length.
const QUIET: Duration = Duration::from_millis(100);
/// Without an answer for this time the controller is asked for the number of its next line. The
/// time doubles with each question, because a long move may be the reason.
const PATIENCE: Duration = Duration::from_secs(1);
/// Asks for the number of the next line. It moves nothing, so the link may change it without harm.
const QUESTION: &[u8] = b"$L\n";
/// A command without a checksum is sent up to this many times.
const TRIES: u32 = 5;
/// Bytes of the receive buffer that are kept free for questions.
const RESERVE: usize = 12;

/// The lines of a program, and how many of them are sent and accepted.
#[derive(Debug)]
struct Flow {
    /// With number and checksum.
    lines: Vec<String>,
    /// Number of lines that were sent since the last repetition.
    sent: usize,
    /// Number of lines that the controller has accepted.
    accepted: usize,
    /// Time of the last answer. While lines are to be repeated, nothing is sent until it is quiet.
    heard_at: Duration,
    is_repeating: bool,
    asked_at: Duration,
    patience: Duration,
}

impl Sender {
    /// Sends these lines, each with its number in the file, and waits until they are carried out.
    /// The link may lose and change bytes, except real-time bytes, which no checksum protects. The
    /// controller must have checked lines (`$L=1`).
    ///
    /// # Errors
    ///
    /// As [`send`](Sender::send). In addition, the controller has no checked lines, or a line is
    /// too long with its number and checksum.
    pub fn send_checked(
        &mut self,
        lines: &[(usize, String)],
        operator: &mut dyn Operator,
    ) -> Result<Sent, String> {
        let mut flow = Flow::new(lines, self.session.elapsed())?;
        if let Err(why) = self.switch("$L=1") {
            return Err(format!("the controller has no checked lines: {why}"));
        }
        self.answered = 0;
        self.moves.clear();
        while flow.accepted < flow.lines.len() {
            self.intervene(operator)?;
            self.put_lines(&mut flow)?;
            let before = self.session.state();
            match self.session.turn()? {
                None | Some(Heard::Ok | Heard::Refused(_)) => {}
                Some(Heard::Text(text)) => match Message::parse(text.as_bytes()) {
                    Some(Message::Answer(number, error)) => {
                        flow.take(number as usize, self.session.elapsed());
                        if let Some(error) = error {
                            let index = (number as usize).saturating_sub(1);
                            let (number, line) = lines.get(index).cloned().unwrap_or_default();
                            let why = described(error.number().into());
                            return Err(self.ended(format!("line {number}, {line}: {why}")));
                        }
                    }
                    Some(Message::Resend(next) | Message::NextLine(next)) => {
                        flow.repeat((next as usize).saturating_sub(1), self.session.elapsed());
                    }
                    _ => operator.hear(&Heard::Text(text)),
                },
                Some(heard) => self.pass_on(&heard, before, operator)?,
            }
            let answered = flow.accepted.min(lines.len());
            if answered != self.answered {
                for (index, (_, line)) in
                    lines.iter().enumerate().take(answered).skip(self.answered)
                {
                    self.note_moves(index, line);
                }
                self.answered = answered;
                operator.progress(answered);
            }
        }
        self.switch("$L=0")?;
        let status = self.session.fresh_status()?;
        Ok(Sent {
            lines: lines.len(),
            status,
        })
    }

    /// Switches checked lines on or off. No checksum protects this command and its answer.
    fn switch(&mut self, command: &str) -> Result<(), String> {
        let answer = self.session.request_repeatedly(command, PATIENCE, TRIES);
        answer.map(|_| ())
    }

    /// Sends what fits into the receive buffer of the controller, or a question.
    fn put_lines(&mut self, flow: &mut Flow) -> Result<(), String> {
        let now = self.session.elapsed();
        if flow.is_repeating {
            if now.saturating_sub(flow.heard_at) < QUIET {
                return Ok(());
            }
            flow.is_repeating = false;
            flow.sent = flow.accepted;
        }
        while let Some(line) = flow.next() {
            self.session.put(line.as_bytes())?;
            flow.sent += 1;
        }
        let since = flow.heard_at.max(flow.asked_at);
        if flow.sent > flow.accepted && now.saturating_sub(since) > flow.patience {
            self.session.put(QUESTION)?;
            flow.asked_at = now;
            flow.patience *= 2;
        }
        Ok(())
    }
}

impl Flow {
    fn new(lines: &[(usize, String)], now: Duration) -> Result<Self, String> {
        let last = (0, SYNCHRONISE.to_owned());
        let numbered = lines.iter().chain([&last]).zip(1_u32..);
        let lines = numbered.map(|((line, text), number)| {
            let framed = framed(number, text);
            match framed.trim_end().len() > LINE_CHARACTERS {
                true => Err(format!(
                    "line {line}: with its number and checksum it has more than {LINE_CHARACTERS} \
                     characters"
                )),
                false => Ok(framed),
            }
        });
        Ok(Self {
            lines: lines.collect::<Result<_, _>>()?,
            sent: 0,
            accepted: 0,
            heard_at: now,
            is_repeating: false,
            asked_at: now,
            patience: PATIENCE,
        })
    }

    /// The next line, if it fits into the buffer.
    fn next(&self) -> Option<&String> {
        let line = self.lines.get(self.sent)?;
        let waiting = self.lines.get(self.accepted..self.sent)?;
        let bytes = waiting.iter().map(String::len).sum::<usize>() + line.len();
        let fits = bytes + RESERVE < usize::from(RECEIVE_BYTES);
        (fits || waiting.is_empty()).then_some(line)
    }

    /// Lines up to this number are accepted.
    fn take(&mut self, number: usize, now: Duration) {
        self.heard_at = now;
        self.patience = PATIENCE;
        if number <= self.sent {
            self.accepted = self.accepted.max(number);
        }
    }

    /// Exactly this number of lines is accepted. The others are sent again.
    fn repeat(&mut self, accepted: usize, now: Duration) {
        self.heard_at = now;
        self.patience = PATIENCE;
        self.accepted = accepted.min(self.lines.len());
        self.is_repeating = self.accepted < self.sent;
        self.sent = self.sent.max(self.accepted);
    }
}

/// A line with its number and checksum. A number of its own is removed.
fn framed(number: u32, text: &str) -> String {
    let own = text
        .strip_prefix('N')
        .map(|rest| rest.trim_start_matches(|digit: char| digit.is_ascii_digit()));
    let line = format!("N{number}{}", own.unwrap_or(text));
    let sum = line.bytes().fold(0, |sum, byte| sum ^ byte);
    format!("{line}*{sum}\n")
}

#[cfg(test)]
mod tests {
    use super::framed;

    #[test]
    fn a_line_has_its_number_and_checksum() {
        // The example of the receiver in `gcode`, without blanks.
        assert_eq!(framed(1, "G28"), "N1G28*50\n");
        assert_eq!(framed(7, "N120G1X1"), framed(7, "G1X1"));
        let mut receiver = husillo_gcode::Receiver::new(husillo_gcode::Framing::STRICT);
        let line = framed(1, "G1X0.5");
        assert_eq!(
            receiver.check(line.trim_end().as_bytes()),
            Ok(&b"N1G1X0.5"[..])
        );
    }
}
