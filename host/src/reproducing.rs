//! The measured tables of the original machines, rebuilt.

mod microfactory;
mod micromill;

use crate::cli::Original;
use husillo_metrology::originals::Table;
use husillo_metrology::originals::cmm::repeatability;
use husillo_metrology::originals::drill::holes;
use husillo_reports::originals::Rebuilt;

/// Rebuilds all tables of a machine, or one of them.
///
/// # Errors
///
/// There is no such table, or a simulated machine refuses its work.
pub fn rebuild(machine: Original, table: Option<&str>) -> Result<Rebuilt, String> {
    match machine {
        Original::Cmm => alone("cmm", repeatability()?, table),
        Original::Drill => alone("drill", holes()?, table),
        Original::Microfactory => microfactory::rebuild(table),
        Original::Micromill => micromill::rebuild(table),
    }
}

/// The only table of a machine.
fn alone(machine: &'static str, only: Table, table: Option<&str>) -> Result<Rebuilt, String> {
    wanted(&[only.number], table)?;
    let mut rebuilt = Rebuilt::new(machine);
    rebuilt.tables.push(only);
    Ok(rebuilt)
}

/// The tables of a machine that are wanted.
fn wanted(numbers: &[&'static str], table: Option<&str>) -> Result<Vec<&'static str>, String> {
    let Some(table) = table else {
        return Ok(numbers.to_vec());
    };
    let found = numbers.iter().find(|number| **number == table);
    found
        .map(|number| vec![*number])
        .ok_or_else(|| format!("no table `{table}`: there are {}", numbers.join(", ")))
}
