//! The actions of `husillo measure`.

use super::direction::Towards;
use husillo_metrology::Scale;
use husillo_metrology::calibration::{Body, ReferenceBody};
use husillo_metrology::heads::Approach;
use husillo_metrology::quantity::{self, Quantity};

/// One action. An axis is 0 for X to 2 for Z. A length is an amount of the scale.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Action {
    /// Move to this position in a straight line. Axes without a value stay where they are.
    GoTo([Option<i64>; 3], Approach),
    /// Make the present position of these axes 0.
    Zero([bool; 3]),
    /// Search the index of an axis and make its position 0.
    Home(usize),
    /// Move an axis for a time.
    Jog {
        towards: Towards,
        seconds: f64,
        is_slow: bool,
    },
    /// Touch the work piece.
    Touch(Towards),
    /// Touch a face at a known position and find the pre-travel.
    Calibrate(Towards),
    /// Calibrate the probe on a sphere or a ring.
    CalibrateOn(ReferenceBody),
    /// Report position and state of these axes; none means all.
    Status([bool; 3]),
    /// Report the positions of these axes in all coordinates; none means all.
    Where([bool; 3]),
}

impl Action {
    /// Reads words such as `goto X12 Y3 touch -z`. An action that names no axis means `axis`.
    ///
    /// # Errors
    ///
    /// A message about the first word that is not understood.
    pub fn parse(words: &[String], scale: Scale, axis: usize) -> Result<Vec<Self>, String> {
        let mut words = words.iter().map(String::as_str).peekable();
        let mut actions = Vec::new();
        while let Some(word) = words.next() {
            actions.push(match word {
                "goto" => {
                    let mut goal = [None; 3];
                    while let Some((coordinate, text)) = words.peek().and_then(|word| named(word)) {
                        goal[coordinate] = Some(position(word, text, scale)?);
                        words.next();
                    }
                    if goal == [None; 3] {
                        let text = words.next();
                        let text = text.ok_or(
                            "`goto` needs a position, as in `goto 1200` or `goto X10 Y-2.5`",
                        )?;
                        goal[axis] = Some(position(word, text, scale)?);
                    }
                    let guarded = words.next_if(|word| *word == "guarded");
                    let approach = guarded.map_or(Approach::Rapid, |_| Approach::Guarded);
                    Self::GoTo(goal, approach)
                }
                "zero" => {
                    let named = axes(&mut words);
                    let of_axis = [0, 1, 2].map(|number| number == axis);
                    Self::Zero(if named == [false; 3] { of_axis } else { named })
                }
                "home" => {
                    let named = words.peek().and_then(|word| letter(word));
                    if named.is_some() {
                        words.next();
                    }
                    Self::Home(named.unwrap_or(axis))
                }
                "jog" => {
                    let towards = towards(word, words.next(), axis)?;
                    if towards.axis.is_none() {
                        return Err(
                            "`jog` needs the direction of an axis, as in `jog +x 2s`".into()
                        );
                    }
                    let time = words.next().unwrap_or_default();
                    Self::Jog {
                        towards,
                        seconds: seconds(time)?,
                        is_slow: words.next_if(|word| *word == "slow").is_some(),
                    }
                }
                "touch" => Self::Touch(towards(word, words.next(), axis)?),
                "calibrate" if words.peek().is_some_and(|word| body(word).is_some()) => {
                    Self::CalibrateOn(reference(&mut words, scale)?)
                }
                "calibrate" => {
                    let towards = towards(word, words.next(), axis)?;
                    if towards.axis.is_none() {
                        return Err(
                            "`calibrate` needs the direction of an axis, as in `calibrate +x`"
                                .into(),
                        );
                    }
                    Self::Calibrate(towards)
                }
                "status" => Self::Status(axes(&mut words)),
                "where" => Self::Where(axes(&mut words)),
                other => {
                    return Err(format!(
                        "unknown action `{other}`: there are goto POSITION, zero, home, \
                         jog DIRECTION TIME, touch DIRECTION, calibrate DIRECTION, status, \
                         where; and as the last one run FILE, record FILE, session"
                    ));
                }
            });
        }
        Ok(actions)
    }

    /// The axes that the action names, 0 to 2; none means all.
    pub fn axes(&self) -> Vec<usize> {
        match self {
            Self::GoTo(goal, _) => (0..3).filter(|axis| goal[*axis].is_some()).collect(),
            Self::Zero(axes) | Self::Status(axes) | Self::Where(axes) => {
                (0..3).filter(|axis| axes[*axis]).collect()
            }
            Self::Home(axis) => vec![*axis],
            Self::Touch(towards) | Self::Calibrate(towards) | Self::Jog { towards, .. } => {
                towards.axis.into_iter().collect()
            }
            Self::CalibrateOn(_) => Vec::new(),
        }
    }
}

/// Reads `x` as an axis.
fn letter(word: &str) -> Option<usize> {
    let word = word.to_ascii_uppercase();
    "XYZ".find(&word).filter(|_| word.len() == 1)
}

