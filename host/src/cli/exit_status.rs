//! The exit statuses of the commands, in their help.

use super::Cli;
use clap::{Command, CommandFactory};

/// Bad command line or file.
const USAGE: &str = "2 bad command line or file";

/// The exit statuses of each command, between those that all have.
const STATUSES: [(&str, &str); 24] = [
    ("run", "1 the program has errors, or steps were lost"),
    (
        "check",
        "1 a program has errors, or with --deny-warnings warnings",
    ),
    (
        "format",
        "1 a program has errors, or with --check another form",
    ),
    ("commands", "1 the program has errors"),
    ("steps", "1 the program has errors"),
    ("holes", "1 the file has errors"),
    ("compile", "1 the program has errors, nothing is written"),
    (
        "send",
        "1 the program has errors, or the machine did not complete it",
    ),
    ("interpolate", ""),
    ("compare", "1 the program has errors"),
    ("explain", ""),
    ("schema", ""),
    ("completions", ""),
    ("man", ""),
    ("machines", ""),
    ("examples", ""),
    ("jog", "1 an action has failed"),
    ("stop", "1 a machine has not confirmed its stop"),
    (
        "measure",
        "1 out of tolerance, 3 error in measuring, 4 collision of the probe, 5 end switch",
    ),
    ("emulate", ""),
    ("serve", ""),
    ("tune", "1 the experiment has failed"),
    ("calibrate", "1 the machine has failed"),
    ("reproduce", ""),
];

/// The command line, with the exit statuses in the help of each command.
pub fn command() -> Command {
    let mut command = Cli::command();
    for (name, own) in STATUSES {
        let all = ["0 done", own, USAGE, "130 stopped by Ctrl-C"];
        let all: Vec<_> = all.into_iter().filter(|one| !one.is_empty()).collect();
        let status = format!("Exit status: {}", all.join(", "));
        command = command.mut_subcommand(name, |sub| with_status(sub, &status));
    }
    command
}

fn with_status(command: Command, status: &str) -> Command {
    let with = |help: Option<&clap::builder::StyledStr>| match help {
        Some(help) => format!("{help}\n\n{status}"),
        None => status.to_owned(),
    };
    let short = with(command.get_after_help());
    let long = command.get_after_long_help().map(|help| with(Some(help)));
    let names: Vec<String> = command
        .get_subcommands()
        .map(|below| below.get_name().to_owned())
        .collect();
    let mut command = command.after_help(short);
    if let Some(long) = long {
        command = command.after_long_help(long);
    }
    for name in names {
        command = command.mut_subcommand(name, |below| with_status(below, status));
    }
    command
}
