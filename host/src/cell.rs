//! The desktop microfactory: `husillo jog` and `husillo emulate microfactory`.
//!
//! ```text
//! action ─► client ─► wire ─┬─► device          simulated time
//!                           └─► serial, socket ─► device ◄─ terminal     real time
//! figure ─────────────────────► device
//! ```

mod action;
mod args;
mod client;
mod device;
mod figure;
mod wire;

pub use args::Jog;

use action::Action;
use client::Client;
use device::Device;
use std::io::Write;
use wire::Wire;

/// The figure of a device that was given none: the original's square with its diagonal, 1000 steps wide.
const FIGURE: [[i16; 2]; 5] = [[1000, 0], [0, 1000], [-1000, 0], [0, -1000], [1000, 1000]];

/// `husillo jog`: carries out the actions one after the other.
///
/// # Errors
///
/// A sentence about the action or the machine.
pub fn jog(args: &Jog, out: &mut dyn Write) -> Result<(), String> {
    let actions = Action::parse(&args.actions)?;
    let wire = if args.port == "sim" {
        Wire::simulated(Device::new(figure_of(args.figure.as_deref())?, true))
    } else {
        Wire::open(&args.port).map_err(|error| format!("{}: {error}", args.port))?
    };
    let mut client = Client::new(wire, !args.without_answers);
    for action in actions {
        let result = client.carry_out(&action);
        for line in client.told() {
            writeln!(out, "  {line}").map_err(|error| error.to_string())?;
        }
        let seconds = result?;
        writeln!(out, "{action}: {seconds:.1} s").map_err(|error| error.to_string())?;
    }
    Ok(())
}

fn figure_of(file: Option<&str>) -> Result<Vec<[i16; 2]>, String> {
    file.map_or_else(|| Ok(FIGURE.to_vec()), figure::load)
}

/// `husillo emulate microfactory`.
///
/// # Errors
///
/// A sentence about the figure or the terminal.
#[cfg(unix)]
pub fn emulate(args: &crate::cli::Emulate, out: &mut dyn Write) -> Result<(), String> {
    use crate::terminal::{self, Pace, Terminal};
    use std::path::Path;
    use std::time::Duration;

    let mut device = Device::new(figure_of(args.figure.as_deref())?, !args.faithful);
    let pace = Pace {
        speed: args.speed,
        limit: args.seconds.map(Duration::from_secs_f64),
        is_over: terminal::stop_flag()?,
    };
    let link = &args.link;
    Terminal::new(Path::new(link))
        .and_then(|mut terminal| {
            writeln!(
                out,
                "Microfactory at {link}; Ctrl-C ends it\nConnect: husillo jog --port {link} home\nPanel: {}",
                device::PANEL
            )?;
            out.flush()?;
            terminal.run(&mut device, &pace, out)
        })
        .map_err(|error| format!("{link}: {error}"))
}
