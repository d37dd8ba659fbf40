//! What is measured of a feature, what it should be, and how far it may be off.

use serde::Serialize;

/// A figure of a feature.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Figure {
    /// Place along X.
    X,
    /// Place along Y.
    Y,
    /// Place along Z.
    Z,
    /// Of a circle or a sphere.
    Diameter,
    /// Of a web or a pocket.
    Width,
    /// Between two features.
    Length,
    /// Between two lines, or of one to the frame.
    Angle,
    /// Largest signed distance from the feature less the smallest: straightness, flatness,
    /// roundness.
    Form,
}

impl Figure {
    /// Places along X, Y, Z.
    pub const PLACES: [Self; 3] = [Self::X, Self::Y, Self::Z];

    /// As it is written and printed.
    pub const fn name(self) -> &'static str {
        match self {
            Self::X => "x",
            Self::Y => "y",
            Self::Z => "z",
            Self::Diameter => "diameter",
            Self::Width => "width",
            Self::Length => "length",
            Self::Angle => "angle",
            Self::Form => "form",
        }
    }

    /// Its unit.
    pub const fn unit(self) -> &'static str {
        match self {
            Self::Angle => "deg",
            _ => "mm",
        }
    }
}

/// What a figure should be, in millionths of its unit (so lengths in nm).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Wanted {
    /// Which.
    pub figure: Figure,
    /// As drawn.
    pub nominal_micro: i64,
    /// Least and most deviation; `None`: anything is right.
    pub tolerance_micro: Option<[i64; 2]>,
}

/// What a figure with a tolerance is called.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// Within it.
    Good,
    /// Not within it.
    Out,
    /// Nobody knows: a collision has bent or moved something.
    Spoiled,
}

/// A figure as measured, in millionths of its unit (so lengths in nm).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Dimension {
    /// Which.
    pub figure: Figure,
    /// As measured.
    pub actual_micro: i64,
    /// As it should be.
    pub wanted: Option<Wanted>,
}

impl Dimension {
    /// A figure and what is said of it in `wanted`.
    pub fn new(figure: Figure, actual_micro: i64, wanted: &[Wanted]) -> Self {
        let is_it = |wanted: &&Wanted| wanted.figure == figure;
        Self {
            figure,
            actual_micro,
            wanted: wanted.iter().find(is_it).copied(),
        }
    }

    /// Actual less nominal.
    pub fn deviation_micro(&self) -> Option<i64> {
        let wanted = self.wanted?;
        Some(self.actual_micro.saturating_sub(wanted.nominal_micro))
    }

    /// Whether it is within its tolerance, if it has one. Both ends are within.
    pub fn is_good(&self) -> Option<bool> {
        let [least, most] = self.wanted?.tolerance_micro?;
        let deviation = self.deviation_micro()?;
        Some((least..=most).contains(&deviation))
    }
}

/// Millionths as a number: exact below 2^53 before the division.
pub fn number(micro: i64) -> f64 {
    micro as f64 / 1e6
}

/// Millionths with four places: tenths of a micrometre.
pub fn decimal(micro: i64) -> String {
    let tenths = (micro as f64 / 100.0).round();
    // No minus before a zero.
    format!("{:.4}", if tenths == 0.0 { 0.0 } else { tenths / 1e4 })
}

/// The same with its sign.
pub fn signed(micro: i64) -> String {
    let text = decimal(micro);
    if text.starts_with('-') {
        text
    } else {
        format!("+{text}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_ends_are_within() {
        let wanted = |tolerance_micro| {
            [Wanted {
                figure: Figure::Width,
                nominal_micro: 20_000_000,
                tolerance_micro,
            }]
        };
        let judged =
            |actual, tolerance| Dimension::new(Figure::Width, actual, &wanted(tolerance)).is_good();
        let narrow = Some([-10_000, 30_000]);
        assert_eq!(judged(19_990_000, narrow), Some(true));
        assert_eq!(judged(19_989_999, narrow), Some(false));
        assert_eq!(judged(20_030_000, narrow), Some(true));
        assert_eq!(judged(20_030_001, narrow), Some(false));
        assert_eq!(judged(1, None), None);
        let other = Dimension::new(Figure::X, 5, &wanted(narrow));
        assert_eq!((other.is_good(), other.deviation_micro()), (None, None));
        assert_eq!(
            [decimal(-49), signed(1_250), signed(-1_250)],
            ["0.0000", "+0.0013", "-0.0013"]
        );
    }
}
