//! `husillo emulate drill`.

use super::terminal;
use crate::cli::Emulate;
use husillo_clients::drill::BAUD;
use husillo_sim::device::drill::Device;
use std::io::{self, Write};

/// Runs the controller of the drill. Its events go to `steps`, if it is given.
///
/// # Errors
///
/// The port, the file of steps or `out`, named in the error.
pub fn emulate(
    args: &Emulate,
    steps: Option<Box<dyn Write>>,
    out: &mut dyn Write,
) -> io::Result<()> {
    let baud = args.baud.unwrap_or(BAUD);
    let mut device = Device::new(baud, args.faithful);
    if steps.is_some() {
        device = device.with_rows();
    }
    let name = format!("Drill, {baud} baud,");
    let hint = "husillo send board.drl -m drill --port {port}";
    terminal::serve(
        &mut device,
        args,
        steps,
        out,
        [&name, hint, &Device::panel()],
    )
}
