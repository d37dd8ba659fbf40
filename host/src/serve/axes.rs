//! Values of axes, as pages write them: `{"x": 1.5, "z": -0.2}`.

use serde::Deserialize;
use std::collections::BTreeMap;

/// Letters of axes that a controller may have, in its order.
pub const LETTERS: [char; 6] = ['x', 'y', 'z', 'a', 'b', 'c'];
/// Largest magnitude of a length, mm.
const MOST: f64 = 1e6;

/// A value for some axes.
#[derive(Clone, Debug, Deserialize, PartialEq)]
pub struct Axes(BTreeMap<char, f64>);

impl Axes {
    /// The values, each with the number of its axis, of a machine with `count` axes.
    ///
    /// # Errors
    ///
    /// A sentence about an axis or a value.
    pub fn checked(&self, count: usize) -> Result<Vec<(usize, f64)>, String> {
        let mut checked = Vec::new();
        for (letter, value) in &self.0 {
            let axis = LETTERS.iter().take(count).position(|name| name == letter);
            let axis = axis.ok_or_else(|| format!("this machine has no axis `{letter}`"))?;
            if !value.is_finite() || value.abs() > MOST {
                return Err(format!("{letter}: {value} mm is out of range"));
            }
            checked.push((axis, *value));
        }
        match checked.is_empty() {
            true => Err("no axis is named".into()),
            false => Ok(checked),
        }
    }
}

/// Words of a line, such as `X1.500Z-0.200`.
pub fn words(values: &[(usize, f64)]) -> String {
    let word = |(axis, value): &(usize, f64)| {
        let letter = LETTERS.get(*axis).map_or('?', char::to_ascii_uppercase);
        // A rounded negative zero is written as zero.
        format!("{letter}{:.3}", (value * 1e3).round() / 1e3 + 0.0)
    };
    values.iter().map(word).collect()
}

/// Checks a feed in mm/min.
///
/// # Errors
///
/// A sentence about it.
pub fn feed(feed: f64) -> Result<f64, String> {
    match feed.is_finite() && (0.1..=1e6).contains(&feed) {
        true => Ok(feed),
        false => Err(format!("a feed of {feed} mm/min is out of range")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn axes(text: &str) -> Axes {
        serde_json::from_str(text).unwrap()
    }

    #[test]
    fn values_of_axes_become_words() {
        let values = axes(r#"{"z": -0.2, "x": 1.5}"#).checked(3).unwrap();
        assert_eq!(values, [(0, 1.5), (2, -0.2)]);
        assert_eq!(words(&values), "X1.500Z-0.200");
        assert_eq!(words(&[(1, -0.0001)]), "Y0.000");
    }

    #[test]
    fn unknown_axes_and_lengths_without_sense_are_refused() {
        for wrong in ["{}", r#"{"a": 1}"#, r#"{"x": 1e9}"#, r#"{"X": 1}"#] {
            assert!(axes(wrong).checked(3).is_err(), "{wrong}");
        }
        assert!(feed(0.0).is_err() && feed(f64::NAN).is_err() && feed(600.0).is_ok());
    }
}
