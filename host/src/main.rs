//! The program `husillo`: check, simulate and draw G-code programs.
//!
//! ```text
//! file ─► source ─► program ─► check ─► diagnostics        (errors: nothing moves)
//!            │         └─────► commands
//!            ├─► format
//!            └─► feeder ─► steps
//!                   └────► run ─► deviation, drawing, speed ─► report, chart
//! one move, or grid ─► compare ─► method, curve, measure, decision ─► compare_text, compare_page
//! a measuring machine ─► cmm, tune
//! ```
#![forbid(unsafe_code)]

#[macro_use]
mod console;

mod app;
mod blocks;
mod bytes_file;
mod calibrate;
mod chart;
mod check;
mod cli;
mod cmm;
mod commands;
mod compare;
mod compare_page;
mod compare_picture;
mod compare_text;
mod curve;
mod decision;
mod deviation;
mod diagnostics;
mod drawing;
mod drill;
mod drill_code;
mod drill_file;
mod emulation;
mod encoder_file;
mod explain;
mod explain_flow;
mod feeder;
mod format;
mod grid;
mod holes;
mod input;
mod interpolate;
mod lash;
mod line;
mod machine_file;
mod machines;
mod measure;
mod method;
mod microfactory;
mod micromill;
mod mirror;
mod order;
mod output;
mod panel;
mod placement;
mod power;
mod program;
mod quantity;
mod report;
mod run;
mod setup;
mod source;
mod speed;
mod step_rows;
mod steps;
mod symmetry;
mod table;
#[cfg(unix)]
mod terminal;
mod tune;
mod turning;
mod turns;
mod wire;
mod zero;

use clap::Parser;
use std::process::ExitCode;

fn main() -> ExitCode {
    let cli = match cli::Cli::try_parse_from(cli::words(std::env::args_os())) {
        Ok(cli) => cli,
        Err(error) => return answered(&error),
    };
    match app::run(&cli) {
        Ok(code) => ExitCode::from(code),
        Err(app::Failure::Gone) => ExitCode::SUCCESS,
        Err(app::Failure::Usage(message)) => {
            eprintln!("husillo: {message}");
            ExitCode::from(2)
        }
    }
}

/// Help, or what is wrong with the command line. Colours only where all escapes in it are our own.
fn answered(error: &clap::Error) -> ExitCode {
    let is_hostile = |text: String| text.chars().any(console::is_obeyed);
    if std::env::args_os().any(|word| is_hostile(word.to_string_lossy().into_owned())) {
        eprintln!("{}", error.render().to_string().trim_end());
    } else {
        // Nobody to tell that it cannot be told.
        let _ = error.print();
    }
    ExitCode::from(u8::try_from(error.exit_code()).unwrap_or(2))
}
