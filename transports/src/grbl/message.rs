//! Lines that a controller sends.

use crate::grbl::alarm::Alarm;
use crate::grbl::error::ErrorCode;
use crate::grbl::modal_state::ModalState;
use crate::grbl::place::{Parameter, Place, Units, length};
use crate::grbl::status::Status;
use crate::grbl::text::{Text, whole};

/// A line that a controller sends, without its end.
///
/// # Examples
///
/// ```
/// use husillo_transports::grbl::{ErrorCode, Message, Units};
///
/// let message = Message::parse(b"error:22").unwrap();
/// assert_eq!(message, Message::Error(ErrorCode::NoFeed));
/// assert!(message.is_answer());
/// assert_eq!(message.write(Units::Millimetres).bytes(), b"error:22");
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Message<'a> {
    /// The line was accepted.
    Ok,
    /// The line was refused.
    Error(ErrorCode),
    /// A checked line with this number was accepted, or refused: `ok N12*105`, `error:20 N12*45`.
    /// The number after `*` is the exclusive or of all bytes before it.
    Answer(u32, Option<ErrorCode>),
    /// A checked line was lost or changed. All lines from this number on are to be sent again:
    /// `resend N12*102`.
    Resend(u32),
    /// The number of the next checked line: `[LINE:12]`.
    NextLine(u32),
    /// Motion was interrupted, or is not permitted.
    Alarm(Alarm),
    /// The controller has started: its name and version, `Grbl 1.1h`.
    Banner(&'a [u8]),
    /// State and position: `<Idle|...>`.
    Status(Status),
    /// A setting and its value as text: `$110=500.000`.
    Setting(u8, &'a [u8]),
    /// A stored line: `$N0=G21`.
    Stored(u8, &'a [u8]),
    /// A stored line that was executed at the start, and its error: `>G21:ok`.
    Executed(&'a [u8], Option<ErrorCode>),
    /// A text for the operator.
    Feedback(Feedback<'a>),
    /// The modal state.
    Modal(ModalState),
    /// A coordinate datum and its position.
    Parameter(Parameter, Place),
    /// The tool length, in nanometres.
    ToolLength(i64),
    /// Position of the last probe contact, and whether there was one.
    Probe(Place, bool),
    /// The version, and the text that the user has stored.
    Version(&'a [u8], &'a [u8]),
    /// The letters of the options, the number of moves in the queue, and the size of the receive
    /// buffer in bytes.
    Options(&'a [u8], u8, u8),
    /// The list of commands.
    Help(&'a [u8]),
    /// An empty line.
    Blank,
}

/// A text for the operator: `[MSG:...]`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Feedback<'a> {
    /// Sent after ALARM:1 and ALARM:2.
    ResetToContinue,
    /// Locked: `$H` or `$X` unlocks.
    Unlock,
    /// `$X` has unlocked.
    Unlocked,
    /// Check mode is on.
    Enabled,
    /// Check mode is off.
    Disabled,
    /// The safety door is open.
    CheckDoor,
    /// A limit switch is closed at the start.
    CheckLimits,
    /// M2 or M30.
    ProgramEnd,
    /// `$RST`.
    RestoringDefaults,
    /// The spindle starts again after a hold.
    RestoringSpindle,
    /// `$SLP`.
    Sleeping,
    /// Another text.
    Other(&'a [u8]),
}

impl<'a> Feedback<'a> {
    const ALL: [Feedback<'static>; 11] = [
        Feedback::ResetToContinue,
        Feedback::Unlock,
        Feedback::Unlocked,
        Feedback::Enabled,
        Feedback::Disabled,
        Feedback::CheckDoor,
        Feedback::CheckLimits,
        Feedback::ProgramEnd,
        Feedback::RestoringDefaults,
        Feedback::RestoringSpindle,
        Feedback::Sleeping,
    ];

    /// Returns the text.
    pub const fn text(&self) -> &'a [u8] {
        match self {
            Feedback::ResetToContinue => b"Reset to continue",
            Feedback::Unlock => b"'$H'|'$X' to unlock",
            Feedback::Unlocked => b"Caution: Unlocked",
            Feedback::Enabled => b"Enabled",
            Feedback::Disabled => b"Disabled",
            Feedback::CheckDoor => b"Check Door",
            Feedback::CheckLimits => b"Check Limits",
            Feedback::ProgramEnd => b"Pgm End",
            Feedback::RestoringDefaults => b"Restoring defaults",
            Feedback::RestoringSpindle => b"Restoring spindle",
            Feedback::Sleeping => b"Sleeping",
            Feedback::Other(text) => text,
        }
    }

    fn parse(text: &'a [u8]) -> Feedback<'a> {
        let mut all = Feedback::ALL.into_iter();
        all.find(|known| known.text() == text)
            .unwrap_or(Feedback::Other(text))
    }
}

fn put_error(text: &mut Text, error: ErrorCode) {
    text.put(b"error:");
    text.put_number(error.number().into());
}

impl<'a> Message<'a> {
    /// Whether the line answers a line of the sender. A sender counts these answers.
    pub const fn is_answer(&self) -> bool {
        matches!(self, Message::Ok | Message::Error(_))
    }

    /// Returns the line, without its end.
    pub fn write(&self, units: Units) -> Text {
        let mut text = Text::new();
        match self {
            Message::Ok => text.put(b"ok"),
            Message::Error(error) => put_error(&mut text, *error),
            Message::Answer(number, error) => {
                match error {
                    Some(error) => put_error(&mut text, *error),
                    None => text.put(b"ok"),
                }
                text.put(b" N");
                text.put_number((*number).into());
                put_sum(&mut text);
            }
            Message::Resend(number) => {
                text.put(b"resend N");
                text.put_number((*number).into());
                put_sum(&mut text);
            }
            Message::Alarm(alarm) => {
                text.put(b"ALARM:");
                text.put_number(alarm.number().into());
            }
            Message::Banner(name) => {
                text.put(name);
                text.put(b" ['$' for help]");
            }
            Message::Status(status) => status.put(&mut text, units),
            Message::Setting(number, value) => {
                text.put(b"$");
                text.put_number((*number).into());
                text.put(b"=");
                text.put(value);
            }
            Message::Stored(number, line) => {
                text.put(b"$N");
                text.put_number((*number).into());
                text.put(b"=");
                text.put(line);
            }
            Message::Executed(line, error) => {
                text.put(b">");
                text.put(line);
                text.put(b":");
                match error {
                    Some(error) => put_error(&mut text, *error),
                    None => text.put(b"ok"),
                }
            }
            Message::Blank => {}
            bracketed => bracketed.put_bracketed(&mut text, units),
        }
        text
    }

    fn put_bracketed(&self, text: &mut Text, units: Units) {
        text.put(b"[");
        match self {
            Message::Feedback(feedback) => {
                text.put(b"MSG:");
                text.put(feedback.text());
            }
            Message::Modal(state) => {
                text.put(b"GC:");
                state.put(text, units);
            }
            Message::Parameter(parameter, place) => {
                text.put(parameter.name().as_bytes());
                text.put(b":");
                place.put(text, units);
            }
            Message::ToolLength(nm) => {
                text.put(b"TLO:");
                text.put_length(*nm, units);
            }
            Message::Probe(place, contact) => {
                text.put(b"PRB:");
                place.put(text, units);
                text.put(if *contact { b":1" } else { b":0" });
            }
            Message::Version(version, user) => {
                text.put(b"VER:");
                text.put(version);
                text.put(b":");
                text.put(user);
            }
            Message::Options(letters, blocks, bytes) => {
                text.put(b"OPT:");
                text.put(letters);
                text.put(b",");
                text.put_number((*blocks).into());
                text.put(b",");
                text.put_number((*bytes).into());
            }
            Message::Help(list) => {
                text.put(b"HLP:");
                text.put(list);
            }
            Message::NextLine(number) => {
                text.put(b"LINE:");
                text.put_number((*number).into());
            }
            _ => {}
        }
        text.put(b"]");
    }

    /// Reads a line without its end. Returns `None` if it is not a message of Grbl 1.1.
    pub fn parse(line: &'a [u8]) -> Option<Message<'a>> {
        Some(match line {
            [] => Message::Blank,
            b"ok" => Message::Ok,
            [b'<', status @ .., b'>'] => Message::Status(Status::parse(status)?.0),
            [b'[', text @ .., b']'] => Message::parse_bracketed(text)?,
            [b'>', text @ ..] => {
                let (line, error) = match text.strip_suffix(b":ok") {
                    Some(line) => (line, None),
                    None => {
                        let at = text.windows(7).rposition(|part| part == b":error:")?;
                        let (line, error) = text.split_at_checked(at)?;
                        let number = whole(error.strip_prefix(b":error:")?)?;
                        (line, Some(ErrorCode::of(number)?))
                    }
                };
                Message::Executed(line, error)
            }
            [b'$', b'N', rest @ ..] => {
                let (number, line) = split(rest, b'=')?;
                Message::Stored(whole(number)?, line)
            }
            [b'$', rest @ ..] => {
                let (number, value) = split(rest, b'=')?;
                Message::Setting(whole(number)?, value)
            }
            _ => {
                if line.contains(&b'*') {
                    Message::parse_numbered(without_sum(line)?)?
                } else if let Some(number) = line.strip_prefix(b"error:") {
                    Message::Error(ErrorCode::of(whole(number)?)?)
                } else if let Some(number) = line.strip_prefix(b"ALARM:") {
                    Message::Alarm(Alarm::of(whole(number)?)?)
                } else {
                    Message::Banner(line.strip_suffix(b" ['$' for help]")?)
                }
            }
        })
    }

    /// Reads an answer that names its line.
    fn parse_numbered(line: &'a [u8]) -> Option<Message<'a>> {
        let (word, number) = split(line, b' ')?;
        let number = whole(number.strip_prefix(b"N")?)?;
        Some(match word {
            b"ok" => Message::Answer(number, None),
            b"resend" => Message::Resend(number),
            _ => {
                let error = whole(word.strip_prefix(b"error:")?)?;
                Message::Answer(number, Some(ErrorCode::of(error)?))
            }
        })
    }

    fn parse_bracketed(text: &'a [u8]) -> Option<Message<'a>> {
        let (name, value) = split(text, b':')?;
        Some(match name {
            b"MSG" => Message::Feedback(Feedback::parse(value)),
            b"GC" => Message::Modal(ModalState::parse(value)?.0),
            b"TLO" => Message::ToolLength(length(value)?.0),
            b"PRB" => {
                let (place, contact) = split(value, b':')?;
                Message::Probe(Place::parse(place)?.0, whole::<u8>(contact)? == 1)
            }
            b"VER" => {
                let (version, user) = split(value, b':')?;
                Message::Version(version, user)
            }
            b"OPT" => {
                let (letters, numbers) = split(value, b',')?;
                let (blocks, bytes) = split(numbers, b',')?;
                Message::Options(letters, whole(blocks)?, whole(bytes)?)
            }
            b"HLP" => Message::Help(value),
            b"LINE" => Message::NextLine(whole(value)?),
            _ => {
                let mut all = Parameter::ALL.into_iter();
                let parameter = all.find(|parameter| parameter.name().as_bytes() == name)?;
                Message::Parameter(parameter, Place::parse(value)?.0)
            }
        })
    }
}

/// The exclusive or of all bytes, which detects one wrong byte.
fn sum(text: &[u8]) -> u8 {
    text.iter().fold(0, |sum, byte| sum ^ byte)
}

fn put_sum(text: &mut Text) {
    let sum = sum(text.bytes());
    text.put(b"*");
    text.put_number(sum.into());
}

/// Returns the text before `*`, if its sum is the number after it.
fn without_sum(line: &[u8]) -> Option<&[u8]> {
    let (text, given) = split(line, b'*')?;
    (whole::<u8>(given)? == sum(text)).then_some(text)
}

/// Returns the text before and after the first such byte.
fn split(text: &[u8], at: u8) -> Option<(&[u8], &[u8])> {
    let at = text.iter().position(|byte| *byte == at)?;
    let (before, rest) = text.split_at_checked(at)?;
    Some((before, rest.get(1..)?))
}
