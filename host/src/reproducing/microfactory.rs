//! The tables of the microfactory.

use super::wanted;
use husillo_metrology::originals::microfactory::{
    Coils, consumption, current, other_systems, rates, temperatures,
};
use husillo_reports::originals::{Picture, Rebuilt};

/// Numbers of its tables.
const NUMBERS: [&str; 5] = ["4.1", "4.2", "4.3", "4.4", "4.5"];

/// Rebuilds the tables.
pub fn rebuild(table: Option<&str>) -> Result<Rebuilt, String> {
    let mut rebuilt = Rebuilt::new("microfactory");
    for number in wanted(&NUMBERS, table)? {
        rebuilt.tables.push(match number {
            "4.1" => rates()?,
            "4.2" => temperatures(),
            "4.3" => {
                let table = current();
                let coils = Coils::fitted();
                let curve = |clock_hz| coils.amperes(clock_hz);
                let picture = Picture::curve(&table, curve);
                rebuilt.pictures.push((number, picture));
                table
            }
            "4.4" => other_systems(),
            _ => consumption(),
        });
    }
    Ok(rebuilt)
}
