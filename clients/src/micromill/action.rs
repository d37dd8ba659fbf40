//! Actions of a mill that is moved by hand.

use husillo_transports::micromill::Axis;
use std::fmt;
use std::time::Duration;

/// One action.
#[derive(Clone, Debug, PartialEq)]
pub enum Action {
    /// Home Z, X and Y.
    Home,
    /// Move an axis by signed steps.
    Steps(Axis, i32),
    /// Jog one or several axes for a time, then at other speeds for further times.
    Jog([i8; 3], Vec<Leg>),
    /// Run an axis at a signed rate in steps/s for a time.
    Run(Axis, i16, Duration),
    /// Set the backlash of an axis, um.
    Backlash(Axis, u16),
    /// Make the present position the zero of the part.
    Zero,
    /// Stop any motion, also that of another client.
    Stop,
    /// Report the positions of the motors.
    Where,
}

/// A part of a jog.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Leg {
    /// Change of speed at its start.
    pub pace: Pace,
    /// Its duration.
    pub time: Duration,
}

/// Change of speed between parts of a jog.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pace {
    /// Unchanged.
    Same,
    /// 10 steps/s faster.
    Faster,
    /// 10 steps/s slower.
    Slower,
}

impl Action {
    /// Reads words such as `home x 25 x+y- 2s faster 1s run z -250 1s`.
    ///
    /// # Errors
    ///
    /// Returns a sentence about the first word that is not understood.
    pub fn parse(words: &[String]) -> Result<Vec<Self>, String> {
        let mut words = words.iter().map(String::as_str);
        let mut actions = Vec::new();
        while let Some(word) = words.next() {
            actions.push(match word {
                "home" => Self::Home,
                "zero" => Self::Zero,
                "stop" => Self::Stop,
                "where" => Self::Where,
                "faster" | "slower" => {
                    let pace = if word == "faster" {
                        Pace::Faster
                    } else {
                        Pace::Slower
                    };
                    let time = time(word, words.next())?;
                    let Some(Self::Jog(_, legs)) = actions.last_mut() else {
                        return Err(format!("`{word}` must follow a jog: `x+ 2s {word} 1s`"));
                    };
                    legs.push(Leg { pace, time });
                    continue;
                }
                "run" => {
                    let axis = words.next().and_then(axis);
                    let hz = words.next().and_then(|hz| hz.parse().ok());
                    match (
                        axis,
                        hz.filter(|hz: &i16| *hz != 0 && hz.unsigned_abs() <= 999),
                    ) {
                        (Some(axis), Some(hz)) => Self::Run(axis, hz, time(word, words.next())?),
                        _ => return Err(
                            "`run` which axis at how many steps a second? As in `run x -250 2s`"
                                .into(),
                        ),
                    }
                }
                "backlash" => {
                    let axis = words.next().and_then(axis);
                    let um = words.next().and_then(|um| um.parse().ok());
                    match (axis, um.filter(|um| *um <= 999)) {
                        (Some(axis), Some(um)) => Self::Backlash(axis, um),
                        _ => {
                            return Err(
                                "`backlash` of which axis, in micrometres? As in `backlash x 204`"
                                    .into(),
                            );
                        }
                    }
                }
                _ => Self::motion(word, words.next())?,
            });
        }
        Ok(actions)
    }

