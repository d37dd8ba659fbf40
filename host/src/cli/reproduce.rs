//! `husillo reproduce`.

use super::Page;
use clap::{Args, ValueEnum};

/// `husillo reproduce`.
#[derive(Debug, Args)]
pub struct Reproduce {
    /// Original machine
    #[arg(value_enum)]
    pub machine: Original,
    /// Number of a table, as in the description of the original [default: all of the machine]
    #[arg(value_name = "TABLE")]
    pub table: Option<String>,
    /// File to write; a page with pictures if it ends in .html, JSON if it ends in .json
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<String>,
    /// How to print the tables [default: by the name of the file; text]
    #[arg(long, value_enum)]
    pub format: Option<Page>,
}

/// The original machines.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Original {
    /// The micro mill
    Micromill,
    /// The measuring machine
    Cmm,
    /// The drill
    Drill,
    /// The microfactory
    Microfactory,
}

pub const REPRODUCE_HELP: &str = "\
Each row has the measured value, the value of the simulated machine with the settings of the
original, their difference, the spread of the measurement, and the value with the compensation of
today. A star marks a row whose difference is larger than its spread. Below each table are the
fitted parameters, and the reasons for differences that no simulation explains.

Examples:
  husillo reproduce micromill
  husillo reproduce micromill 15 -o circles.html
  husillo reproduce microfactory 4.3 --format json";
