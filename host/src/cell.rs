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

pub use args::Jog;

use crate::wire::Wire;
use action::Action;
use client::Client;
use device::Device;
use std::io::Write;
use std::sync::mpsc;
use std::thread;

/// Bits a second of the link.
const BAUD: u32 = 9600;
/// The figure of a device that was given none: the original's square with its diagonal, 1000 steps wide.
const FIGURE: [[i16; 2]; 5] = [[1000, 0], [0, 1000], [-1000, 0], [0, -1000], [1000, 1000]];

/// `husillo jog`: carries out the actions one after the other, on every machine at once.
///
/// # Errors
///
/// A sentence about the actions, before anything moves.
pub fn jog(args: &Jog, out: &mut dyn Write) -> Result<bool, String> {
    let ports: Vec<&str> = args.port.iter().map(String::as_str).collect();
    let shares = action::shares(&args.actions, ports.len())?;
    let mut machines = Vec::new();
    for port in &ports {
        let wire = if *port == "sim" {
            Wire::simulated(Device::new(figure_of(args.figure.as_deref())?, true))
        } else {
            Wire::open(port, BAUD).map_err(|error| format!("{port}: {error}"))?
        };
        machines.push(Client::new(wire, !args.without_answers));
    }
    let (teller, told) = mpsc::channel();
    let ends = thread::scope(|scope| {
        let begun: Vec<_> = (machines.into_iter().zip(&shares).enumerate())
            .map(|(machine, (client, actions))| {
                let teller = teller.clone();
                scope.spawn(move || work(client, actions, machine, &teller))
            })
            .collect();
        drop(teller);
        for (machine, line) in told {
            let name = if ports.len() > 1 {
                format!("{}: ", machine + 1)
            } else {
                String::new()
            };
            // A reader that has gone away does not stop machines.
            let _ = writeln!(out, "{name}{line}").and_then(|()| out.flush());
        }
        let ends = begun.into_iter().map(|machine| machine.join());
        ends.collect::<Vec<_>>()
    });
    let mut is_well = true;
    for ((port, end), actions) in ports.iter().zip(ends).zip(&shares) {
        let end = end.map_err(|_| format!("{port}: the host's own fault"))?;
        let count = actions.len();
        let line = match &end.trouble {
            None => format!("{port}: {count} of {count} actions, {:.1} s", end.seconds),
            Some(trouble) => {
                is_well = false;
                format!("{port}: {} of {count} actions, then {trouble}", end.actions)
            }
        };
        if ports.len() > 1 {
            writeln!(out, "{line}").map_err(|error| error.to_string())?;
        }
        if let Some(trouble) = end.trouble {
            eprintln!("error: {port}: {trouble}");
        }
    }
    Ok(is_well)
}

/// How a machine's share ended.
struct End {
    /// Actions carried out.
    actions: usize,
    seconds: f64,
    trouble: Option<String>,
}

/// Carries out the actions of one machine; what happens is told as it does.
fn work(
    mut client: Client,
    actions: &[Action],
    machine: usize,
    teller: &mpsc::Sender<(usize, String)>,
) -> End {
    let mut end = End {
        actions: 0,
        seconds: 0.0,
        trouble: None,
    };
    let tell = |line| {
        // The other end is there until all machines have ended.
        let _ = teller.send((machine, line));
    };
    for action in actions {
        let result = client.carry_out(action);
        for line in client.told() {
            tell(format!("  {line}"));
        }
        match result {
            Ok(seconds) => {
                end.actions += 1;
                end.seconds += seconds;
                tell(format!("{action}: {seconds:.1} s"));
            }
            Err(trouble) => {
                end.trouble = Some(trouble);
                break;
            }
        }
    }
    end
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
