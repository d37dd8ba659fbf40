//! `husillo calibrate`: what measurements say of a machine, as lines for its file.

pub mod columns;

use clap::{Args, Subcommand};

/// `husillo calibrate`.
#[derive(Debug, Args)]
pub struct Calibrate {
    /// What is calibrated.
    #[command(subcommand)]
    pub what: What,
}

/// What is calibrated.
#[derive(Debug, Subcommand)]
pub enum What {
    /// Scale and pitch errors of one axis, from reference lengths
    #[command(after_help = AXIS_HELP)]
    Axis(AxisArgs),
    /// Angles between the axes, from a bar laid along diagonals
    #[command(after_help = SQUARENESS_HELP)]
    Squareness(SquarenessArgs),
}

/// `husillo calibrate axis`.
#[derive(Debug, Args)]
pub struct AxisArgs {
    /// Readings as CSV; - is standard input
    #[arg(value_name = "READINGS.csv")]
    pub file: String,
    /// Measuring machine: cmm3, or a TOML file with a `count`
    #[arg(short, long, value_name = "NAME|FILE", default_value = "cmm3")]
    pub machine: String,
    /// Axis the lengths lie along
    #[arg(long, value_name = "X|Y|Z", default_value_t = 'x')]
    pub axis: char,
    /// Only the scale, whatever is left of the errors
    #[arg(long)]
    pub no_table: bool,
}

/// `husillo calibrate squareness`.
#[derive(Debug, Args)]
pub struct SquarenessArgs {
    /// Ends of the bar as CSV; - is standard input
    #[arg(value_name = "ENDS.csv")]
    pub file: String,
    /// Measuring machine: cmm3, or a TOML file with a `count`
    #[arg(short, long, value_name = "NAME|FILE", default_value = "cmm3")]
    pub machine: String,
    /// Length of the bar, where it is known [default: the one that fits best]
    #[arg(long, value_name = "LENGTH")]
    pub length: Option<String>,
}

const AXIS_HELP: &str = "\
READINGS.csv has a heading and one reading a line: nominal, reading, and if it matters direction, + or -, in which the
place was reached; in mm, or with a unit. The nominal lengths are those of a step gauge, of gauge blocks or of a laser, the readings what
`husillo measure` printed with this machine file: what the file has of a calibration already is taken off first, so that
the result replaces it. Several passes are averaged, each direction by itself (as in ISO 230-2). Where the length begins does
not matter, but a table belongs to the place of the travel: it needs an axis that is at the same place at every reset.

The result are lines for the machine file, on standard output:
  scale   what the true way is longer than the reading
  table   what is left then: reading, and its correction after a positive and after a negative way; left out where the readings
          are not better than that

Example:
  husillo calibrate axis -m cmm3 --axis x gauge.csv >> mine.toml";

const SQUARENESS_HELP: &str = "\
ENDS.csv has a heading and a place of the bar a line: x1,y1,z1,x2,y2,z2, the centres of its two balls in mm (of two axes
x1,y1,x2,y2). Lay the same bar along both diagonals of each plane, as long as the travel allows, more often for less noise: were
the axes square, it would be equally long everywhere (ball bar of ASME B89.4.1, diagonals of ISO 230-6). Calibrate the
axes first: the readings are what `husillo measure` prints with this machine file; a squareness it has already is taken
off first.

The result are lines for the machine file: by how much X grows for a way along Y (xy) and along Z (xz), and Y along Z (yz).

Example:
  husillo calibrate squareness -m mine.toml bar.csv >> mine.toml";
