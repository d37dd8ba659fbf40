//! Actions of a microfactory.

use super::figure::Figure;
use std::fmt;
use std::time::Duration;

/// One action.
#[derive(Clone, Debug, PartialEq)]
pub enum Action {
    /// Home X, Y and Z.
    Home,
    /// Turn a motor by signed steps.
    Steps {
        /// 0 to 3.
        motor: u8,
        /// Not 0.
        steps: i32,
    },
    /// Turn a motor for a time.
    Jog {
        /// 0 to 3.
        motor: u8,
        /// Forward, or clockwise.
        forward: bool,
        /// Duration.
        time: Duration,
    },
    /// Store another figure.
    Load(Figure),
    /// Cut the stored figure.
    Figure,
    /// Report the position.
    Where,
    /// Stop.
    Stop,
    /// Emergency stop.
    Emergency,
}

/// The actions of each machine. Actions after `2:` are for the second machine alone. Actions after
/// `all:`, and actions before any number, are for all machines.
///
/// # Errors
///
/// Returns a sentence about the first word that is not understood.
pub fn shares(
    words: &[String],
    machines: usize,
    figure: impl Fn(&str) -> Result<Figure, String>,
) -> Result<Vec<Vec<Action>>, String> {
    let mut shares = vec![Vec::new(); machines];
    let mut chosen = 0..machines;
    let is_choice = |word: &String| word.ends_with(':');
    let mut rest = words;
    loop {
        let length = rest.iter().position(is_choice).unwrap_or(rest.len());
        let (now, after) = rest.split_at(length);
        let actions = Action::parse(now, &figure)?;
        for share in &mut shares[chosen] {
            share.extend(actions.iter().cloned());
        }
        let Some((choice, after)) = after.split_first() else {
            return Ok(shares);
        };
        let number = choice.trim_end_matches(':').parse::<usize>().ok();
        chosen = match number.filter(|number| (1..=machines).contains(number)) {
            Some(number) => number - 1..number,
            None if choice == "all:" => 0..machines,
            None => {
                return Err(format!(
                    "`{choice}`: there are `all:` and, for the machines by number, `1:` to \
                     `{machines}:`"
                ));
            }
        };
        rest = after;
    }
}

/// The motors' letters.
const MOTORS: [&str; 4] = ["x", "y", "z", "c"];

impl Action {
    /// Reads words such as `home x 25 c+ 2s figure`.
    ///
    /// # Errors
    ///
    /// Returns a sentence about the first word that is not understood.
    pub fn parse(
        words: &[String],
        figure: impl Fn(&str) -> Result<Figure, String>,
    ) -> Result<Vec<Self>, String> {
        let mut words = words.iter();
        let mut actions = Vec::new();
        while let Some(word) = words.next() {
            actions.push(match word.as_str() {
                "home" => Self::Home,
                "load" => {
                    let file = words
                        .next()
                        .ok_or("`load` which figure? As in `load square.nc`")?;
                    Self::Load(figure(file)?)
                }
                "figure" => Self::Figure,
                "where" => Self::Where,
                "stop" => Self::Stop,
                "emergency" => Self::Emergency,
                _ => Self::motor(word, words.next())?,
            });
        }
        Ok(actions)
    }

    /// Reads a motion such as `x 25` or `x+ 2s`.
    fn motor(word: &str, amount: Option<&String>) -> Result<Self, String> {
        let unknown = || {
            format!(
                "unknown action `{word}`: there are home, load, figure, where, stop, emergency, \
                         steps as in `x -25`, a jog as in `x+ 2s`"
            )
        };
        let letter = word.trim_end_matches(['+', '-']);
        let motor = MOTORS.iter().position(|name| *name == letter);
        let motor = motor
            .and_then(|motor| u8::try_from(motor).ok())
            .ok_or_else(unknown)?;
        let amount = amount.map(String::as_str).unwrap_or_default();
        match word.strip_prefix(letter) {
            Some("") => {
                let steps = amount.parse().ok().filter(|steps| *steps != 0);
                let steps = steps.ok_or_else(|| {
                    format!("`{word}` by how many steps? As in `{word} 25` or `{word} -25`")
                })?;
                Ok(Self::Steps { motor, steps })
            }
            Some(sign @ ("+" | "-")) => {
                let seconds = amount
                    .strip_suffix('s')
                    .and_then(|number| number.parse().ok());
                let seconds = seconds.filter(|seconds| (0.0..=3600.0).contains(seconds));
                let seconds =
                    seconds.ok_or_else(|| format!("`{word}` how long? As in `{word} 1.5s`"))?;
                Ok(Self::Jog {
                    motor,
                    forward: sign == "+",
                    time: Duration::from_secs_f64(seconds),
                })
            }
            _ => Err(unknown()),
        }
    }
}

impl fmt::Display for Action {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let name = |motor: &u8| MOTORS.get(usize::from(*motor)).copied().unwrap_or_default();
        match self {
            Self::Home => f.write_str("home"),
            Self::Steps { motor, steps } => write!(f, "{} {steps:+}", name(motor)),
            Self::Jog { motor, forward, .. } => {
                write!(f, "{}{}", name(motor), if *forward { '+' } else { '-' })
            }
            Self::Load(figure) => write!(f, "load {}", figure.name),
            Self::Figure => f.write_str("figure"),
            Self::Where => f.write_str("where"),
            Self::Stop => f.write_str("stop"),
            Self::Emergency => f.write_str("emergency"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(text: &str) -> Result<Vec<Action>, String> {
        let words: Vec<String> = text.split_whitespace().map(str::to_owned).collect();
        Action::parse(&words, figure)
    }

    fn figure(file: &str) -> Result<Figure, String> {
        Ok(Figure {
            name: file.to_owned(),
            moves: vec![[1, 2]],
        })
    }

    #[test]
    fn every_machine_has_its_share() {
        let words = "home 2: x 5 figure 1: y 2 all: stop";
        let words: Vec<String> = words.split_whitespace().map(str::to_owned).collect();
        let shares = shares(&words, 2, figure).unwrap();
        let names =
            |share: &[Action]| -> Vec<String> { share.iter().map(Action::to_string).collect() };
        assert_eq!(names(&shares[0]), ["home", "y +2", "stop"]);
        assert_eq!(names(&shares[1]), ["home", "x +5", "figure", "stop"]);
        for wrong in ["3: home", "0: home", "x: home", "home 1:x 3"] {
            let words: Vec<String> = wrong.split_whitespace().map(str::to_owned).collect();
            assert!(super::shares(&words, 2, figure).is_err(), "{wrong}");
        }
    }

    #[test]
    fn words_are_actions() {
        let actions = parse("home x -300 c+ 0.5s load a.nc figure where").unwrap();
        let expected = [
            Action::Home,
            Action::Steps {
                motor: 0,
                steps: -300,
            },
            Action::Jog {
                motor: 3,
                forward: true,
                time: Duration::from_millis(500),
            },
            Action::Load(figure("a.nc").unwrap()),
            Action::Figure,
            Action::Where,
        ];
        assert_eq!(actions, expected);
        for text in ["fly", "x", "x 0", "x+ 3", "x++ 3s", "w 3", "x+ -1s", "load"] {
            assert!(parse(text).is_err(), "{text}");
        }
    }
}
