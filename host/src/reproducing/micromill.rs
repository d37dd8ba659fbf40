//! The tables of the micro mill.

use super::wanted;
use crate::backlash::SimulatedBench;
use husillo_metrology::originals::micromill::{
    Screws, Settings, Shop, circles, interpolators, lines, marks, part, power_chips, sequences,
    squares, supply,
};
use husillo_reports::originals::{Picture, Rebuilt};
use husillo_simulator::machines::machine_file::MachineFile;

/// Numbers of its tables.
const NUMBERS: [&str; 13] = [
    "7", "9", "10", "12", "13", "14", "15", "16", "17", "18", "19", "20", "supply",
];

/// Rebuilds the tables.
pub fn rebuild(table: Option<&str>) -> Result<Rebuilt, String> {
    let build = |settings: &Settings, screws: &Screws| {
        let file = MachineFile::built_in("micromill").ok_or("micromill: its file is wrong")?;
        let bench = SimulatedBench::of_original(file, settings, screws)?;
        Ok(Box::new(bench) as Box<_>)
    };
    let shop = Shop::new(&build)?;
    let mut rebuilt = Rebuilt::new("micromill");
    for number in wanted(&NUMBERS, table)? {
        match number {
            "7" => rebuilt.tables.push(interpolators()?),
            "9" => rebuilt.tables.push(marks()?),
            "10" => rebuilt.tables.push(sequences()?),
            "12" => rebuilt.tables.push(power_chips()),
            "13" => rebuilt.tables.push(lines(&shop)?),
            "14" => rebuilt.tables.push(squares(&shop)?),
            "supply" => rebuilt.tables.push(supply()),
            "15" => {
                let (table, made) = circles(&shop)?;
                for (name, circles) in ["a", "b", "c"].into_iter().zip(&made) {
                    let picture = Picture::circle(name, circles, &table);
                    rebuilt.pictures.push((number, picture));
                }
                rebuilt.tables.push(table);
            }
            _ => rebuilt.tables.push(part(number, &shop)?),
        }
    }
    Ok(rebuilt)
}