/// The axes named by the next words.
fn axes<'a>(words: &mut std::iter::Peekable<impl Iterator<Item = &'a str>>) -> [bool; 3] {
    let mut named = [false; 3];
    while let Some(axis) = words.peek().and_then(|word| letter(word)) {
        named[axis] = true;
        words.next();
    }
    named
}

/// Reads `X-1.5` as an axis and a number.
fn named(word: &str) -> Option<(usize, &str)> {
    let letter = word.chars().next()?.to_ascii_uppercase();
    let axis = "XYZ".find(letter)?;
    // The letter is one byte.
    let number = word.get(1..)?;
    let begins = number.starts_with(|c: char| c.is_ascii_digit() || matches!(c, '+' | '-' | '.'));
    begins.then_some((axis, number))
}

/// Reads a time such as `2s` or `300ms`.
fn seconds(text: &str) -> Result<f64, String> {
    match quantity::parse(text) {
        Ok(Quantity::Time(us)) if us.num >= 0 => Ok(us.num as f64 / us.den as f64 / 1e6),
        _ if text.is_empty() => Err("`jog` needs a time, as in `jog +x 2s`".into()),
        _ => Err(format!(
            "`jog` needs a time, as in `jog +x 2s`: `{text}` is none"
        )),
    }
}

/// A body to calibrate on.
fn body(word: &str) -> Option<Body> {
    match word {
        "sphere" => Some(Body::Sphere),
        "ring" => Some(Body::Ring),
        _ => None,
    }
}

/// Reads `sphere X-25 Y25 Z-20 R10`.
fn reference<'a>(
    words: &mut impl Iterator<Item = &'a str>,
    scale: Scale,
) -> Result<ReferenceBody, String> {
    let name = words.next().unwrap_or_default();
    let place = |words: &[&str]| {
        let mut centre = [None; 3];
        let mut radius = None;
        for word in words {
            if let Some(text) = word.strip_prefix(['R', 'r']) {
                radius = Some(position("calibrate", text, scale).ok()?);
            } else {
                let (coordinate, text) = named(word)?;
                centre[coordinate] = Some(position("calibrate", text, scale).ok()?);
            }
        }
        let [x, y, z] = centre;
        Some(([x?, y?, z?], radius.filter(|radius| *radius > 0)?))
    };
    let words: Vec<&str> = words.take(4).collect();
    let (centre, radius) = place(&words).ok_or_else(|| {
        format!(
            "`calibrate {name}` needs a centre and a radius, as in \
             `calibrate {name} X-25 Y25 Z-20 R10`"
        )
    })?;
    Ok(ReferenceBody {
        body: body(name).unwrap_or(Body::Sphere),
        centre,
        radius,
    })
}

fn position(action: &str, text: &str, scale: Scale) -> Result<i64, String> {
    let is_number = |first: char| first.is_ascii_digit() || matches!(first, '+' | '-' | '.');
    if !text.starts_with(is_number) {
        let why = "needs axes with positions, as in `goto 1200` or `goto X10 Y-2.5`";
        return Err(format!("`{action}` {why}"));
    }
    let amount = scale.amount(scale.parse(text)?);
    amount.ok_or_else(|| {
        let unit = scale.unit();
        format!("`{action} {text}`: a position of this machine is in {unit}")
    })
}

fn towards(action: &str, word: Option<&str>, axis: usize) -> Result<Towards, String> {
    let towards = word.and_then(|word| Towards::parse(word, axis));
    towards.ok_or_else(|| {
        format!(
            "`{action}` needs a direction, as in `{action} +`, `{action} -z` or `{action} 1,0,-1`"
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use husillo_metrology::quantity::Fraction;

    #[test]
    fn words_of_one_and_of_several_axes() {
        let scale = Scale::new(Fraction::new(2000, 1));
        let parse = |text: &str| {
            let words: Vec<String> = text.split(' ').map(str::to_owned).collect();
            Action::parse(&words, scale, 1)
        };
        let mm = |value: f64| Some((value * 1e6) as i64);
        assert_eq!(
            parse("goto 12 goto x1.5 Z-2 guarded zero zero x Z status").unwrap(),
            [
                Action::GoTo([None, mm(12.0), None], Approach::Rapid),
                Action::GoTo([mm(1.5), None, mm(-2.0)], Approach::Guarded),
                Action::Zero([false, true, false]),
                Action::Zero([true, false, true]),
                Action::Status([false; 3]),
            ]
        );
        assert_eq!(parse("touch -").unwrap()[0].axes(), [1]);
        assert_eq!(parse("touch x-").unwrap()[0].axes(), [0]);
        assert!(parse("touch (1,0,-1)").unwrap()[0].axes().is_empty());
        for wrong in [
            "goto",
            "goto touch",
            "touch",
            "touch q",
            "calibrate 1,1,0",
            "touch 0,0,0",
        ] {
            assert!(parse(wrong).is_err(), "{wrong}");
        }
    }
}
