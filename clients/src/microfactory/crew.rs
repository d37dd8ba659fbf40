//! Several machines at work at once, each on its own link, and one report about them.

use super::action::Action;
use super::client::Client;
use std::io::{self, Write};
use std::sync::mpsc;
use std::thread;

/// One machine and its actions.
#[derive(Debug)]
pub struct Worker {
    /// Name of its port.
    pub port: String,
    /// The client of the machine.
    pub client: Client,
    /// Its actions.
    pub actions: Vec<Action>,
}

/// An action that was begun.
#[derive(Debug)]
pub struct Row {
    action: String,
    began_s: f64,
    took_s: f64,
    /// The result, or the reason of the failure.
    end: Result<String, String>,
}

/// Record of one machine.
#[derive(Debug)]
pub struct Share {
    port: String,
    asked: usize,
    rows: Vec<Row>,
}

impl Share {
    /// Why it ended before its last action.
    fn trouble(&self) -> Option<&str> {
        self.rows.last()?.end.as_ref().err().map(String::as_str)
    }
}

/// Lets all machines carry out their actions at once. Prints each result to `out` when it happens.
/// A failure of one machine does not stop the others.
///
/// # Errors
///
/// A thread has panicked.
pub fn work(workers: Vec<Worker>, out: &mut dyn Write) -> Result<Vec<Share>, String> {
    let is_alone = workers.len() == 1;
    let (sender, lines) = mpsc::channel();
    thread::scope(|scope| {
        let begun: Vec<_> = (workers.into_iter().enumerate())
            .map(|(machine, worker)| {
                let sender = sender.clone();
                scope.spawn(move || alone(worker, machine, &sender))
            })
            .collect();
        drop(sender);
        for (machine, line) in lines {
            let name = if is_alone {
                String::new()
            } else {
                format!("{}: ", machine + 1)
            };
            // Machines go on when the reader of the output has gone.
            let _ = writeln!(out, "{name}{line}").and_then(|()| out.flush());
        }
        let ends = begun.into_iter().map(|machine| machine.join());
        ends.collect::<Result<_, _>>()
    })
    .map_err(|_| "the host's own fault".into())
}

/// Carries out the actions of one machine.
fn alone(worker: Worker, machine: usize, sender: &mpsc::Sender<(usize, String)>) -> Share {
    let Worker {
        port,
        mut client,
        actions,
    } = worker;
    let tell = |line| {
        // The receiver exists until all machines have ended.
        let _ = sender.send((machine, line));
    };
    let mut share = Share {
        port,
        asked: actions.len(),
        rows: Vec::new(),
    };
    for action in &actions {
        let began_s = client.elapsed().as_secs_f64();
        let end = client.carry_out(action);
        let took_s = client.elapsed().as_secs_f64() - began_s;
        for line in client.take_reports() {
            tell(format!("  {line}"));
        }
        tell(match &end {
            Ok(how) => format!("{action}: {took_s:.1} s, {how}"),
            Err(trouble) => format!("{action}: {took_s:.1} s, FAILED: {trouble}"),
        });
        let is_over = end.is_err();
        share.rows.push(Row {
            action: action.to_string(),
            began_s,
            took_s,
            end,
        });
        if is_over {
            break;
        }
    }
    share
}

/// Prints the report: the actions of each machine, their times and how they ended. Returns whether
/// all succeeded.
///
/// # Errors
///
/// Writing failed.
pub fn report(shares: &[Share], out: &mut dyn Write) -> io::Result<bool> {
    let width = |name: fn(&Share) -> usize| shares.iter().map(name).max().unwrap_or(0);
    let ports = width(|share| share.port.chars().count()).max(4);
    let actions = width(|share| {
        let names = share.rows.iter().map(|row| row.action.chars().count());
        names.max().unwrap_or(0)
    })
    .max(6);
    writeln!(
        out,
        "\nmachine  {:ports$}  {:actions$}  {:>8}  {:>8}  ended",
        "port", "action", "began s", "took s"
    )?;
    for (number, share) in (1..).zip(shares) {
        for row in &share.rows {
            let end = match &row.end {
                Ok(how) => how.clone(),
                Err(trouble) => format!("FAILED: {trouble}"),
            };
            writeln!(
                out,
                "{number:>7}  {:ports$}  {:actions$}  {:>8.1}  {:>8.1}  {end}",
                share.port, row.action, row.began_s, row.took_s
            )?;
        }
    }
    for (number, share) in (1..).zip(shares) {
        let done = share.rows.iter().filter(|row| row.end.is_ok()).count();
        let last = share
            .rows
            .last()
            .map_or(0.0, |row| row.began_s + row.took_s);
        write!(
            out,
            "{number}: {}: {done} of {} actions, {last:.1} s",
            share.port, share.asked
        )?;
        match share.trouble() {
            None => writeln!(out)?,
            Some(trouble) => writeln!(out, ", then {trouble}")?,
        }
    }
    let well = shares
        .iter()
        .filter(|share| share.trouble().is_none())
        .count();
    if shares.len() > 1 {
        writeln!(
            out,
            "{well} of {} machines completed all actions",
            shares.len()
        )?;
    }
    Ok(well == shares.len())
}

/// Prints the failure of each machine on standard error. Returns whether there is none.
pub fn is_well(shares: &[Share]) -> bool {
    for share in shares {
        if let Some(trouble) = share.trouble() {
            eprintln!("error: {}: {trouble}", share.port);
        }
    }
    shares.iter().all(|share| share.trouble().is_none())
}
