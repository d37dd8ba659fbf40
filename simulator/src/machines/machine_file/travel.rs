//! `travel` of an axis in a machine file.

use crate::machines::table::Table;
use husillo_metrology::quantity::{Fraction, Quantity};
use std::ops::Range;

/// Travel of an axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Travel {
    /// Lowest and highest position in the machine frame, nm.
    Range([i64; 2]),
    /// The travel is not known. Moves are not checked against it, and there is a warning.
    Unknown,
    /// There is no limit.
    Unlimited,
}

impl Travel {
    /// Reads `["0 mm", "10 mm"]`, `"unknown"` or `"unlimited"` for an axis with this step in nm.
    /// Also returns the span of the value, for later messages.
    pub(super) fn read(table: &mut Table<'_, '_>, step: Fraction) -> (Self, Range<usize>) {
        let Some((value, span)) = table.value("travel") else {
            return (Travel::Unknown, 0..0);
        };
        let length = |value: &toml::de::DeValue<'_>| match table.parsed(value.as_str()?) {
            Ok(Quantity::Length(length)) => Some(length.rounded()),
            Ok(Quantity::Steps(steps)) => Fraction::new(
                i128::from(steps.num) * i128::from(step.num),
                i128::from(steps.den) * i128::from(step.den),
            )
            .map(Fraction::rounded),
            _ => None,
        };
        let range =
            value
                .as_array()
                .and_then(|array| match (array.len(), array.first(), array.get(1)) {
                    (2, Some(low), Some(high)) => {
                        Some([length(low.get_ref())?, length(high.get_ref())?])
                    }
                    _ => None,
                });
        match (value.as_str(), range) {
            (Some("unknown"), _) => (Travel::Unknown, span),
            (Some("unlimited"), _) => (Travel::Unlimited, span),
            (_, Some([low, high])) if low < high => (Travel::Range([low, high]), span),
            _ => {
                table.wrong(
                    span.clone(),
                    "travel is not understood",
                    "expected [\"0 mm\", \"10 mm\"] (a rotary axis: \"deg\"), \"unknown\" or \
                     \"unlimited\"",
                );
                (Travel::Unknown, span)
            }
        }
    }
}
