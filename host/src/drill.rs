//! The circuit-board drill: `husillo send`, `husillo jog -m drill` and `husillo emulate drill`.
//!
//! ```text
//! action ─► hand ──┐
//! parts ─► sender ─┴► client ─► wire ─┬─► device                    simulated time
//!                                     └─► serial, socket ─► device  real time
//! ```

mod manifest;
mod operator;
mod program;
#[cfg(test)]
mod tests;

pub use manifest::{
    file_names, load as load_manifest, load_records, name as manifest_name, text as manifest_text,
};
pub use program::{Translation, text as program_text};

use crate::cli::Jog;
use crate::console::reporter::{Reporter, action as action_object, report};
use crate::console::sharing::share;
use crate::console::stop::stop_requests;
use crate::holes;
use crate::output::Outputs;
use husillo_clients::drill::{
    Action, BAUD, Client, ClientError, End, Hand, Operator, Part, Place, Sender, sentence,
};
use husillo_simulator::text::name;
use husillo_transports::drill::Failure as LinkFailure;

/// Writes what `save` read back.
fn keep(file: &str, bytes: &[u8]) -> Result<(), String> {
    let mut outputs = Outputs::new();
    let written = outputs.write(file, bytes).and_then(|()| outputs.finish());
    written.map_err(|error| error.to_string())
}

/// `husillo jog -m drill`: carries out the actions one after the other.
///
/// # Errors
///
/// A sentence about the actions, before anything moves.
pub fn jog(args: &Jog, out: &mut Reporter<'_>) -> Result<bool, String> {
    let actions = Action::parse(&args.actions)?;
    let [port] = &args.port[..] else {
        return Err("a drill is driven alone: one --port".into());
    };
    if args.figure.is_some() {
        return Err("--figure is for the microfactory: a drill has no figures".into());
    }
    if args.without_answers {
        return Err("--without-answers is for the microfactory: a drill answers every byte".into());
    }
    let baud = args.baud.unwrap_or(BAUD);
    let mut client = open(port, baud, args.lease)?;
    share(&args.machine, port, baud);
    let reached = match actions.first() {
        Some(Action::Stop) => client.end_program(|longest| {
            let seconds = longest.as_secs();
            eprintln!(
                "{port}: the drill completes its present move or hole first: waiting at most \
                 {seconds} s for its answer"
            );
        }),
        _ => client.reach(),
    };
    if let (Err(error), [Action::Where]) = (&reached, &actions[..]) {
        let is_answer =
            *error == ClientError::AtWork || *error == ClientError::Link(LinkFailure::Fault);
        let place = Place::unknown(error);
        out.tell(&place, || {
            action_object(1, port, &Action::Where, 0.0, Ok(&place))
        });
        if is_answer {
            return Ok(true);
        }
    }
    if let Err(error) = reached {
        out.failed(port, &error.unreached());
        return Ok(false);
    }
    let mut hand = Hand::new(client, keep);
    for action in &actions {
        let start = hand.client().elapsed();
        let result = hand.carry_out(action);
        for line in hand.client().take_reports() {
            out.tell(format_args!("  {line}"), || report(1, port, &line));
        }
        let seconds = (hand.client().elapsed() - start).as_secs_f64();
        let end = result.as_deref().map_err(String::as_str);
        out.object(&action_object(1, port, action, seconds, end));
        match end {
            Ok("") => out.text(format_args!("{action}: {seconds:.1} s")),
            Ok(text) => out.text(format_args!("{action}: {seconds:.1} s\n{text}")),
            Err(sentence) => {
                if !out.is_json() {
                    eprintln!("error: {port}: {action}: {sentence}");
                }
                return Ok(false);
            }
        }
    }
    if let Err(sentence) = hand.end() {
        out.failed(port, &sentence);
        return Ok(false);
    }
    Ok(true)
}

/// Opens a port, with a lease where one is asked for.
fn open(port: &str, baud: u32, lease_ms: Option<u16>) -> Result<Client, String> {
    let client = Client::open(port, baud, stop_requests()?)?;
    Ok(match lease_ms {
        Some(lease_ms) => client.with_lease(lease_ms),
        None => client,
    })
}

/// `husillo send`.
///
/// # Errors
///
/// A sentence about what cannot be asked for, before anything moves.
pub fn send(
    args: &crate::cli::Send,
    parts: &[Part],
    out: &mut Reporter<'_>,
) -> Result<bool, String> {
    let (_, port) = args.alone()?;
    let baud = args.baud.unwrap_or(BAUD);
    // A drill that is to work alone has no lease.
    let lease_ms = if args.detach { Some(0) } else { args.lease };
    let client = open(port, baud, lease_ms)?;
    share(
        args.target.machine.as_deref().unwrap_or("drill"),
        port,
        baud,
    );
    let mut operator = operator::Console::new(out, port);
    let mut sender = Sender {
        client,
        operator: &mut operator,
        parts,
        from: args.from.unwrap_or(1) as usize - 1,
        // There and back, and what a computer takes between.
        byte_s: 20.0 / f64::from(baud) + 0.001,
        is_homed: args.no_home,
        is_sure: args.yes,
        diameter: holes::length,
    };
    let end = sender.send(args.detach)?;
    let all = parts.iter().map(Part::holes).sum();
    let again = again(std::env::args_os().skip(1).map(|word| name::text(&word)));
    let text = sentence(&end, &again, all);
    operator.close();
    match end {
        End::Failed(_) | End::Unreached(_) => {
            operator.out().failed(port, &text);
            Ok(false)
        }
        End::Drilled | End::Detached => {
            operator.show(&text);
            Ok(true)
        }
    }
}

/// The command line once more, without --from.
fn again(arguments: impl Iterator<Item = String>) -> String {
    let mut text = String::from("husillo");
    let mut is_number = false;
    for argument in arguments {
        let is_from = argument == "--from";
        if !is_from && !is_number && !argument.starts_with("--from=") {
            let is_plain = |c: char| c.is_ascii_alphanumeric() || "-_./:,=+@%".contains(c);
            if !argument.is_empty() && argument.chars().all(is_plain) {
                text = format!("{text} {argument}");
            } else {
                text = format!("{text} '{}'", argument.replace('\'', r"'\''"));
            }
        }
        is_number = is_from;
    }
    text
}
