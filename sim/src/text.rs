//! Values as readable text, for panels, messages and reports.

mod duration;
mod length;
mod number;

pub use duration::duration;
pub use length::{length, millimetres};
pub use number::shortest;

use std::fmt::Display;

/// An integer with a comma before each three digits.
///
/// # Examples
/// ```
/// use husillo_sim::text::grouped;
///
/// assert_eq!(grouped(381_418), "381,418");
/// assert_eq!(grouped(-1000), "-1,000");
/// ```
pub fn grouped(number: impl Display) -> String {
    let text = number.to_string();
    let digits = text.trim_start_matches('-').len();
    let sign = text.len() - digits;
    let mut out = String::with_capacity(text.len() + digits / 3);
    for (at, letter) in text.chars().enumerate() {
        let left = text.len() - at;
        if at > sign && left.is_multiple_of(3) {
            out.push(',');
        }
        out.push(letter);
    }
    out
}

/// An integer and its noun, in the singular or in the plural.
///
/// # Examples
/// ```
/// use husillo_sim::text::counted;
///
/// assert_eq!(counted(1, "hole"), "1 hole");
/// assert_eq!(counted(0, "touch"), "0 touches");
/// assert_eq!(counted(12_000, "step"), "12,000 steps");
/// assert_eq!(counted(2, "axis"), "2 axes");
/// ```
pub fn counted(number: impl Display, singular: &str) -> String {
    let text = grouped(number);
    let noun = noun(&text, singular);
    format!("{text} {noun}")
}

/// A position and its unit, in the singular or in the plural. Positions have no commas.
///
/// # Examples
/// ```
/// use husillo_sim::text::position;
///
/// assert_eq!(position(-1, "step"), "-1 step");
/// assert_eq!(position(12_000, "step"), "12000 steps");
/// ```
pub fn position(number: impl Display, singular: &str) -> String {
    let text = number.to_string();
    let noun = noun(&text, singular);
    format!("{text} {noun}")
}

fn noun(number: &str, singular: &str) -> String {
    if number.trim_start_matches('-') == "1" {
        return singular.to_owned();
    }
    match singular.strip_suffix("is") {
        Some(stem) => format!("{stem}es"),
        None if singular.ends_with("ch") => format!("{singular}es"),
        None => format!("{singular}s"),
    }
}
