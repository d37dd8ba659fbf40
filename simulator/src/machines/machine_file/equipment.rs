//! `[equipment]`, `[probe]` and `[[tool]]` of a machine file.

use crate::machines::table::Table;
use husillo_gcode::{Nm, Tool};
use husillo_machine::Equipment;
use husillo_metrology::quantity::{self, Quantity};
use husillo_sim::observers::AXES;

/// A probe, and what it touches in a simulation.
#[derive(Clone, Debug)]
pub struct Probe {
    /// Radius of the ball, nm.
    pub radius_nm: i64,
    /// Travel from the contact to the signal, nm.
    pub pre_travel_nm: i64,
    /// Whether reported positions are points of the surface instead of positions of the axes.
    pub corrects: bool,
    /// The sides of the simulated work piece in X, Y and Z, nm from work zero.
    pub piece: Option<[[i64; 2]; 3]>,
}

/// Reads `[equipment]`. A machine without this table has curves and no other equipment.
pub(super) fn equipment(table: &mut Table<'_, '_>) -> Equipment {
    let count = |table: &mut Table<'_, '_>, key| {
        let count = table.integer(key, 0..=64).unwrap_or(0);
        u8::try_from(count).unwrap_or(0)
    };
    Equipment {
        splines: table.flag("curves").unwrap_or(true),
        probe: false,
        digital_outputs: count(table, "digital_outputs"),
        analog_outputs: count(table, "analog_outputs"),
        digital_inputs: count(table, "digital_inputs"),
        analog_inputs: count(table, "analog_inputs"),
        spindle_angle: table.flag("spindle_angle").unwrap_or(false),
        surface_milli_rpm: table
            .integer("surface_speed_rpm", 1..=1_000_000)
            .and_then(|rpm| u32::try_from(rpm * 1000).ok()),
        tapping_overrun_turns: table
            .integer("tapping_overrun_turns", 0..=100)
            .and_then(|turns| u8::try_from(turns).ok()),
        adaptive_feed: table.flag("adaptive_feed").unwrap_or(false),
        pallets: table.flag("pallets").unwrap_or(false),
        heaters: false,
    }
}

/// The equipment of a machine without `[equipment]`.
pub(super) const PLAIN: Equipment = Equipment {
    splines: true,
    ..Equipment::NONE
};

/// Reads a length that is not negative.
fn length(table: &mut Table<'_, '_>, key: &str) -> Option<i64> {
    let accept = |quantity| match quantity {
        Quantity::Length(length) if length.num >= 0 => Some(length.rounded()),
        _ => None,
    };
    table.quantity(key, "a length as in \"2 mm\"", accept)
}

/// Reads `[probe]`.
pub(super) fn probe(table: &mut Table<'_, '_>) -> Probe {
    Probe {
        radius_nm: length(table, "radius").unwrap_or(0),
        pre_travel_nm: length(table, "pre_travel").unwrap_or(0),
        corrects: table.flag("correct").unwrap_or(false),
        piece: table.optional_table("piece", piece).flatten(),
    }
}

/// Reads `[probe.piece]`.
fn piece(table: &mut Table<'_, '_>) -> Option<[[i64; 2]; 3]> {
    Some([side(table, "x")?, side(table, "y")?, side(table, "z")?])
}

/// Reads `["0 mm", "20 mm"]`.
fn side(table: &mut Table<'_, '_>, key: &str) -> Option<[i64; 2]> {
    let Some((value, span)) = table.value(key) else {
        table.missing(key);
        return None;
    };
    let length = |value: &toml::de::DeValue<'_>| match quantity::parse(value.as_str()?) {
        Ok(Quantity::Length(length)) => Some(length.rounded()),
        _ => None,
    };
    let ends = value.as_array().and_then(|ends| {
        let (low, high) = (ends.first()?, ends.get(1)?);
        (ends.len() == 2).then_some([length(low.get_ref())?, length(high.get_ref())?])
    });
    let ends = ends.filter(|[low, high]| low < high);
    if ends.is_none() {
        let message = format!("`{key}` is not understood");
        table.wrong(span, &message, "expected [\"0 mm\", \"20 mm\"]");
    }
    ends
}

/// Reads one `[[tool]]`: its number and its data.
pub(super) fn tool(table: &mut Table<'_, '_>) -> Option<(u32, Tool<AXES>)> {
    let number = table.integer("number", 1..=99_999);
    if number.is_none() {
        table.missing("number");
    }
    let reach = length(table, "length").unwrap_or(0);
    let diameter = length(table, "diameter").unwrap_or(0);
    let tool = Tool {
        offset: [Nm(0), Nm(0), Nm(reach), Nm(0), Nm(0), Nm(0)],
        radius: Nm(diameter / 2),
    };
    Some((u32::try_from(number?).ok()?, tool))
}
