//! Several machines that work at once, each on its own link, and one report about them.

use super::action::Action;
use super::client::Client;
use husillo_sim::text::counted;
use std::fmt;
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
#[derive(Clone, Debug)]
pub struct Row {
    /// The action, as it is typed.
    pub action: String,
    /// When it was begun, seconds after the first one.
    pub began_s: f64,
    /// Its duration, seconds.
    pub took_s: f64,
    /// The result, or the reason of the failure.
    pub end: Result<String, String>,
}

/// A report of a machine at work.
#[derive(Clone, Debug)]
pub struct Said {
    /// Its number among the machines, from 0.
    pub machine: usize,
    /// Name of its port.
    pub port: String,
    /// A line of its device, or the end of an action.
    pub what: What,
}

/// A line of a device, or the end of an action.
#[derive(Clone, Debug)]
pub enum What {
    /// A line of the device.
    Report(String),
    /// An action that has ended.
    Action(Row),
}

impl fmt::Display for What {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Report(line) => write!(f, "  {line}"),
            Self::Action(Row {
                action,
                took_s,
                end,
                ..
            }) => match end {
                Ok(how) => write!(f, "{action}: {took_s:.1} s, {how}"),
                Err(error) => write!(f, "{action}: {took_s:.1} s, FAILED: {error}"),
            },
        }
    }
}

/// The record of one machine.
#[derive(Debug)]
pub struct Share {
    port: String,
    asked: usize,
    rows: Vec<Row>,
}

impl Share {
    /// Why the machine ended before its last action.
    fn error(&self) -> Option<&str> {
        self.rows.last()?.end.as_ref().err().map(String::as_str)
    }
}

/// Lets all machines carry out their actions at once. Passes each result to `tell` when it happens.
/// A failure of one machine does not stop the others.
///
/// # Errors
///
/// A thread has panicked.
pub fn work(workers: Vec<Worker>, mut tell: impl FnMut(&Said)) -> Result<Vec<Share>, String> {
    let (sender, said) = mpsc::channel();
    thread::scope(|scope| {
        let begun: Vec<_> = (workers.into_iter().enumerate())
            .map(|(machine, worker)| {
                let sender = sender.clone();
                scope.spawn(move || alone(worker, machine, &sender))
            })
            .collect();
        drop(sender);
        said.iter().for_each(|said| tell(&said));
        let ends = begun.into_iter().map(|machine| machine.join());
        ends.collect::<Result<_, _>>()
    })
    .map_err(|_| "the host's own fault".into())
}

/// Carries out the actions of one machine.
fn alone(worker: Worker, machine: usize, sender: &mpsc::Sender<Said>) -> Share {
    let Worker {
        port,
        mut client,
        actions,
    } = worker;
    let mut share = Share {
        port,
        asked: actions.len(),
        rows: Vec::new(),
    };
    for action in &actions {
        let began_s = client.elapsed().as_secs_f64();
        let end = client.carry_out(action);
        let row = Row {
            action: action.to_string(),
            began_s,
            took_s: client.elapsed().as_secs_f64() - began_s,
            end,
        };
        let reports = client.take_reports().into_iter().map(What::Report);
        for what in reports.chain([What::Action(row.clone())]) {
            let port = share.port.clone();
            // The receiver exists until all machines have ended.
            let _ = sender.send(Said {
                machine,
                port,
                what,
            });
        }
        let is_over = row.end.is_err();
        share.rows.push(row);
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
                Err(error) => format!("FAILED: {error}"),
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
            "{number}: {}: {done} of {}, {last:.1} s",
            share.port,
            counted(share.asked, "action")
        )?;
        match share.error() {
            None => writeln!(out)?,
            Some(error) => writeln!(out, ", then {error}")?,
        }
    }
    let well = shares
        .iter()
        .filter(|share| share.error().is_none())
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

/// The failures, each with the name of its port.
pub fn troubles(shares: &[Share]) -> impl Iterator<Item = (&str, &str)> {
    shares
        .iter()
        .filter_map(|share| Some((share.port.as_str(), share.error()?)))
}
