//! `husillo emulate` for a measuring machine.

use super::{Stopped, machine_file, module_list, mounted};
use crate::cli::Emulate;
use crate::emulate::terminal;
use husillo_metrology::simulated::{IO_PANEL, NetworkModule, PANEL, SimulatedNetwork};
use husillo_sim::text::counted;
use std::io::{ErrorKind, Write};

/// Runs the network of a machine until it is stopped.
///
/// # Errors
///
/// [`Stopped`].
pub fn emulate(args: &Emulate, out: &mut dyn Write) -> Result<(), Stopped> {
    let machine = machine_file::load(&args.machine).map_err(Stopped::File)?;
    let piece = mounted(args.piece.as_deref(), &machine)?;
    let motor = |address| machine.motor(address);
    let modules = match &args.modules {
        Some(list) => Some(module_list::modules(list, motor)?),
        None => None,
    };
    let emulated = match &modules {
        Some(modules) => SimulatedNetwork::of_modules(modules, &args.contact, piece)?,
        None => SimulatedNetwork::of_machine(&machine, &args.contact, piece)?,
    };
    let emulated = emulated.with_ends(&args.end)?;
    let mut emulated = emulated.with_noise(args.noise).with_reset_ms(args.reset_ms);
    if args.fast {
        emulated = emulated.without_byte_times();
    }
    let count = modules.as_ref().map_or(machine.modules().into(), Vec::len);
    let modules_text = counted(count, "module");
    let name = format!("{}: {modules_text}", machine.title);
    let hint = format!("husillo measure -m {} --port {{port}} status", args.machine);
    let is_io = |module: &NetworkModule| matches!(module, NetworkModule::Io { .. });
    let has_io = modules.iter().flatten().any(is_io);
    let panel = if has_io {
        format!("{PANEL}, {IO_PANEL}")
    } else {
        PANEL.to_owned()
    };
    let heading = [&name[..], &hint, &panel];
    terminal::serve(&mut emulated, args, None, out, heading).map_err(|error| match error.kind() {
        ErrorKind::BrokenPipe => Stopped::Output(error),
        _ => Stopped::Machine(format!("error: {error}")),
    })
}
