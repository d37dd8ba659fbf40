//! The program `husillo`: check, simulate and draw G-code programs.
//!
//! ```text
//! file ─► source ─► gcode ─► machine ─► stepper ─► sim ─► run ─► report
//!                     │         └─► steps               (text, JSON, HTML)
//!                     ├─► commands
//!                     └─► check ─► diagnostics
//! ```
#![forbid(unsafe_code)]

mod cli;
mod diagnostics;
mod machine_file;
mod quantity;
mod source;
mod table;

use clap::Parser;

fn main() {
    let _ = cli::Cli::parse();
    let _ = machine_file::MachineFile::load("free");
}
