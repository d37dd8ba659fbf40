//! Stops a measuring machine whose program was killed.

use super::memory_file::MemoryFile;
use super::port::NetworkPort;
use super::{Stopped, error_text, machine_file};
use crate::console::reporter::Reporter;
use husillo_metrology::heads::{Line, Machine};
use husillo_sim::text::position;
use husillo_transports::nmc::{Auxiliary, Reply};
use serde_json::json;

/// Stops all axes of a measuring machine at a port, and reports their positions. It resets nothing.
///
/// # Errors
///
/// [`Stopped`]: the port fails, or an axis does not confirm.
pub fn halt(machine: &str, port: &str, out: &mut Reporter<'_>) -> Result<(), Stopped> {
    let file = machine_file::load(machine).map_err(Stopped::File)?;
    let opened = NetworkPort::open(port).map_err(|error| format!("{port}: {error}"))?;
    let replies = Line::new(opened).halt(&file).map_err(|error| {
        let advice = "the stop was sent and is not confirmed: be ready to switch off the machine";
        Stopped::Machine(format!("{}\n{port}: {advice}", error_text(&error)))
    })?;
    keep(machine, port, &file, &replies);
    for (axis, reply) in file.axes.iter().zip(replies) {
        let counts = reply.readings.position;
        let letter = axis.letter;
        out.tell(
            format_args!("stop: {letter} at {}", position(counts, "count")),
            || json!({"kind": "axis", "port": port, "axis": letter, "position_counts": counts}),
        );
    }
    Ok(())
}

/// Keeps homes and zeros of a session that was killed, with the present positions of the axes. They
/// are still valid, because nothing was reset. A session that ended has kept its own.
fn keep(name: &str, port: &str, machine: &Machine, replies: &[Reply]) {
    let Some(file) = MemoryFile::at(name, port, machine) else {
        return;
    };
    let Some(mut memory) = file.read() else {
        return;
    };
    if !memory.in_use || memory.axes.len() != replies.len() {
        return;
    }
    memory.in_use = false;
    for (axis, reply) in memory.axes.iter_mut().zip(replies) {
        axis.counts = reply.readings.position;
        axis.latched = reply.readings.home;
        axis.is_held = reply.readings.auxiliary.contains(Auxiliary::SERVO_ON);
    }
    if let Err(error) = file.write(&memory) {
        eprintln!("warning: {port}: zero and home are not kept for the next command: {error}");
    }
}
