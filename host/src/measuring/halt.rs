//! A stop of a measuring machine whose program was killed.

use super::port::ChainPort;
use super::{Stopped, error_text, machine_file};
use husillo_metrology::heads::Line;
use std::io::Write;

/// Stops all axes of a measuring machine at a port, resets nothing, and writes where they stand.
///
/// # Errors
///
/// [`Stopped`]: the port, or an axis that does not confirm.
pub fn halt(machine: &str, port: &str, out: &mut dyn Write) -> Result<(), Stopped> {
    let file = machine_file::load(machine).map_err(Stopped::File)?;
    let opened = ChainPort::open(port).map_err(|error| format!("{port}: {error}"))?;
    let positions = Line::new(opened).halt(&file).map_err(|trouble| {
        let advice = "the stop was sent and is not confirmed: be ready to switch off the machine";
        Stopped::Machine(format!("{}\n{port}: {advice}", error_text(&trouble)))
    })?;
    for (axis, counts) in file.axes.iter().zip(positions) {
        writeln!(out, "stop: {} at {counts} counts", axis.letter).map_err(Stopped::Output)?;
    }
    Ok(())
}
