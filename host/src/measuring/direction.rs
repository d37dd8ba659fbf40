//! Directions on the command line.

use husillo_probe::UnitVector;

/// A direction. It knows its axis if it lies along one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Towards {
    /// The direction.
    pub direction: UnitVector,
    /// 0 for X to 2 for Z; `None` if it lies along no axis.
    pub axis: Option<usize>,
}

impl Towards {
    /// Reads `+`, `-` (along `axis`), `+x`, `x+`, `-z`, `z-`, or a vector as in `1,0,-0.5` or
    /// `(1,0,-0.5)`.
    pub fn parse(word: &str, axis: usize) -> Option<Self> {
        let (sign, letter) = match word.strip_prefix(['+', '-']) {
            Some(letter) => (word.chars().next()?, letter),
            None => (
                word.chars().last()?,
                word.strip_suffix(['+', '-']).unwrap_or_default(),
            ),
        };
        let letter = letter.to_ascii_uppercase();
        let along = match letter.as_str() {
            "" if word.len() == 1 => Some(axis),
            "X" | "Y" | "Z" => "XYZ".find(&letter),
            _ => None,
        };
        if let (Some(axis), '+' | '-') = (along, sign) {
            return Some(Self::along(axis, sign == '+'));
        }
        let inner = word
            .strip_prefix('(')
            .and_then(|word| word.strip_suffix(')'));
        let parts: Option<Vec<f64>> = inner
            .unwrap_or(word)
            .split(',')
            .map(|part| {
                part.trim()
                    .parse()
                    .ok()
                    .filter(|part: &f64| part.abs() <= 1e6)
            })
            .collect();
        let parts: [f64; 3] = parts?.try_into().ok()?;
        // At most 10^6 times 10^9: fits 64 bits.
        let direction = UnitVector::new(parts.map(|part| (part * 1e9).round() as i64))?;
        let whole = direction.components().map(|part| part.abs() == 1);
        let axis = whole.iter().position(|is_whole| *is_whole);
        Some(Self { direction, axis })
    }

    /// The positive or negative direction of an axis.
    pub fn along(axis: usize, is_positive: bool) -> Self {
        let direction = match axis {
            0 => UnitVector::X,
            1 => UnitVector::Y,
            _ => UnitVector::Z,
        };
        Self {
            direction: if is_positive {
                direction
            } else {
                direction.reversed()
            },
            axis: Some(axis),
        }
    }

    /// `+` or `-` along an axis, otherwise the three components.
    pub fn text(&self) -> String {
        let parts = self.direction.components();
        match self.axis {
            Some(axis) if parts[axis] > 0 => "+".to_owned(),
            Some(_) => "-".to_owned(),
            None => parts
                .map(|part| format!("{:.4}", part.to_num::<f64>()))
                .join(" "),
        }
    }
}
