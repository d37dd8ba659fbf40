//! The command line: what can be asked, and the help texts.

use crate::diagnostics::Format;
use clap::{Args, Parser, Subcommand, ValueEnum};

/// Check, simulate and draw programs for small machines
#[derive(Debug, Parser)]
#[command(
    name = "husillo",
    version,
    after_help = "Start here:\n  \
        husillo run examples/circles.nc     simulate a part and look at the report\n  \
        husillo check part.nc               find all errors without running it\n\n\
        Exit status: 0 ok, 1 the program has errors, 2 bad command line or file"
)]
pub struct Cli {
    /// What to do.
    #[command(subcommand)]
    pub command: Command,
}

/// The commands.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Simulate a program down to the motor coils and report path, time and error
    #[command(after_help = "Examples:\n  \
        husillo run examples/circles.nc\n  \
        husillo run part.nc -o part.html --no-compensation\n  \
        husillo run part.nc -m free --format json")]
    Run(Run),
    /// Find errors in programs without running them
    #[command(after_help = "Examples:\n  \
        husillo check part.nc\n  \
        husillo check part.nc -m micromill --format short\n  \
        husillo check - < part.nc")]
    Check(Check),
    /// Print the commands a program means
    #[command(after_help = "Examples:\n  \
        husillo commands part.nc\n  \
        husillo commands part.nc --format json")]
    Commands(Commands),
    /// Write the step events of a program as CSV
    #[command(after_help = "Example:\n  \
        husillo steps examples/circles.nc -o circles.csv")]
    Steps(Steps),
    /// Walk one move on the bare integer grid
    #[command(after_help = "Examples:\n  \
        husillo interpolate line --to 10,4,3\n  \
        husillo interpolate arc --from 30,0 --to 30,0 --centre 0,0 --direction ccw --format json")]
    Interpolate(Interpolate),
}

/// Which machine and which language.
#[derive(Debug, Args)]
pub struct Target {
    /// Machine: micromill, free, or a TOML file
    #[arg(short, long, value_name = "NAME|FILE")]
    pub machine: Option<String>,
    /// Language of the program: rs274 or micromill [default: rs274; micromill for files ending in .mm]
    #[arg(long, value_name = "NAME")]
    pub dialect: Option<String>,
}

/// `husillo run`.
#[derive(Debug, Args)]
pub struct Run {
    /// Program; - is standard input
    pub file: String,
    #[command(flatten)]
    #[allow(missing_docs)]
    pub target: Target,
    /// Report to write [default: out/NAME.html; none with --format json]
    #[arg(short, long, value_name = "REPORT.html")]
    pub output: Option<String>,
    /// How to print the results
    #[arg(long, value_enum, default_value = "text")]
    pub format: Output,
    /// Write the simulated tool after every step as CSV
    #[arg(long, value_name = "FILE.csv")]
    pub trace: Option<String>,
    /// Leave the lash of the machine uncompensated
    #[arg(long)]
    pub no_compensation: bool,
}

/// `husillo check`.
#[derive(Debug, Args)]
pub struct Check {
    /// Programs; - is standard input
    #[arg(required = true)]
    pub files: Vec<String>,
    #[command(flatten)]
    #[allow(missing_docs)]
    pub target: Target,
    /// How to print findings
    #[arg(long, value_enum, default_value = "text")]
    pub format: Format,
    /// Print no more than this many findings of a file
    #[arg(long, value_name = "N", default_value_t = 50)]
    pub limit: u64,
    /// Treat warnings as errors
    #[arg(long)]
    pub deny_warnings: bool,
}

/// `husillo commands`.
#[derive(Debug, Args)]
pub struct Commands {
    /// Program; - is standard input
    pub file: String,
    #[command(flatten)]
    #[allow(missing_docs)]
    pub target: Target,
    /// How to print the commands
    #[arg(long, value_enum, default_value = "text")]
    pub format: Output,
}

/// `husillo steps`.
#[derive(Debug, Args)]
pub struct Steps {
    /// Program; - is standard input
    pub file: String,
    #[command(flatten)]
    #[allow(missing_docs)]
    pub target: Target,
    /// CSV file to write; - is standard output
    #[arg(short, long, value_name = "FILE.csv")]
    pub output: String,
    /// Leave the lash of the machine uncompensated
    #[arg(long)]
    pub no_compensation: bool,
}

/// `husillo interpolate`.
#[derive(Debug, Args)]
pub struct Interpolate {
    /// The move.
    #[command(subcommand)]
    pub shape: Shape,
}

/// The moves.
#[derive(Debug, Subcommand)]
pub enum Shape {
    /// A straight move from zero
    Line(LineShape),
    /// A circular move
    Arc(ArcShape),
}

/// `husillo interpolate line`.
#[derive(Debug, Args)]
pub struct LineShape {
    /// Target in steps, two to six axes
    #[arg(long, value_name = "X,Y[,Z..]", allow_hyphen_values = true)]
    pub to: String,
    /// Method: bresenham
    #[arg(long, default_value = "bresenham")]
    pub method: String,
    /// How to print the move
    #[arg(long, value_enum, default_value = "text")]
    pub format: Output,
}

/// `husillo interpolate arc`.
#[derive(Debug, Args)]
pub struct ArcShape {
    /// Start in steps
    #[arg(long, value_name = "X,Y", allow_hyphen_values = true)]
    pub from: String,
    /// End in steps
    #[arg(long, value_name = "X,Y", allow_hyphen_values = true)]
    pub to: String,
    /// Centre in steps, as decimals
    #[arg(long, value_name = "X,Y", allow_hyphen_values = true)]
    pub centre: String,
    /// Turning direction
    #[arg(long, value_enum)]
    pub direction: Turning,
    /// Fraction bits of the centre, 0 to 16
    #[arg(long, value_name = "F", default_value_t = 16)]
    pub centre_bits: u8,
    /// Square of the radius, in units of 2^(-2F) steps^2: a circle of this radius instead of a spiral
    #[arg(long, value_name = "R2")]
    pub radius_squared: Option<u128>,
    /// Complete extra turns
    #[arg(long, default_value_t = 0)]
    pub turns: u32,
    /// Method: direct-search
    #[arg(long, default_value = "direct-search")]
    pub method: String,
    /// How to print the move
    #[arg(long, value_enum, default_value = "text")]
    pub format: Output,
}

/// Text for people or JSON for programs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Output {
    /// For people.
    Text,
    /// For programs.
    Json,
}

/// Turning direction of an arc.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Turning {
    /// Clockwise.
    Cw,
    /// Counter-clockwise.
    Ccw,
}
