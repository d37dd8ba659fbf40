//! `husillo emulate micromill`.

use super::terminal;
use crate::cli::Emulate;
use husillo_clients::micromill::BAUD;
use husillo_sim::device::micromill::Device;
use std::io::{self, Write};

/// Runs the controller of the micro mill. Its events go to `steps`, if it is given.
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
    let mut device = Device::new(baud);
    if steps.is_some() {
        device = device.with_rows();
    }
    let name = format!("Micro mill, {baud} baud,");
    let hint = "husillo jog -m micromill --port {port} home";
    terminal::serve(
        &mut device,
        args,
        steps,
        out,
        [&name, hint, &Device::panel()],
    )
}
