//! `husillo stop`: the program that holds the port stops its machine, then the machine itself gets
//! the stop.

use super::{ERRORS, Failure, OK, ended, jog, microfactory};
use crate::cli::{Jog, Stop};
use crate::console::reporter::Reporter;
use crate::measuring::{self, Stopped};

/// A port, and the machine at it.
struct Place {
    machine: Option<String>,
    port: String,
    baud: Option<u32>,
}

/// Stops every machine that `args` select.
///
/// # Errors
///
/// There is nothing to stop, or the command line is wrong.
pub(super) fn stop(args: &Stop, out: &mut Reporter<'_>) -> Result<u8, Failure> {
    let mut is_well = true;
    let mut places = released(args, &mut is_well, out);
    if let (true, Some(port)) = (places.is_empty() && is_well, &args.port) {
        if args.machine.is_none() {
            let why = "no running husillo has this port: name the machine at it with -m";
            return Err(Failure::Usage(format!("{port}: {why}")));
        }
        places.push(Place {
            machine: args.machine.clone(),
            port: port.clone(),
            baud: args.baud,
        });
    }
    if places.is_empty() && is_well {
        let which = args.machine.as_deref().unwrap_or("a machine");
        let why = "no running husillo of this user drives";
        return Err(Failure::Usage(format!(
            "{why} {which}: name its port with --port"
        )));
    }
    for place in places {
        is_well &= confirm(place, args, out)?;
    }
    Ok(if is_well { OK } else { ERRORS })
}

/// Sends the stop to the machine at a port that is free now. Returns whether it has confirmed it.
fn confirm(place: Place, args: &Stop, out: &mut Reporter<'_>) -> Result<bool, Failure> {
    let Place { port, baud, .. } = place;
    let Some(machine) = args.machine.clone().or(place.machine) else {
        return Ok(true);
    };
    let is_by_hand = machine == "drill"
        || super::grbl::is_grbl(Some(&machine))
        || super::milling::is_mill(&machine);
    if !is_by_hand && microfactory(&machine)?.is_none() {
        return match measuring::halt(&machine, &port, out) {
            Err(Stopped::Machine(message)) if out.is_json() => {
                out.failed(&port, &message);
                Ok(false)
            }
            halted => Ok(ended(halted)? == OK),
        };
    }
    let action = match !is_by_hand && args.emergency {
        true => "emergency",
        false => "stop",
    };
    let action = Jog {
        actions: vec![action.into()],
        // A machine that stands needs no lease.
        lease: Some(0),
        machine,
        port: vec![port.clone()],
        format: args.format,
        figure: None,
        baud: args.baud.or(baud),
        inch: false,
        without_answers: args.without_answers,
    };
    match jog(&action, out) {
        Ok(code) => Ok(code == OK),
        Err(Failure::Usage(message)) => {
            out.failed(&port, &message);
            Ok(false)
        }
        Err(failure) => Err(failure),
    }
}

/// Asks the programs that hold the ports to stop. Returns the ports that are free again. `is_well`
/// becomes `false` at a program that does not end.
#[cfg(unix)]
fn released(args: &Stop, is_well: &mut bool, out: &mut Reporter<'_>) -> Vec<Place> {
    use crate::console::sharing::machine_from_anywhere;
    use husillo_clients::holder::{Urgency, folder, holders};
    use std::time::Duration;
    /// A drill that is stopped completes its record first, within this time.
    const LONGEST: Duration = Duration::from_secs(180);
    let mut held = folder().map(|folder| holders(&folder)).unwrap_or_default();
    // The port alone decides: its machine may have another name there.
    held.retain(|held| match (&args.port, &args.machine) {
        (Some(port), _) => held.holds(port),
        (None, Some(machine)) => held.holder.machine == machine_from_anywhere(machine),
        (None, None) => true,
    });
    let urgency = match args.emergency {
        true => Urgency::Emergency,
        false => Urgency::Stop,
    };
    for held in &mut held {
        let holder = &held.holder;
        let text = format!("`husillo {}` (process {})", holder.command, holder.process);
        eprintln!("{}: {text} is stopping the machine", holder.port);
        out.object(&serde_json::json!({
            "kind": "holder",
            "port": holder.port,
            "machine": holder.machine,
            "command": holder.command,
            "process": holder.process,
        }));
        // A program that has ended meanwhile has released its port.
        let _ = held.ask(urgency);
    }
    let mut places = Vec::new();
    for mut held in held {
        let holder = held.holder.clone();
        if !held.has_ended(LONGEST) {
            let seconds = LONGEST.as_secs();
            let why = format!("it has not ended within {seconds} s: switch off the machine");
            out.failed(&holder.port, &why);
            *is_well = false;
            continue;
        }
        places.push(Place {
            machine: Some(holder.machine),
            port: holder.port,
            baud: Some(holder.bits_per_s),
        });
    }
    places
}

/// Programs do not share their ports on this system.
#[cfg(not(unix))]
fn released(_args: &Stop, _is_well: &mut bool, _out: &mut Reporter<'_>) -> Vec<Place> {
    Vec::new()
}
