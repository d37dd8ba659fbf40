//! Actions of a machine that is moved by hand.

use std::fmt;

/// One action.
#[derive(Clone, Debug, PartialEq)]
pub enum Action {
    /// Run the homing cycle.
    Home,
    /// Unlock without homing.
    Unlock,
    /// Move axes by these distances, in words of a jog: `X10Y-5`.
    By(String),
    /// Move axes to these positions from the work zero.
    To(String),
    /// Speed of the next moves, mm/min.
    Feed(f64),
    /// Make the present position the zero of the present work coordinate system, for these axes.
    Zero(String),
    /// Stop any motion, also that of another program.
    Stop,
    /// Report state and position.
    Where,
    /// Report the settings, with their meaning.
    Settings,
    /// Set a setting.
    Set(u8, String),
}

const ACTIONS: &str = "a Grbl machine has home, unlock, by X10Y-5, to X0Y0, feed 600, zero, \
                       zero XY, stop, where, settings, set 110 1500";

impl Action {
    /// Reads words such as `home feed 600 by X10Y-5 zero XY where`.
    ///
    /// # Errors
    ///
    /// Returns a sentence about the first word that is not understood.
    pub fn parse(words: &[String]) -> Result<Vec<Self>, String> {
        let mut words = words.iter().map(String::as_str).peekable();
        let mut actions = Vec::new();
        while let Some(word) = words.next() {
            actions.push(match word {
                "home" => Self::Home,
                "unlock" => Self::Unlock,
                "stop" => Self::Stop,
                "where" => Self::Where,
                "settings" => Self::Settings,
                "by" => Self::By(axes(word, words.next())?),
                "to" => Self::To(axes(word, words.next())?),
                "zero" => match words.next_if(|next| is_letters(next) && *next != "by") {
                    Some(letters) => Self::Zero(letters.to_ascii_uppercase()),
                    None => Self::Zero("XYZ".into()),
                },
                "feed" => {
                    let feed = words.next().and_then(|feed| feed.parse().ok());
                    let feed = feed.filter(|feed: &f64| feed.is_finite() && *feed > 0.0);
                    Self::Feed(feed.ok_or("`feed` at how many mm a minute? As in `feed 600`")?)
                }
                "set" => {
                    let number = words.next().and_then(|number| number.parse().ok());
                    let value = words.next().filter(|value| value.parse::<f64>().is_ok());
                    match (number, value) {
                        (Some(number), Some(value)) => Self::Set(number, value.into()),
                        _ => return Err("`set` which setting to what? As in `set 110 1500`".into()),
                    }
                }
                _ => return Err(format!("unknown action `{word}`: {ACTIONS}")),
            });
        }
        Ok(actions)
    }
}

fn is_letters(word: &str) -> bool {
    !word.is_empty() && word.bytes().all(|byte| b"XYZABCxyzabc".contains(&byte))
}

/// Reads words of axes, each with a plain number, such as `X10Y-5`.
fn axes(action: &str, word: Option<&str>) -> Result<String, String> {
    let text = word.unwrap_or_default().to_ascii_uppercase();
    let mut rest = text.as_str();
    while let Some((letter, after)) = rest
        .split_at_checked(1)
        .filter(|(name, _)| is_letters(name))
    {
        let end = after.find(|next: char| next.is_ascii_alphabetic());
        let (number, next) = after.split_at(end.unwrap_or(after.len()));
        if number.parse::<f64>().is_err() || text.matches(letter).count() > 1 {
            break;
        }
        rest = next;
    }
    match rest.is_empty() && !text.is_empty() {
        true => Ok(text),
        false => Err(format!(
            "`{action}` which axes, in mm? As in `{action} X10Y-5`"
        )),
    }
}

impl fmt::Display for Action {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Home => f.write_str("home"),
            Self::Unlock => f.write_str("unlock"),
            Self::By(axes) => write!(f, "by {axes}"),
            Self::To(axes) => write!(f, "to {axes}"),
            Self::Feed(feed) => write!(f, "feed {feed}"),
            Self::Zero(letters) => write!(f, "zero {letters}"),
            Self::Stop => f.write_str("stop"),
            Self::Where => f.write_str("where"),
            Self::Settings => f.write_str("settings"),
            Self::Set(number, value) => write!(f, "set {number} {value}"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parsed(text: &str) -> Result<Vec<Action>, String> {
        let words: Vec<_> = text.split(' ').map(str::to_owned).collect();
        Action::parse(&words)
    }

    #[test]
    fn words_become_actions() {
        use Action::{By, Feed, Home, Set, Where, Zero};
        let actions = vec![
            Home,
            Feed(600.0),
            By("X10Y-5.5".into()),
            Zero("XY".into()),
            Zero("XYZ".into()),
            Where,
            Set(110, "1500".into()),
            Zero("XYZ".into()),
            By("X1".into()),
        ];
        let text = "home feed 600 by x10y-5.5 zero xy zero where set 110 1500 zero by X1";
        assert_eq!(parsed(text), Ok(actions));
    }

    #[test]
    fn wrong_words_are_explained() {
        for (text, part) in [
            ("fly", "unknown action `fly`"),
            ("by", "As in `by X10Y-5`"),
            ("by X", "As in `by X10Y-5`"),
            ("by X1X2", "As in `by X10Y-5`"),
            ("to F600", "As in `to X10Y-5`"),
            ("feed -1", "mm a minute"),
            ("set 110", "which setting"),
            ("set 300 1", "which setting"),
        ] {
            let error = parsed(text).unwrap_err();
            assert!(error.contains(part), "{text}: {error}");
        }
    }
}
