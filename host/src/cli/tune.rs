//! `husillo tune`: its arguments.

use super::Output;
use clap::{Args, ValueEnum};

/// `husillo tune`.
#[derive(Debug, Args)]
pub struct Tune {
    /// Machine: cmm, cmm3, or a TOML file [default: cmm]
    #[arg(short, long, value_name = "NAME|FILE")]
    pub machine: Option<String>,
    /// Axis to tune
    #[arg(long, value_name = "X|Y|Z", default_value_t = 'x')]
    pub axis: char,
    /// Serial device, tcp:HOST:PORT, line: simulated modules on a simulated line, or sim: the
    /// simulated axis itself, read in every servo period
    #[arg(short, long, value_name = "PORT", default_value = "sim")]
    pub port: String,
    /// How to find the gains
    #[arg(long, value_enum)]
    pub method: TuneMethod,
    /// Proportional gain of a step, instead of the machine's
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(..=0x7fff))]
    pub p: Option<u16>,
    /// Integral gain of a step
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(..=0x7fff))]
    pub i: Option<u16>,
    /// Derivative gain of a step
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(..=0x7fff))]
    pub d: Option<u16>,
    /// Limit of the sum of errors of a step
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(..=0x7fff))]
    pub integral_limit: Option<u16>,
    /// Dead-band compensation, PWM, instead of the machine's
    #[arg(long, value_name = "PWM")]
    pub dead_band: Option<u8>,
    /// Position error that ends the experiment, counts, instead of the machine's
    #[arg(long, value_name = "COUNTS", value_parser = clap::value_parser!(u16).range(1..=0x3fff))]
    pub error_limit: Option<u16>,
    /// Current that ends the experiment, as the module reads it, odd; instead of the machine's
    #[arg(long, value_name = "N")]
    pub current: Option<u8>,
    /// Length of the steps of the methods step and stepwise
    #[arg(
        long,
        value_name = "COUNTS",
        default_value_t = 100,
        value_parser = clap::value_parser!(i32).range(1..=0x3fff),
    )]
    pub size: i32,
    /// Output of the relay
    #[arg(
        long,
        value_name = "PWM",
        default_value_t = 200,
        value_parser = clap::value_parser!(u8).range(1..),
    )]
    pub amplitude: u8,
    /// Position error at which the relay switches, counts on both sides [default: 0, on a line 1]
    #[arg(long, value_name = "COUNTS", value_parser = clap::value_parser!(u16).range(..=1000))]
    pub hysteresis: Option<u16>,
    /// Rule that computes the gains from Ku and Tu
    #[arg(long, value_enum, default_value = "tyreus-luyben")]
    pub rule: TuneRule,
    /// Moves that check the gains, 1 to 1000 counts long [default: 20, none for step]
    #[arg(long, value_name = "N")]
    pub moves: Option<u32>,
    /// How to print the results
    #[arg(long, value_enum, default_value = "text")]
    pub format: Output,
    /// Page to write, with pictures
    #[arg(short, long, value_name = "REPORT.html")]
    pub output: Option<String>,
    /// Show the bytes sent (>) and received (<) on standard error
    #[arg(long)]
    pub raw: bool,
}

/// Methods of finding gains.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum TuneMethod {
    /// A step response.
    Step,
    /// The ultimate gain.
    Ultimate,
    /// A relay.
    Relay,
    /// One gain after the other.
    Stepwise,
}

impl TuneMethod {
    /// Its name on the command line.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Step => "step",
            Self::Ultimate => "ultimate",
            Self::Relay => "relay",
            Self::Stepwise => "stepwise",
        }
    }
}

/// Rules for gains.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum TuneRule {
    /// Fast, with much overshoot.
    ZieglerNichols,
    /// Gentler.
    TyreusLuyben,
}

/// What the methods of `husillo tune` do.
pub(super) const TUNE_HELP: &str = "\
Methods:
  step      a step of --size counts with the gains of the machine file, or those given
  ultimate  raises the proportional gain until the axis oscillates steadily: Ku, Tu, and gains by
            --rule
  relay     a relay in place of the controller finds the same point in one experiment
  stepwise  as by hand: raises the derivative gain up to vibration, then the proportional gain, then
            the integral gain with its limit at 16000, then lowers the limit

The axis moves automatically, within its travel: by --size counts, and in the moves that check the
gains by up to 1000 counts in each direction. A position error or a current beyond its limit ends
the experiment with the motor off.

Examples:
  husillo tune -m cmm --method step --p 100 --i 0 --d 10000 -o step.html
  husillo tune -m cmm --method ultimate --rule ziegler-nichols
  husillo tune -m cmm --method stepwise --port /dev/ttyUSB0 --current 101";
