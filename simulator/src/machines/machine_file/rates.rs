//! The rates of an axis in a machine file.

use crate::machines::table::Table;
use husillo_metrology::quantity::{Fraction, Quantity};

/// The rates of an axis, steps per second.
pub(super) struct Rates {
    /// `max_rate`.
    pub max: u32,
    /// `start_rate`.
    pub start: Option<u32>,
    /// `pull_out_rate`.
    pub pull_out: Option<u32>,
    /// `junction`.
    pub junction: Option<u32>,
}

impl Rates {
    /// Reads the rates of an axis with this step in nm.
    pub(super) fn read(table: &mut Table<'_, '_>, step: Fraction) -> Self {
        let max = rate(table, "max_rate", step);
        if max.is_none() {
            table.missing("max_rate");
        }
        let start = rate(table, "start_rate", step);
        let pull_out = rate(table, "pull_out_rate", step);
        let junction = rate(table, "junction", step);
        check_above(
            table,
            ["max_rate", "pull_out_rate"],
            [max, pull_out],
            "the motor loses steps there",
        );
        check_above(
            table,
            ["start_rate", "max_rate"],
            [start, max],
            "the axis never steps as fast",
        );
        Self {
            max: max.unwrap_or(1),
            start,
            pull_out,
            junction,
        }
    }
}

/// Reads a rate in steps/s, or a speed of the axis.
fn rate(table: &mut Table<'_, '_>, key: &'static str, step: Fraction) -> Option<u32> {
    table.quantity(
        key,
        "a rate as in \"170 Hz\", or a speed as in \"30 mm/min\" or \"720 deg/min\"",
        |quantity| match quantity {
            Quantity::Rate(value) => positive(value.rounded()),
            Quantity::Speed(nm_per_min) => nm_per_min
                .over(Fraction {
                    num: step.num.checked_mul(60)?,
                    den: step.den,
                })
                .and_then(positive),
            _ => None,
        },
    )
}

/// Reports the rate of `key` if it is above that of `other`.
fn check_above(
    table: &mut Table<'_, '_>,
    [key, other]: [&'static str; 2],
    rates: [Option<u32>; 2],
    why: &str,
) {
    let [Some(rate), Some(limit)] = rates else {
        return;
    };
    if rate <= limit {
        return;
    }
    if let Some((_, span)) = table.value(key) {
        table.wrong(
            span,
            &format!("`{key}` is above `{other}`"),
            &format!("{rate} Hz, above {limit} Hz: {why}"),
        );
    }
}

/// A positive integer of 32 bits.
pub(super) fn positive(value: i64) -> Option<u32> {
    u32::try_from(value).ok().filter(|value| *value > 0)
}
