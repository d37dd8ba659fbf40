//! `husillo measure`: its arguments.

use super::Results;
use clap::Args;
use husillo_simulator::text::name;
use std::ffi::OsString;

/// `husillo measure`.
#[derive(Debug, Args)]
pub struct Measure {
    /// goto POSITION, zero, home, jog, touch DIRECTION, calibrate DIRECTION, status, where; several
    /// are done in turn. As the last one: run FILE, record FILE, session
    #[arg(required = true, value_name = "ACTION", allow_negative_numbers = true)]
    pub actions: Vec<String>,
    /// Machine: cmm, cmm3, or a TOML file [default: cmm]
    #[arg(short, long, value_name = "NAME|FILE")]
    pub machine: Option<String>,
    /// Serial device, tcp:HOST:PORT, or sim: simulated modules in simulated time
    #[arg(short, long, value_name = "PORT", default_value = "sim")]
    pub port: String,
    /// Axis of an action that names none
    #[arg(long, value_name = "X|Y|Z", default_value_t = 'x')]
    pub axis: char,
    /// Pre-travel to subtract, instead of the machine's
    #[arg(long, value_name = "LENGTH", allow_negative_numbers = true)]
    pub pretravel: Option<String>,
    /// Radius of the probe's ball, instead of the machine's
    #[arg(long, value_name = "LENGTH")]
    pub ball: Option<String>,
    /// Position of the face that `calibrate` touches
    #[arg(long, value_name = "POSITION", allow_negative_numbers = true)]
    pub reference: Option<String>,
    /// Slow touches to average
    #[arg(
        long,
        value_name = "N",
        default_value_t = 1,
        value_parser = clap::value_parser!(u8).range(1..),
    )]
    pub repeat: u8,
    /// Work piece of --port sim: the probe closes from COUNT on, or up to ..COUNT; may be repeated
    #[arg(long, value_name = "MODULE:COUNT")]
    pub contact: Vec<husillo_metrology::simulated::Contact>,
    /// End switch of the simulated machine: the high one closes from COUNT on, the low one up to
    /// ..COUNT; may be repeated
    #[arg(long, value_name = "MODULE:COUNT")]
    pub end: Vec<husillo_metrology::simulated::Contact>,
    /// Work piece of --port sim: solids and a probe, as in examples/piece.toml
    #[arg(long, value_name = "FILE.toml")]
    pub piece: Option<String>,
    /// Share of wrong bits on the simulated line, such as 1e-5
    #[arg(long, value_name = "RATE", default_value_t = 0.0, value_parser = share)]
    pub noise: f64,
    /// Reset the modules at the start: zero and home of the command before are lost
    #[arg(long)]
    pub reset: bool,
    /// Lengths of `where` in inches
    #[arg(long)]
    pub inch: bool,
    /// Name or number of the part, for the report of a routine
    #[arg(long, value_name = "TEXT")]
    pub part: Option<String>,
    /// How to print the results
    #[arg(long, value_enum, default_value = "text")]
    pub format: Results,
    /// File for the results: CSV; for a routine also a page (.html) or .json
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<String>,
    /// Show the bytes sent (>) and received (<) on standard error
    #[arg(long)]
    pub raw: bool,
}

/// The arguments as text ([`name::text`]), with directions of `measure` such as `-z` and `-1,0,0`
/// written so that they are not taken as options: `z-` and `(-1,0,0)`.
pub fn words(args: impl Iterator<Item = OsString>) -> Vec<OsString> {
    let mut args: Vec<OsString> = args.map(|word| name::text(&word).into()).collect();
    if args.get(1).is_some_and(|command| command == "measure") {
        for word in &mut args[2..] {
            let Some(rest) = word.to_str().and_then(|word| word.strip_prefix('-')) else {
                continue;
            };
            if matches!(rest, "x" | "y" | "z" | "X" | "Y" | "Z") {
                *word = format!("{rest}-").into();
            } else if rest.contains(',')
                && rest.starts_with(|c: char| c.is_ascii_digit() || c == '.')
            {
                *word = format!("(-{rest})").into();
            }
        }
    }
    args
}

/// A number from 0 to below 1.
pub(super) fn share(text: &str) -> Result<f64, String> {
    let number = text.parse().ok();
    let number = number.filter(|number| (0.0..1.0).contains(number));
    number.ok_or_else(|| "expected a number from 0 to below 1".into())
}