    /// Reads a motion such as `x 25`, `x+ 2s` or `x+y- 2s`.
    fn motion(word: &str, amount: Option<&str>) -> Result<Self, String> {
        if let Some(axis) = axis(word) {
            let steps = amount.and_then(|steps| steps.parse().ok());
            let steps = steps.filter(|steps| *steps != 0).ok_or_else(|| {
                format!("`{word}` by how many steps? As in `{word} 25` or `{word} -25`")
            })?;
            return Ok(Self::Steps(axis, steps));
        }
        let mut ways = [0; 3];
        let mut rest = word;
        while let Some((letter, (way, after))) = rest
            .split_at_checked(1)
            .and_then(|(letter, rest)| Some((axis(letter)?, rest.split_at_checked(1)?)))
        {
            let place = &mut ways[letter as usize];
            *place = match (*place, way) {
                (0, "+") => 1,
                (0, "-") => -1,
                _ => break,
            };
            rest = after;
        }
        if word.is_empty() || !rest.is_empty() {
            return Err(format!(
                "unknown action `{word}`: a mill has home, steps as in `x -25`, jogs as in \
                         `x+ 2s` or `x+y- 2s faster 1s slower 1s`, \
                 run x -250 2s, backlash x 204, zero, stop, where"
            ));
        }
        let time = time(word, amount)?;
        let pace = Pace::Same;
        Ok(Self::Jog(ways, vec![Leg { pace, time }]))
    }
}

fn axis(letter: &str) -> Option<Axis> {
    Some(match letter {
        "x" => Axis::X,
        "y" => Axis::Y,
        "z" => Axis::Z,
        _ => return None,
    })
}

const fn letter(axis: Axis) -> char {
    axis.letter().to_ascii_lowercase() as char
}

/// Reads a time such as `1.5s`.
fn time(word: &str, amount: Option<&str>) -> Result<Duration, String> {
    amount
        .and_then(|amount| amount.strip_suffix('s'))
        .and_then(|seconds| seconds.parse().ok())
        .filter(|seconds| (0.0..=3600.0).contains(seconds))
        .map(Duration::from_secs_f64)
        .ok_or_else(|| format!("`{word}` how long? As in `{word} 1.5s`"))
}

impl fmt::Display for Action {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Home => f.write_str("home"),
            Self::Steps(axis, steps) => write!(f, "{} {steps:+}", letter(*axis)),
            Self::Jog(ways, _) => (Axis::ALL.into_iter().zip(ways))
                .filter(|(_, way)| **way != 0)
                .try_for_each(|(axis, way)| {
                    write!(f, "{}{}", letter(axis), if *way > 0 { '+' } else { '-' })
                }),
            Self::Run(axis, hz, _) => write!(f, "run {} {hz:+}", letter(*axis)),
            Self::Backlash(axis, um) => write!(f, "backlash {} {um}", letter(*axis)),
            Self::Zero => f.write_str("zero"),
            Self::Stop => f.write_str("stop"),
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
        let second = Duration::from_secs(1);
        let leg = |pace, seconds| Leg {
            pace,
            time: second * seconds,
        };
        let actions = parse(
            "home x -12000 x+y-z+ 2s faster 1s slower 3s z- 1s run y -250 1s backlash x 204 zero \
             stop where",
        );
        let expected = [
            Action::Home,
            Action::Steps(Axis::X, -12_000),
            Action::Jog(
                [1, -1, 1],
                vec![
                    leg(Pace::Same, 2),
                    leg(Pace::Faster, 1),
                    leg(Pace::Slower, 3),
                ],
            ),
            Action::Jog([0, 0, -1], vec![leg(Pace::Same, 1)]),
            Action::Run(Axis::Y, -250, second),
            Action::Backlash(Axis::X, 204),
            Action::Zero,
            Action::Stop,
            Action::Where,
        ];
        assert_eq!(actions.unwrap(), expected);
        let names: Vec<_> = expected.iter().map(Action::to_string).collect();
        assert_eq!(
            names.join(", "),
            "home, x -12000, x+y-z+, z-, run y -250, backlash x 204, zero, stop, where"
        );
        for wrong in [
            "fly",
            "x",
            "x 0",
            "x+ 3",
            "x++ 3s",
            "x+x- 3s",
            "x+y 3s",
            "w+ 3s",
            "faster 1s",
            "home slower 1s",
            "x+ 1s faster",
            "run x 0 1s",
            "run x 1000 1s",
            "run x -32768 1s",
            "run x 9",
            "backlash x 1000",
            "backlash x",
            "x+ -1s",
            "ä+ 1s",
        ] {
            assert!(parse(wrong).is_err(), "{wrong}");
        }
    }
}
