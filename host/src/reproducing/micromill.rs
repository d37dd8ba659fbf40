//! The tables of the micro mill.

use super::picture::Picture;
use super::{Rebuilt, wanted};
use crate::lash::SimulatedBench;
use crate::machines::machine_file::MachineFile;
use husillo_metrology::originals::micromill::{Screws, Settings, circles, lines, part, squares};

/// Numbers of its tables.
const NUMBERS: [&str; 8] = ["13", "14", "15", "16", "17", "18", "19", "20"];

/// Rebuilds the tables.
pub fn rebuild(table: Option<&str>) -> Result<Rebuilt, String> {
    let build = |settings: &Settings, screws: &Screws| {
        let file = MachineFile::load("micromill").map_err(|_| "micromill: its file is wrong")?;
        let bench = SimulatedBench::of_original(file, settings, screws)?;
        Ok(Box::new(bench) as Box<_>)
    };
    let mut rebuilt = Rebuilt::new("micromill");
    for number in wanted(&NUMBERS, table)? {
        match number {
            "13" => rebuilt.tables.push(lines(&build)?),
            "14" => rebuilt.tables.push(squares(&build)?),
            "15" => {
                let (table, made) = circles(&build)?;
                for (name, circles) in ["a", "b", "c"].into_iter().zip(&made) {
                    let picture = Picture::circle(name, circles, &table);
                    rebuilt.pictures.push((number, picture));
                }
                rebuilt.tables.push(table);
            }
            _ => rebuilt.tables.push(part(number, &build)?),
        }
    }
    Ok(rebuilt)
}
