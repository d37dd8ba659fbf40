//! `[work]` of a machine file: the zeros of the work frames.

use crate::machines::table::Table;
use crate::programs::program::{Frames, WORK_FRAMES};
use husillo_gcode::{Axes, Nm};
use husillo_metrology::quantity::Quantity;
use husillo_sim::observers::AXES;

/// The names of the tables, in the order of the frames.
pub const NAMES: [&str; WORK_FRAMES] = [
    "g54", "g55", "g56", "g57", "g58", "g59", "g59_1", "g59_2", "g59_3",
];

/// Reads the tables, `[work.g54]` to `[work.g59_3]`, with a length or an angle for each axis. An
/// axis that is not named has its zero at machine zero.
pub(super) fn read(table: &mut Table<'_, '_>, axes: &Axes) -> Frames {
    NAMES.map(|name| table.optional_table(name, |frame| zero(frame, axes)))
}

fn zero(table: &mut Table<'_, '_>, axes: &Axes) -> [Nm; AXES] {
    let mut zero = [Nm(0); AXES];
    for ((axis, letter), zero) in axes.letters().enumerate().zip(&mut zero) {
        table.set_rotary(axes.is_rotary(axis));
        let key = char::from(letter).to_ascii_lowercase().to_string();
        let form = "a position as in \"20 mm\", of a rotary axis as in \"90 deg\"";
        let at = table.quantity(&key, form, |quantity| match quantity {
            Quantity::Length(length) => Some(Nm(length.rounded())),
            _ => None,
        });
        *zero = at.unwrap_or_default();
    }
    zero
}
