//! `husillo calibrate`: its arguments.

use super::Output;
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
    /// Backlash by position, from lines cut in pairs
    #[command(after_help = BACKLASH_HELP)]
    Backlash(BacklashArgs),
    /// Remaining backlash at the ends of circles, next to the values measured on the original
    Circles(CirclesArgs),
}

/// `husillo calibrate backlash`.
#[derive(Debug, Args)]
pub struct BacklashArgs {
    /// Readings as CSV; - is standard input
    #[arg(
        value_name = "READINGS.csv",
        required_unless_present = "simulate",
        conflicts_with = "simulate"
    )]
    pub file: Option<String>,
    /// Machine that cut the lines: a name, or a TOML file
    #[arg(short, long, value_name = "NAME|FILE", default_value = "micromill")]
    pub machine: String,
    /// Cut and measure the lines on the simulated machine, with the backlash of simulated_backlash
    #[arg(long)]
    pub simulate: bool,
    /// With --simulate: largest distance between two positions
    #[arg(long, value_name = "LENGTH", default_value = "0.5 mm")]
    pub every: String,
    /// The lines were cut without any take-up
    #[arg(long)]
    pub uncompensated: bool,
    /// How to print the map
    #[arg(long, value_enum, default_value = "text")]
    pub format: Output,
    /// Machine file to write: this one with the map in it
    #[arg(short, long, value_name = "MACHINE.toml")]
    pub output: Option<String>,
    /// Report to write: one value per axis compared with the map
    #[arg(long, value_name = "REPORT.html")]
    pub report: Option<String>,
}

/// `husillo calibrate circles`.
#[derive(Debug, Args)]
pub struct CirclesArgs {
    /// Machine with a table simulated_backlash: a name, or a TOML file
    #[arg(short, long, value_name = "NAME|FILE", default_value = "micromill")]
    pub machine: String,
    /// How to print the values
    #[arg(long, value_enum, default_value = "text")]
    pub format: Output,
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
    /// How to print the result
    #[arg(long, value_enum, default_value = "text")]
    pub format: Output,
    /// Find only the scale, whatever errors remain
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
    /// How to print the result
    #[arg(long, value_enum, default_value = "text")]
    pub format: Output,
    /// Length of the bar, if it is known [default: the one that fits best]
    #[arg(long, value_name = "LENGTH")]
    pub length: Option<String>,
}

const AXIS_HELP: &str = "\
READINGS.csv has a heading and one reading per line. Its columns are nominal, reading and, if it
matters, direction: + or -, the direction in which the position was reached. Lengths are in mm, or
have a unit. The nominal lengths are those of a step gauge, of gauge blocks or of a laser. The
readings are those that `husillo measure` prints with this machine file. A calibration that the file
already has is removed from the readings first, so the result replaces it. Several passes are
averaged, separately for each direction (as in ISO 230-2). The origin of the lengths does not
matter. A table is valid for one part of the travel, so the axis must be at the same position after
every reset.

The result is lines for the machine file, on standard output:
  scale   true distance minus reading, per distance
  table   the remaining errors: the reading, and its correction after a move in the positive and in
          the negative direction; omitted if the readings are not more accurate than that

Example:
  husillo calibrate axis -m cmm3 --axis x gauge.csv >> mine.toml";

const BACKLASH_HELP: &str = "\
The two-line test: cut a short line across an axis, with the axis coming from below. Cut a second
line next to it, with the axis coming from above. Measure their distance under a microscope. The
measured distance minus the programmed one is the backlash that remains at the second line.
READINGS.csv has a heading and one pair of lines per row:
  axis        X or Y
  x, y        machine position of the second line; omit one, or leave it empty, for bands along that
              axis
  programmed  distance from the line reached from below to the one reached from above, along the
              axis, with its sign
  measured    the same distance as measured
Lengths are in mm, or have a unit. Several measurements of a position are averaged. Every column of
positions needs every row.

The result is the sections [backlash_map.x] and [backlash_map.y] for the machine file, on
standard output. The controller interpolates between the positions, and corrects the backlash as the
tool moves.

Example:
  husillo calibrate backlash --simulate -o mine.toml --report out/backlash.html
  husillo run part.nc -m mine.toml --worn";

const SQUARENESS_HELP: &str = "\
ENDS.csv has a heading and one position of the bar per line: x1,y1,z1,x2,y2,z2, the centres of its
two balls in mm (x1,y1,x2,y2 for two axes). Lay the same bar along both diagonals of each plane, as
long as the travel allows. More positions reduce the noise. If the axes were square, the bar would
have the same length everywhere (ball bar of ASME B89.4.1, diagonals of ISO 230-6). Calibrate the
axes first: the readings are those that `husillo measure` prints with this machine file. A
squareness that the file already has is removed first.

The result is lines for the machine file: by how much X grows per distance along Y (xy) and along Z
(xz), and Y along Z (yz).

Example:
  husillo calibrate squareness -m mine.toml bar.csv >> mine.toml";
