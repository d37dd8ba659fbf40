//! What to do with a drill by hand, one thing after another.

use super::client::{Client, Trouble};
use husillo_gcode::drill_record::{Record, bytes};
use husillo_transports::drill::Step;
use std::fmt;
use std::time::Duration;

/// One action.
#[derive(Clone, Debug, PartialEq)]
pub enum Action {
    /// Home Z, Y and X.
    Home,
    /// An axis by so many steps, signed; Z positive downwards.
    Steps(Axis, i32),
    /// An axis for a while.
    Jog(Axis, bool, Duration),
    /// The spindle.
    Spindle(bool),
    /// The present place becomes a hole of the program.
    Teach,
    /// Write the program in the memory to a file.
    Save(String),
    /// Run the program in the memory.
    Run,
    /// Clear the program, and call the present place zero.
    Clear,
    /// Test the link.
    Test,
    /// Print the device's help.
    Help,
}

/// An axis, with the keys of the manual mode for both directions.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Axis {
    X,
    Y,
    Z,
}

impl Axis {
    const fn key(self, forward: bool) -> u8 {
        match (self, forward) {
            (Axis::X, true) => b'D',
            (Axis::X, false) => b'I',
            (Axis::Y, true) => b'F',
            (Axis::Y, false) => b'R',
            (Axis::Z, true) => b'L',
            (Axis::Z, false) => b'U',
        }
    }

    const fn name(self) -> &'static str {
        match self {
            Axis::X => "x",
            Axis::Y => "y",
            Axis::Z => "z",
        }
    }
}

impl Action {
    /// Reads words such as `home x 25 y+ 2s teach save board.cod`.
    ///
    /// # Errors
    ///
    /// A sentence about the first that is not understood.
    pub fn parse(words: &[String]) -> Result<Vec<Self>, String> {
        let mut words = words.iter();
        let mut actions = Vec::new();
        while let Some(word) = words.next() {
            actions.push(match word.as_str() {
                "home" => Self::Home,
                "teach" => Self::Teach,
                "run" => Self::Run,
                "clear" => Self::Clear,
                "test" => Self::Test,
                "help" => Self::Help,
                "spindle" => match words.next().map(String::as_str) {
                    Some("on") => Self::Spindle(true),
                    Some("off") => Self::Spindle(false),
                    _ => return Err("`spindle` on or off?".into()),
                },
                "save" => Self::Save(words.next().ok_or("`save` to which file?")?.clone()),
                _ => Self::axis(word, words.next())?,
            });
        }
        Ok(actions)
    }

    /// `x 25`, or `x+ 2s`.
    fn axis(word: &str, amount: Option<&String>) -> Result<Self, String> {
        let unknown = || {
            format!(
                "unknown action `{word}`: a drill has home, steps as in `x -25`, a jog as in `x+ 2s`, spindle on, spindle off, teach, save \
                 FILE, run, clear, test, help"
            )
        };
        let letter = word.trim_end_matches(['+', '-']);
        let axis = match letter {
            "x" => Axis::X,
            "y" => Axis::Y,
            "z" => Axis::Z,
            _ => return Err(unknown()),
        };
        let amount = amount.map(String::as_str).unwrap_or_default();
        match &word[letter.len()..] {
            "" => {
                let steps = amount.parse().ok().filter(|steps| *steps != 0);
                let steps = steps.ok_or_else(|| {
                    format!("`{word}` by how many steps? As in `{word} 25` or `{word} -25`")
                })?;
                Ok(Self::Steps(axis, steps))
            }
            sign @ ("+" | "-") => {
                let seconds = amount
                    .strip_suffix('s')
                    .and_then(|number| number.parse().ok());
                let seconds = seconds.filter(|seconds| (0.0..=3600.0).contains(seconds));
                let seconds =
                    seconds.ok_or_else(|| format!("`{word}` how long? As in `{word} 1.5s`"))?;
                let time = Duration::from_secs_f64(seconds);
                Ok(Self::Jog(axis, sign == "+", time))
            }
            _ => Err(unknown()),
        }
    }
}

impl fmt::Display for Action {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Home => f.write_str("home"),
            Self::Steps(axis, steps) => write!(f, "{} {steps:+}", axis.name()),
            Self::Jog(axis, forward, _) => {
                write!(f, "{}{}", axis.name(), if *forward { '+' } else { '-' })
            }
            Self::Spindle(on) => write!(f, "spindle {}", if *on { "on" } else { "off" }),
            Self::Teach => f.write_str("teach"),
            Self::Save(file) => write!(f, "save {file}"),
            Self::Run => f.write_str("run"),
            Self::Clear => f.write_str("clear"),
            Self::Test => f.write_str("test"),
            Self::Help => f.write_str("help"),
        }
    }
}

/// Steps of one key of a jog: a fifth of a second at 247 Hz.
const JOG_STEPS: u8 = 50;
/// A key takes 255 steps and the ways of Z at most.
const KEY: Duration = Duration::from_secs(60);
/// Longest run of a program that is in the memory: nobody knows how long it takes.
const LONGEST: Duration = Duration::from_secs(24 * 3600);

/// A drill by hand: in the manual mode, or idle.
pub struct Hand {
    client: Client,
    /// The advance of the manual mode, while it is in it.
    advance: Option<u8>,
}

impl Hand {
    /// A device that was reached.
    pub const fn new(client: Client) -> Self {
        Self {
            client,
            advance: None,
        }
    }

    /// The client.
    pub const fn client(&mut self) -> &mut Client {
        &mut self.client
    }

