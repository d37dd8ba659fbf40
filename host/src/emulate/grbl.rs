//! `husillo emulate grbl` and `husillo emulate grblhal`.

use super::terminal;
use crate::cli::Emulate;
use husillo_clients::grbl::BAUD;
use husillo_sim::device::grbl::Device;
use husillo_transports::grbl::Settings;
use std::io::{self, Write};

/// Runs a Grbl controller on a simulated mill. Its events go to `steps`, if it is given.
///
/// # Errors
///
/// The port, the file of steps or `out`, named in the error.
pub fn emulate(
    args: &Emulate,
    settings: Settings,
    steps: Option<Box<dyn Write>>,
    out: &mut dyn Write,
) -> io::Result<()> {
    let baud = args.baud.unwrap_or(BAUD);
    let is_hal = args.machine == "grblhal";
    let mut device = match is_hal {
        true => Device::grblhal(baud, settings),
        false => Device::new(baud, settings),
    };
    if steps.is_some() {
        device = device.with_rows();
    }
    let protocol = if is_hal { "grblHAL" } else { "Grbl 1.1" };
    let name = format!("{protocol}, {baud} baud,");
    let hint = "any sender of Grbl, at {port}";
    let panel = Device::panel();
    terminal::serve(&mut device, args, steps, out, [&name, hint, &panel])
}
