//! `step` or `steps_per_mm` of an axis in a machine file.

use crate::machines::table::Table;
use husillo_metrology::quantity::{Fraction, Quantity};

/// Reads the length of a step in nm, from `step` or `steps_per_mm`; of a rotary axis in millionths
/// of a degree, from `step` or `steps_per_degree`.
pub(super) fn read(table: &mut Table<'_, '_>, is_rotary: bool) -> Fraction {
    let key = match is_rotary {
        true => "steps_per_degree",
        false => "steps_per_mm",
    };
    let step = table.quantity(
        "step",
        "a length from 1 nm to 1 m as in \"0.14 um\", or an angle as in \"0.0125 deg\"",
        |quantity| match quantity {
            Quantity::Length(length) if is_step(length) => Some(length),
            _ => None,
        },
    );
    if let (Some(_), Some((_, span))) = (step, table.value(key)) {
        let message = format!("`{key}` as well as `step`");
        table.wrong(span, &message, "one of them is enough");
    }
    let per_unit = table.integer(key, 1..=1_000_000);
    let step = step.or(per_unit.and_then(|steps| Fraction::new(1_000_000, i128::from(steps))));
    if step.is_none() {
        table.missing("step");
    }
    step.unwrap_or(Fraction { num: 1, den: 1 })
}

/// Whether a length can be a step: at least 1 nm, the resolution of positions, and at most 1 m.
fn is_step(length: Fraction) -> bool {
    length.num >= length.den && length.num <= length.den.saturating_mul(1_000_000_000)
}