    /// Carries out an action: what there is to say of it.
    ///
    /// # Errors
    ///
    /// A sentence.
    pub fn carry_out(&mut self, action: &Action) -> Result<String, String> {
        self.do_it(action).map_err(|failed| match failed {
            Failed::Link(trouble) => trouble.text(),
            Failed::Other(sentence) => sentence,
        })
    }

    fn do_it(&mut self, action: &Action) -> Result<String, Failed> {
        let needs_extras = matches!(
            action,
            Action::Teach | Action::Save(_) | Action::Help | Action::Spindle(_)
        );
        if needs_extras && !self.client.has_extras() {
            // In the manual mode the original has a spindle, too.
            if !matches!(action, Action::Spindle(_)) {
                return Err(Failed::Other(
                    "this drill is an original one, which has no teach-in and no help".into(),
                ));
            }
            self.manual(JOG_STEPS)?;
        }
        match action {
            Action::Home if self.advance.is_some() => self.key(b'r')?,
            Action::Home => self.client.run_for(Step::Home, KEY, |_| {})?,
            Action::Steps(axis, steps) => self.steps(*axis, *steps)?,
            Action::Jog(axis, forward, time) => {
                self.manual(JOG_STEPS)?;
                let end = self.client.elapsed() + *time;
                while self.client.elapsed() < end && !self.client.is_stopping() {
                    self.key(axis.key(*forward))?;
                }
            }
            Action::Spindle(on) if self.advance.is_some() => {
                self.key(if *on { b'O' } else { b'S' })?;
            }
            Action::Spindle(on) => self.client.run(Step::Spindle(*on))?,
            Action::Teach => {
                self.manual(JOG_STEPS)?;
                self.client.run(Step::Teach)?;
            }
            Action::Save(file) => return self.save(file),
            Action::Run => {
                self.idle()?;
                self.client.run_for(Step::Execute, LONGEST, |_| {})?;
            }
            Action::Clear if self.advance.is_some() => self.key(b'c')?,
            Action::Clear => self.client.run(Step::Clear)?,
            Action::Test => {
                self.idle()?;
                self.client.run(Step::Test)?;
            }
            Action::Help => {
                self.idle()?;
                return Ok(self.client.help()?.trim_end().to_owned());
            }
        }
        if self.client.is_stopping() {
            return Err(Failed::Link(Trouble::Stopped));
        }
        Ok(String::new())
    }

    fn steps(&mut self, axis: Axis, steps: i32) -> Result<(), Failed> {
        let mut left = steps.unsigned_abs();
        while left > 0 {
            let part = u8::try_from(left).unwrap_or(u8::MAX);
            self.manual(part)?;
            if self.advance != Some(part) {
                self.client.run(Step::Advance(part))?;
                self.advance = Some(part);
            }
            self.key(axis.key(steps > 0))?;
            left -= u32::from(part);
            if self.client.is_stopping() {
                break;
            }
        }
        Ok(())
    }

    fn save(&mut self, file: &str) -> Result<String, Failed> {
        self.idle()?;
        let program = self.client.program()?;
        let records: Option<Vec<_>> = program.into_iter().map(Record::from_bytes).collect();
        let records = records.ok_or_else(|| Failed::Other("what it holds is no program".into()))?;
        if records.is_empty() {
            return Err(Failed::Other(
                "its memory holds no program: nothing to save".into(),
            ));
        }
        let count = records.len();
        let all: Vec<u8> = bytes(records).collect();
        std::fs::write(file, all).map_err(|error| Failed::Other(format!("{file}: {error}")))?;
        Ok(format!("{file}: {count} records"))
    }

    fn key(&mut self, key: u8) -> Result<(), Failed> {
        Ok(self.client.run_for(Step::Key(key), KEY, |_| {})?)
    }

    /// Into the manual mode, which homes; with this advance where it is entered.
    fn manual(&mut self, advance: u8) -> Result<(), Failed> {
        if self.advance.is_none() {
            // One wrong bit makes `e` of `m`: there must be nothing to run.
            self.client.run(Step::Clear)?;
            self.client.run_for(Step::Manual(advance), KEY, |_| {})?;
            self.advance = Some(advance);
        }
        Ok(())
    }

    /// Out of it.
    ///
    /// # Errors
    ///
    /// The link.
    fn idle(&mut self) -> Result<(), Failed> {
        if self.advance.take().is_some() {
            self.client.run(Step::Quit)?;
        }
        Ok(())
    }

    /// Leaves the manual mode, as the next client expects.
    ///
    /// # Errors
    ///
    /// A sentence.
    pub fn end(&mut self) -> Result<(), String> {
        self.idle().map_err(|failed| match failed {
            Failed::Link(trouble) => trouble.text(),
            Failed::Other(sentence) => sentence,
        })
    }
}

enum Failed {
    Link(Trouble),
    Other(String),
}

impl From<Trouble> for Failed {
    fn from(trouble: Trouble) -> Self {
        Failed::Link(trouble)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(text: &str) -> Result<Vec<Action>, String> {
        let words: Vec<String> = text.split_whitespace().map(str::to_owned).collect();
        Action::parse(&words)
    }

    #[test]
    fn words_are_actions() {
        let actions = parse("home x -300 y+ 0.5s teach save a.cod spindle on run").unwrap();
        let expected = [
            Action::Home,
            Action::Steps(Axis::X, -300),
            Action::Jog(Axis::Y, true, Duration::from_millis(500)),
            Action::Teach,
            Action::Save("a.cod".into()),
            Action::Spindle(true),
            Action::Run,
        ];
        assert_eq!(actions, expected);
        for text in [
            "fly", "x", "x 0", "x+ 3", "x++ 3s", "c 3", "x+ -1s", "save", "spindle",
        ] {
            assert!(parse(text).is_err(), "{text}");
        }
    }
}
