//! The figures of a feature: measured values, nominal values and tolerances.

use serde::Serialize;

/// A figure of a feature.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Figure {
    /// Position on X.
    X,
    /// Position on Y.
    Y,
    /// Position on Z.
    Z,
    /// Diameter of a circle or a sphere.
    Diameter,
    /// Width of a web or a pocket.
    Width,
    /// Distance between two features.
    Length,
    /// Angle between two lines, or of a line to the frame.
    Angle,
    /// Largest minus smallest signed distance from the feature: straightness, flatness or
    /// roundness.
    Form,
}

impl Figure {
    /// Positions on X, Y, Z.
    pub const COORDINATES: [Self; 3] = [Self::X, Self::Y, Self::Z];

    /// Its name in routines and in results.
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

/// The wanted value of a figure, in millionths of its unit (so lengths in nm).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Wanted {
    /// The figure.
    pub figure: Figure,
    /// Nominal value.
    pub nominal_micro: i64,
    /// Lowest and highest deviation. `None`: any deviation is good.
    pub tolerance_micro: Option<[i64; 2]>,
}

/// Verdict on a figure with a tolerance.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// Within its tolerance.
    Good,
    /// Out of its tolerance.
    Out,
    /// Not known, because a collision may have bent the stylus or moved the part.
    Spoiled,
}

/// A figure as measured, in millionths of its unit (so lengths in nm).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Dimension {
    /// The figure.
    pub figure: Figure,
    /// Measured value.
    pub actual_micro: i64,
    /// The wanted value.
    pub wanted: Option<Wanted>,
}

impl Dimension {
    /// A measured figure, and its entry in `wanted`.
    pub fn new(figure: Figure, actual_micro: i64, wanted: &[Wanted]) -> Self {
        let is_it = |wanted: &&Wanted| wanted.figure == figure;
        Self {
            figure,
            actual_micro,
            wanted: wanted.iter().find(is_it).copied(),
        }
    }

    /// Actual minus nominal value.
    pub fn deviation_micro(&self) -> Option<i64> {
        let wanted = self.wanted?;
        Some(self.actual_micro.saturating_sub(wanted.nominal_micro))
    }

    /// Whether it is within its tolerance. Both limits are within. `None`: it has no tolerance.
    pub fn is_good(&self) -> Option<bool> {
        let [least, most] = self.wanted?.tolerance_micro?;
        let deviation = self.deviation_micro()?;
        Some((least..=most).contains(&deviation))
    }
}

/// Millionths as a number. The conversion before the division is exact below 2^53.
pub fn number(micro: i64) -> f64 {
    micro as f64 / 1e6
}

/// Millionths as text with four decimal places: tenths of a micrometre.
pub fn decimal(micro: i64) -> String {
    let tenths = (micro as f64 / 100.0).round();
    // A zero has no minus.
    format!("{:.4}", if tenths == 0.0 { 0.0 } else { tenths / 1e4 })
}

/// Millionths as text with four decimal places and a sign.
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
    fn both_limits_are_within() {
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
