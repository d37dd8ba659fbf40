//! `[motion]` of a machine file.

use crate::machines::table::Table;
use husillo_metrology::quantity::Quantity;

/// Limits of the path.
#[derive(Default)]
pub struct Motion {
    /// Path speed of rapid moves, nm/min.
    pub rapid: Option<i64>,
    /// Largest path speed of feed moves, nm/min.
    pub top_feed: Option<i64>,
    /// Largest difference of the two radii of an arc, nm.
    pub arc_tolerance: Option<i64>,
    /// Largest distance from a corner to the circle that limits the speed there, nm.
    pub corner_deviation: Option<i64>,
    /// Axes that may move at once.
    pub simultaneous_axes: Option<u32>,
}

impl Motion {
    /// Reads the table.
    pub(super) fn read(table: &mut Table<'_, '_>) -> Self {
        let speed = |table: &mut Table<'_, '_>, key| {
            table.quantity(
                key,
                "a speed as in \"6000 mm/min\"",
                |quantity| match quantity {
                    Quantity::Speed(speed) if speed.num > 0 => Some(speed.rounded()),
                    _ => None,
                },
            )
        };
        let length = |table: &mut Table<'_, '_>, key| {
            table.quantity(
                key,
                "a length as in \"0.28 um\"",
                |quantity| match quantity {
                    Quantity::Length(length) if length.num >= 0 => Some(length.rounded()),
                    _ => None,
                },
            )
        };
        Self {
            rapid: speed(table, "rapid"),
            top_feed: speed(table, "top_feed"),
            arc_tolerance: length(table, "arc_tolerance"),
            corner_deviation: length(table, "corner_deviation"),
            simultaneous_axes: table
                .integer("simultaneous_axes", 1..=6)
                .and_then(|n| u32::try_from(n).ok()),
        }
    }
}
