//! The requested position of a program: the value of `--zero`.

use husillo_gcode::Nm;
use husillo_metrology::quantity::{self, Quantity};
use std::str::FromStr;

/// The letters of axes.
pub const LETTERS: &str = "XYZABCUVWE";

/// The requested work zero in machine coordinates.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Zero {
    /// By axis, in the order of [`LETTERS`]. An axis that is not named has its work zero at machine
    /// zero.
    At([Option<Nm>; LETTERS.len()]),
    /// The part is in the middle of the table.
    Fit,
    /// In the middle of the table.
    Centre,
    /// At the low ends of X and Y.
    Corner,
}

impl FromStr for Zero {
    type Err = String;

    /// Reads `fit`, `centre`, `corner`, or axes with lengths as `X20Y-3.5` or `"X20 Z1in"`: in mm
    /// where there is no unit.
    fn from_str(text: &str) -> Result<Self, String> {
        let text = text.trim();
        match &text.to_ascii_lowercase()[..] {
            "fit" => return Ok(Self::Fit),
            "centre" | "center" => return Ok(Self::Centre),
            "corner" => return Ok(Self::Corner),
            _ => {}
        }
        let wanted = || {
            let axes = "axes with lengths, as in X20Y15 or \"X20 mm Z-3\"";
            format!("{axes}, or centre, corner or fit")
        };
        let mut zero = [None; LETTERS.len()];
        let mut rest = text;
        while let Some(letter) = rest.chars().next() {
            let axis = LETTERS
                .find(letter.to_ascii_uppercase())
                .ok_or_else(wanted)?;
            let behind = &rest[1..];
            // A capital letter of an axis, or one after a number: units have small letters.
            let mut before = ' ';
            let end = behind.find(|letter: char| {
                let follows = before.is_ascii_digit() || before == '.' || before == ' ';
                before = letter;
                let is_axis = LETTERS.contains(letter.to_ascii_uppercase());
                is_axis && (letter.is_ascii_uppercase() || matches!(letter, 'x' | 'y' | 'z'))
                    || is_axis && follows && !matches!(letter, 'u' | 'e')
            });
            let (value, more) = behind.split_at(end.unwrap_or(behind.len()));
            if zero[axis].replace(length(value.trim())?).is_some() {
                return Err(format!("{letter} is given twice"));
            }
            rest = more;
        }
        if zero == [None; LETTERS.len()] {
            return Err(wanted());
        }
        Ok(Self::At(zero))
    }
}

/// A length in mm or an angle in degrees, where there is no unit.
fn length(text: &str) -> Result<Nm, String> {
    let is_number = text.ends_with(|last: char| last.is_ascii_digit() || last == '.');
    let parsed = match is_number {
        true => quantity::parse(&format!("{text} mm")),
        false => quantity::parse(text),
    };
    match parsed? {
        Quantity::Length(value) if value.rounded().abs() <= FARTHEST => Ok(Nm(value.rounded())),
        // A degree is stored as a millimetre.
        Quantity::Angle(value) => length(&format!("{} mm", value.num as f64 / value.den as f64)),
        Quantity::Length(_) => Err(format!("`{text}` is out of range")),
        _ => Err(format!("`{text}` is no length")),
    }
}

/// Largest distance of work zero from machine zero: a kilometre.
const FARTHEST: i64 = 1_000_000_000_000;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn zeros_as_they_are_typed() {
        let at = |text: &str| text.parse::<Zero>();
        let um = |values: &[(usize, i64)]| {
            let mut zero = [None; LETTERS.len()];
            for (axis, um) in values {
                zero[*axis] = Some(Nm(um * 1000));
            }
            Ok(Zero::At(zero))
        };
        assert_eq!(at("X20Y-3.5"), um(&[(0, 20_000), (1, -3_500)]));
        assert_eq!(at(" z1in x 2 mm"), um(&[(0, 2_000), (2, 25_400)]));
        assert_eq!(at("Y+0.5 Z-1um"), um(&[(1, 500), (2, -1)]));
        assert_eq!(at("X1A90U2"), um(&[(0, 1_000), (3, 90_000), (6, 2_000)]));
        assert_eq!(at("A-45 deg Z3"), um(&[(3, -45_000), (2, 3_000)]));
        assert_eq!(at("Fit"), Ok(Zero::Fit));
        assert_eq!(at("centre"), Ok(Zero::Centre));
        assert_eq!(at("center"), Ok(Zero::Centre));
        assert_eq!(at("corner"), Ok(Zero::Corner));
        for wrong in [
            "",
            "X",
            "20",
            "X1X2",
            "I3",
            "X1 Hz",
            "X1e3",
            "X99999999999",
            "fits",
        ] {
            assert!(at(wrong).is_err(), "{wrong}");
        }
    }
}
