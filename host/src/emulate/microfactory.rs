//! `husillo emulate microfactory`.

use super::terminal;
use crate::cli::Emulate;
use crate::microfactory::figure_of;
use husillo_clients::microfactory::{BAUD, Settings};
use husillo_sim::device::microfactory::Device;
use std::io::{self, Write};

/// Runs one or several microfactories. Their events go to `steps`, if it is given.
///
/// # Errors
///
/// The figure, the port, the file of steps or `out`, named in the error.
pub fn emulate(
    args: &Emulate,
    settings: &Settings,
    steps: Option<Box<dyn Write>>,
    out: &mut dyn Write,
) -> io::Result<()> {
    let figure = figure_of(args.figure.as_deref(), settings).map_err(io::Error::other)?;
    let baud = args.baud.unwrap_or(BAUD);
    let device = Device::new(
        settings.config,
        settings.table,
        settings.pull_out_ticks,
        &figure,
        !args.faithful,
        baud,
        args.machines,
    );
    let mut device = device.map_err(io::Error::other)?;
    if steps.is_some() {
        device = device.with_rows();
    }
    let hint = "husillo jog --port {port} home";
    terminal::serve(
        &mut device,
        args,
        steps,
        out,
        ["Microfactory", hint, &Device::panel()],
    )
}
