//! What to do with an axis, one thing after another.

use super::scale::Scale;

/// One action.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Action {
    /// Go to this position, counts.
    GoTo(i32),
    /// Call the present place 0.
    Zero,
    /// Touch the work piece.
    Touch { is_positive: bool },
    /// Touch a face at a known place and find the pre-travel.
    Calibrate { is_positive: bool },
    /// Say where it is and how it does.
    Status,
}

impl Action {
    /// Reads words such as `goto 1200 touch +`.
    ///
    /// # Errors
    ///
    /// A sentence about the first that is not understood.
    pub fn parse(words: &[String], scale: Scale) -> Result<Vec<Self>, String> {
        let mut words = words.iter();
        let mut actions = Vec::new();
        while let Some(word) = words.next() {
            actions.push(match word.as_str() {
                "goto" => {
                    let text = words.next().ok_or("`goto` where? As in `goto 1200`")?;
                    let place = scale.parse(text)?;
                    let counts = scale.counts(place);
                    Self::GoTo(counts.ok_or_else(|| {
                        format!("`goto {text}`: a position of this machine is in {}", scale.unit())
                    })?)
                }
                "zero" => Self::Zero,
                "touch" => Self::Touch {
                    is_positive: sign(word, words.next())?,
                },
                "calibrate" => Self::Calibrate {
                    is_positive: sign(word, words.next())?,
                },
                "status" => Self::Status,
                other => {
                    return Err(format!(
                        "unknown action `{other}`: there are goto POSITION, zero, touch +|-, calibrate +|-, status"
                    ));
                }
            });
        }
        Ok(actions)
    }
}

/// Whether a direction is the positive one.
fn sign(action: &str, word: Option<&String>) -> Result<bool, String> {
    match word.map(String::as_str) {
        Some("+") => Ok(true),
        Some("-") => Ok(false),
        _ => Err(format!(
            "`{action}` in which direction? As in `{action} +` or `{action} -`"
        )),
    }
}
