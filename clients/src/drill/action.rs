//! Actions of a drill that is moved by hand.

use husillo_transports::drill::STEPS_PER_MM;
use std::fmt;
use std::time::Duration;

/// One action.
#[derive(Clone, Debug, PartialEq)]
pub enum Action {
    /// Home Z, Y and X.
    Home,
    /// Move an axis by signed steps. Z is positive downwards.
    Steps(Axis, i32),
    /// Jog an axis forward (`true`) or backward for a time.
    Jog(Axis, bool, Duration),
    /// Switch the spindle on (`true`) or off.
    Spindle(bool),
    /// Stop after the present record, leave the manual mode, and switch off the spindle.
    Stop,
    /// Add the present position as a hole of the program.
    Teach,
    /// Write the program in the memory to a file.
    Save(String),
    /// Run the program in the memory.
    Run,
    /// Clear the program, and make the present position zero.
    Clear,
    /// Test the link.
    Test,
    /// Print the device's help.
    Help,
    /// Print the position and the state that the drill reports.
    Where,
}

/// An axis. The manual mode has a key for each of its two directions.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Axis {
    /// Along the table.
    X,
    /// Across the table.
    Y,
    /// The spindle: positive downwards.
    Z,
}

impl Axis {
    pub(super) const fn key(self, forward: bool) -> u8 {
        match (self, forward) {
            (Axis::X, true) => b'D',
            (Axis::X, false) => b'I',
            (Axis::Y, true) => b'F',
            (Axis::Y, false) => b'R',
            (Axis::Z, true) => b'L',
            (Axis::Z, false) => b'U',
        }
    }

    pub(super) const fn name(self) -> &'static str {
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
    /// Returns a sentence about the first word that is not understood.
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
                "where" => Self::Where,
                "spindle" => match words.next().map(String::as_str) {
                    Some("on") => Self::Spindle(true),
                    Some("off") => Self::Spindle(false),
                    _ => return Err("`spindle` on or off?".into()),
                },
                "stop" => Self::Stop,
                "save" => Self::Save(words.next().ok_or("`save` to which file?")?.clone()),
                _ => Self::axis(word, words.next())?,
            });
        }
        Ok(actions)
    }

    /// Reads a motion such as `x 25` or `x+ 2s`.
    fn axis(word: &str, amount: Option<&String>) -> Result<Self, String> {
        let unknown = || {
            format!(
                "unknown action `{word}`: a drill has home, steps as in `x -25`, a length as in \
                 `x 2.5mm` or `x 0.1in`, a jog as in `x+ 2s`, spindle on, spindle off, stop, \
                 where, teach, save FILE, run, clear, test, help"
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
                let steps = steps(amount).filter(|steps| *steps != 0);
                let steps = steps.ok_or_else(|| {
                    format!(
                        "`{word}` by how many steps? As in `{word} 25`, `{word} -2.5mm` or \
                         `{word} 0.1in`"
                    )
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

/// Reads steps, or a length with its unit, which is rounded to the nearest step. At most 1 m.
fn steps(amount: &str) -> Option<i32> {
    let (number, mm) = match (amount.strip_suffix("mm"), amount.strip_suffix("in")) {
        (Some(number), _) => (number, 1.0),
        (_, Some(number)) => (number, 25.4),
        _ => return amount.parse().ok(),
    };
    let length: f64 = number.parse().ok()?;
    let mm = length * mm;
    (mm.abs() <= 1000.0).then(|| (mm * f64::from(STEPS_PER_MM)).round() as i32)
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
            Self::Stop => f.write_str("stop"),
            Self::Teach => f.write_str("teach"),
            Self::Save(file) => write!(f, "save {file}"),
            Self::Run => f.write_str("run"),
            Self::Clear => f.write_str("clear"),
            Self::Test => f.write_str("test"),
            Self::Help => f.write_str("help"),
            Self::Where => f.write_str("where"),
        }
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
        for (text, steps) in [("x 1mm", 107), ("x -2.5mm", -268), ("x 0.1in", 272)] {
            assert_eq!(parse(text), Ok(vec![Action::Steps(Axis::X, steps)]));
        }
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
            "fly",
            "x",
            "x 0",
            "x 0.001mm",
            "x 1cm",
            "x nanmm",
            "x 2000mm",
            "x+ 3",
            "x++ 3s",
            "c 3",
            "x+ -1s",
            "save",
            "spindle",
        ] {
            assert!(parse(text).is_err(), "{text}");
        }
    }
}
