//! What to do with a machine, one thing after another.

use super::direction::Towards;
use super::scale::Scale;

/// One action. Axes are 0 for X to 2 for Z, lengths amounts of the scale.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Action {
    /// Go to this position in a straight line; axes without one stay.
    GoTo([Option<i64>; 3]),
    /// Call the present place of an axis 0.
    Zero(usize),
    /// Touch the work piece.
    Touch(Towards),
    /// Touch a face at a known place and find the pre-travel.
    Calibrate(Towards),
    /// Say where an axis is and how it does.
    Status(usize),
}

impl Action {
    /// Reads words such as `goto X12 Y3 touch -z`; `axis` is the one meant where none is named.
    ///
    /// # Errors
    ///
    /// A sentence about the first that is not understood.
    pub fn parse(words: &[String], scale: Scale, axis: usize) -> Result<Vec<Self>, String> {
        let mut words = words.iter().map(String::as_str).peekable();
        let mut actions = Vec::new();
        while let Some(word) = words.next() {
            actions.push(match word {
                "goto" => {
                    let mut goal = [None; 3];
                    while let Some((coordinate, text)) = words.peek().and_then(|word| named(word)) {
                        goal[coordinate] = Some(position(text, scale)?);
                        words.next();
                    }
                    if goal == [None; 3] {
                        let text = words.next();
                        let text = text.ok_or("`goto` where? As in `goto 1200` or `goto X10 Y-2.5`")?;
                        goal[axis] = Some(position(text, scale)?);
                    }
                    Self::GoTo(goal)
                }
                "zero" => Self::Zero(axis),
                "touch" => Self::Touch(towards(word, words.next(), axis)?),
                "calibrate" => {
                    let towards = towards(word, words.next(), axis)?;
                    if towards.axis.is_none() {
                        return Err("`calibrate` goes along an axis, as in `calibrate +x`".into());
                    }
                    Self::Calibrate(towards)
                }
                "status" => Self::Status(axis),
                other => {
                    return Err(format!(
                        "unknown action `{other}`: there are goto POSITION, zero, touch DIRECTION, calibrate DIRECTION, status"
                    ));
                }
            });
        }
        Ok(actions)
    }

    /// The axes it names, 0 to 2; none for all.
    pub fn axes(&self) -> Vec<usize> {
        match self {
            Self::GoTo(goal) => (0..3).filter(|axis| goal[*axis].is_some()).collect(),
            Self::Zero(axis) | Self::Status(axis) => vec![*axis],
            Self::Touch(towards) | Self::Calibrate(towards) => towards.axis.into_iter().collect(),
        }
    }
}

/// `X-1.5` as axis and number.
fn named(word: &str) -> Option<(usize, &str)> {
    let letter = word.chars().next()?.to_ascii_uppercase();
    let axis = "XYZ".find(letter)?;
    // A letter of one byte.
    let number = word.get(1..)?;
    let begins = number.starts_with(|c: char| c.is_ascii_digit() || matches!(c, '+' | '-' | '.'));
    begins.then_some((axis, number))
}

fn position(text: &str, scale: Scale) -> Result<i64, String> {
    let amount = scale.amount(scale.parse(text)?);
    amount.ok_or_else(|| {
        let unit = scale.unit();
        format!("`goto {text}`: a position of this machine is in {unit}")
    })
}

fn towards(action: &str, word: Option<&str>, axis: usize) -> Result<Towards, String> {
    let towards = word.and_then(|word| Towards::parse(word, axis));
    towards.ok_or_else(|| {
        format!(
            "`{action}` in which direction? As in `{action} +`, `{action} -z` or `{action} 1,0,-1`"
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::quantity::Fraction;

    #[test]
    fn words_of_one_and_of_several_axes() {
        let scale = Scale::new(Fraction::new(2000, 1));
        let parse = |text: &str| {
            let words: Vec<String> = text.split(' ').map(str::to_owned).collect();
            Action::parse(&words, scale, 1)
        };
        let mm = |value: f64| Some((value * 1e6) as i64);
        assert_eq!(
            parse("goto 12 goto x1.5 Z-2 zero").unwrap(),
            [
                Action::GoTo([None, mm(12.0), None]),
                Action::GoTo([mm(1.5), None, mm(-2.0)]),
                Action::Zero(1)
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
