//! The program `husillo`: check, simulate and draw G-code programs.
//!
//! | folder | content |
//! | --- | --- |
//! | `cli`, `app` | the options, and the command that each starts |
//! | `methods` | interpolation methods: options, texts and pages |
//! | `holes` | drill files: options, findings and lists |
//! | `measuring` | the measuring machine and its errors |
//! | `backlash`, `tuning` | backlash by position; servo axes |
//! | `reproducing` | the measured tables of the original machines |
//! | `micromill`, `drill`, `microfactory` | programs and commands for these machines |
//! | `console` | the terminal: what is shown, typed lines, Ctrl-C |
//! | `emulate` | simulated controllers behind a port |
//! | `serve` | machines operated from a browser |
//!
//! The crate `husillo_simulator` reads programs and machine files, checks them, and simulates.
#![forbid(unsafe_code)]

#[macro_use]
mod console;

mod app;
mod backlash;
mod by_hand;
mod cli;
mod drill;
#[cfg(unix)]
mod emulate;
mod grbl;
mod holes;
mod input;
mod measuring;
mod methods;
mod microfactory;
mod micromill;
mod output;
mod reproducing;
mod serve;
mod tuning;

use clap::FromArgMatches;
use husillo_simulator::text::json::write_line;
use std::ffi::OsString;
use std::io::{self, Write as _};
use std::process::ExitCode;

fn main() -> ExitCode {
    let words = cli::words(std::env::args_os());
    let parsed = cli::command().try_get_matches_from(words);
    let cli = match parsed.and_then(|matches| cli::Cli::from_arg_matches(&matches)) {
        Ok(cli) => cli,
        Err(error) => return answered(&error),
    };
    let ended = app::run(&cli).and_then(|code| {
        console::flush()?;
        Ok(code)
    });
    console::sharing::end();
    match ended {
        Ok(code) => ExitCode::from(code),
        Err(app::Failure::Gone) => ExitCode::SUCCESS,
        Err(app::Failure::Usage(message)) => {
            if wants_json() {
                let body = serde_json::json!({"message": message});
                // The message follows, whatever becomes of this one.
                let _ = write_line("husillo.error/1", &body, &mut console::stdout());
            }
            eprintln!("error: {message}");
            ExitCode::from(2)
        }
    }
}

/// Whether the command line asks for JSON.
fn wants_json() -> bool {
    let words: Vec<_> = std::env::args_os().collect();
    let is_asked = |pair: &[OsString]| pair[0] == "--format" && pair[1] == "json";
    words.contains(&"--format=json".into()) || words.windows(2).any(is_asked)
}

/// Help, or what is wrong with the command line. Colours only where all escapes in it are our own.
fn answered(error: &clap::Error) -> ExitCode {
    let is_hostile = |text: String| {
        text.chars().any(console::is_obeyed) || text.len() != console::cut(&text).len()
    };
    let text = error.render();
    if std::env::args_os().any(|word| is_hostile(word.to_string_lossy().into_owned())) {
        eprintln!("{}", text.to_string().trim_end());
        return ExitCode::from(2);
    }
    let drawn = |is_coloured: bool| match is_coloured {
        true => text.ansi().to_string(),
        false => text.to_string(),
    };
    // An error of the terminal cannot be reported on it.
    let _ = if error.use_stderr() {
        let mut out = io::stderr();
        writeln!(out, "{}", drawn(console::is_coloured(&out)).trim_end())
    } else {
        let mut out = io::stdout();
        writeln!(out, "{}", drawn(console::is_coloured(&out)).trim_end())
    };
    ExitCode::from(u8::try_from(error.exit_code()).unwrap_or(2))
}
