//! The simulated motor of an axis in the machine file of a measuring machine.

use husillo_metrology::simulated::DcMotorModel;
use husillo_simulator::machines::table::Table;
use std::ops::RangeInclusive;

/// Reads `[axis.x.motor]`. Missing keys have the values of the prototype.
pub fn read(axis: &mut Table<'_, '_>) -> DcMotorModel {
    let motor = axis.optional_table("motor", |table| {
        let old = DcMotorModel::PROTOTYPE;
        let motor = DcMotorModel {
            supply_v: number(table, "supply_v", old.supply_v, 0.1..=1000.0),
            resistance_ohm: number(table, "resistance_ohm", old.resistance_ohm, 0.01..=10_000.0),
            inductance_h: 1e-3
                * number(
                    table,
                    "inductance_mh",
                    old.inductance_h * 1e3,
                    0.001..=10_000.0,
                ),
            constant_nm_per_a: number(
                table,
                "torque_nm_per_a",
                old.constant_nm_per_a,
                1e-6..=1000.0,
            ),
            inertia_kg_m2: number(table, "inertia_kg_m2", old.inertia_kg_m2, 1e-9..=1000.0),
            viscous_nm_s: number(table, "viscous_nm_s", old.viscous_nm_s, 0.0..=1000.0),
            coulomb_nm: number(table, "coulomb_nm", old.coulomb_nm, 0.0..=1000.0),
            stiction_nm: number(table, "stiction_nm", old.stiction_nm, 0.0..=1000.0),
            counts_per_revolution: whole(
                table,
                "counts_per_revolution",
                old.counts_per_revolution,
                1,
            ),
            index_counts: whole(table, "index_counts", old.index_counts, 0),
        };
        if motor.stiction_nm < motor.coulomb_nm {
            let key = ["stiction_nm", "coulomb_nm"].map(|key| table.value(key));
            if let Some((_, span)) = key.into_iter().flatten().next() {
                let label = "`stiction_nm` is at least `coulomb_nm`";
                table.wrong(
                    span,
                    "the friction is larger than the breakaway torque",
                    label,
                );
            }
        }
        motor
    });
    motor.unwrap_or(DcMotorModel::PROTOTYPE)
}

/// Reads a number within a range, if it is there.
fn number(
    table: &mut Table<'_, '_>,
    key: &'static str,
    default: f64,
    range: RangeInclusive<f64>,
) -> f64 {
    let number = table
        .value(key)
        .is_some()
        .then(|| table.required_number(key, range));
    number.flatten().unwrap_or(default)
}

/// Reads counts, if they are there.
fn whole(table: &mut Table<'_, '_>, key: &'static str, default: u32, least: i64) -> u32 {
    let number = table.integer(key, least..=10_000_000);
    let number = number.and_then(|number| u32::try_from(number).ok());
    number.unwrap_or(default)
}
