//! The measuring machine and its servos; simulated machines behind a port.

use super::{Output, Results};
use crate::text::name;
use clap::{Args, ValueEnum};
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

/// An address to listen at; the name of a host is looked up later.
fn address(text: &str) -> Result<String, String> {
    match text.rsplit_once(':') {
        Some((host, port)) if !host.is_empty() && port.parse::<u16>().is_ok() => Ok(text.into()),
        _ => Err("expected HOST:PORT, as in localhost:7000".into()),
    }
}

/// `husillo emulate`.
#[derive(Debug, Args)]
pub struct Emulate {
    /// Machine: micromill, drill, microfactory, grbl, cmm, cmm3, or a TOML file of a measuring
    /// machine
    pub machine: String,
    /// Mill whose steps, rates, ramps and travel the settings of grbl take: a name or a TOML file
    #[arg(short = 'm', long = "machine", value_name = "MACHINE")]
    pub mechanics: Option<String>,
    /// Figure of a microfactory: a G-code program of straight moves in X and Z, or a list of them
    /// (NAME.fig)
    #[arg(long, value_name = "FILE")]
    pub figure: Option<String>,
    /// Machines that the controller of a microfactory drives
    #[arg(
        long,
        value_name = "N",
        default_value_t = 1,
        value_parser = clap::value_parser!(u8).range(1..=2),
    )]
    pub machines: u8,
    /// Behave as the original: a microfactory without answers and dead-man's time, a drill with the
    /// flaws of its link
    #[arg(long)]
    pub faithful: bool,
    /// Bits per second of the link of a micro mill, drill, microfactory or grbl [default: 2400 for
    /// a drill, 115200 for grbl, otherwise 9600]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(300..=115_200))]
    pub baud: Option<u32>,
    /// Modules from the far end: servo:VERSION (4, 5 or 10) or io:VERSION (inputs and outputs), as
    /// in servo:4,io:2 [default: servo:4 for each of the machine]
    #[arg(long, value_name = "KIND:V,..")]
    pub modules: Option<String>,
    /// Time in ms after a hard reset in which a module of a measuring machine receives nothing
    #[arg(
        long,
        value_name = "MS",
        default_value_t = 0,
        value_parser = clap::value_parser!(u32).range(..=10_000),
    )]
    pub reset_ms: u32,
    /// Bytes of a measuring machine take no time, and rates do not matter
    #[arg(long)]
    pub fast: bool,
    /// Name for clients to open: a symbolic link to a pseudo-terminal, removed at the end
    #[arg(long, value_name = "PATH", required_unless_present = "listen")]
    pub link: Option<String>,
    /// Address for clients to connect to, as tcp:HOST:PORT; port 0 chooses a free one
    #[arg(long, value_name = "HOST:PORT", conflicts_with = "link", value_parser = address)]
    pub listen: Option<String>,
    /// Work piece: the probe, at limit 1 of all modules, closes from COUNT on, or up to ..COUNT;
    /// may be repeated
    #[arg(long, value_name = "MODULE:COUNT")]
    pub contact: Vec<husillo_metrology::simulated::Contact>,
    /// End switch of the simulated machine: the high one closes from COUNT on, the low one up to
    /// ..COUNT; may be repeated
    #[arg(long, value_name = "MODULE:COUNT")]
    pub end: Vec<husillo_metrology::simulated::Contact>,
    /// Work piece: solids and a probe, as in examples/piece.toml
    #[arg(long, value_name = "FILE.toml")]
    pub piece: Option<String>,
    /// Share of wrong bits on the simulated line, such as 1e-5
    #[arg(long, value_name = "RATE", default_value_t = 0.0, value_parser = share)]
    pub noise: f64,
    /// CSV file for the events of a micro mill, drill, microfactory or grbl: steps, dwells, outputs
    #[arg(long, value_name = "FILE.csv")]
    pub steps: Option<String>,
    /// How to print where clients connect, and what the machine reports
    #[arg(long, value_enum, default_value = "text")]
    pub format: Output,
    /// End after this time instead of at Ctrl-C
    #[arg(long = "for", value_name = "SECONDS", value_parser = positive)]
    pub seconds: Option<f64>,
    /// Multiple of real time, also for the line
    #[arg(long, value_name = "N", default_value = "1", value_parser = positive)]
    pub speed: f64,
}

impl Emulate {
    /// Refuses options that do not apply to a drill.
    ///
    /// # Errors
    ///
    /// The option.
    pub fn expect_drill(&self) -> Result<(), String> {
        self.of_microfactory()?;
        self.of_chain()
    }

    /// The port, as clients name it.
    pub fn port(&self) -> String {
        match (&self.link, &self.listen) {
            (Some(link), _) => link.clone(),
            (None, Some(address)) => format!("tcp:{address}"),
            (None, None) => String::new(),
        }
    }

    /// Refuses options that do not apply to a micro mill.
    ///
    /// # Errors
    ///
    /// The option.
    pub fn expect_micromill(&self) -> Result<(), String> {
        self.expect_drill()?;
        self.not_given("--faithful", self.faithful)
    }

    /// Refuses options that do not apply to a microfactory.
    ///
    /// # Errors
    ///
    /// The option.
    pub fn expect_microfactory(&self) -> Result<(), String> {
        self.of_chain()
    }

    /// Refuses options that do not apply to a chain of servo modules.
    ///
    /// # Errors
    ///
    /// The option.
    pub fn expect_chain(&self) -> Result<(), String> {
        self.of_microfactory()?;
        self.not_given("--faithful", self.faithful)?;
        self.not_given("--baud", self.baud.is_some())?;
        self.not_given("--steps", self.steps.is_some())
    }

    fn of_microfactory(&self) -> Result<(), String> {
        self.not_given("--figure", self.figure.is_some())?;
        self.not_given("--machines", self.machines > 1)
    }

    fn of_chain(&self) -> Result<(), String> {
        self.not_given("--modules", self.modules.is_some())?;
        self.not_given("--reset-ms", self.reset_ms > 0)?;
        self.not_given("--fast", self.fast)?;
        self.not_given("--contact", !self.contact.is_empty())?;
        self.not_given("--end", !self.end.is_empty())?;
        self.not_given("--piece", self.piece.is_some())?;
        self.not_given("--noise", self.noise > 0.0)
    }

    fn not_given(&self, option: &str, is_given: bool) -> Result<(), String> {
        if is_given {
            return Err(format!("{option} is not for {}", self.machine));
        }
        Ok(())
    }
}

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

/// A number from 0 to below 1.
fn share(text: &str) -> Result<f64, String> {
    let number = text.parse().ok();
    let number = number.filter(|number| (0.0..1.0).contains(number));
    number.ok_or_else(|| "expected a number from 0 to below 1".into())
}

/// A number above 0 and below a billion.
fn positive(text: &str) -> Result<f64, String> {
    let number = text
        .parse()
        .ok()
        .filter(|number| *number > 0.0 && *number < 1e9);
    number.ok_or_else(|| "expected a number above 0".into())
}
