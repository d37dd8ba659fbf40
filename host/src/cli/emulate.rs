//! `husillo emulate`: its arguments.

use super::Output;
use super::measure::share;
use clap::Args;

/// `husillo emulate`.
#[derive(Debug, Args)]
pub struct Emulate {
    /// Machine: micromill, drill, microfactory, grbl, grblhal, cmm, cmm3, or a TOML file of a
    /// measuring machine
    pub machine: String,
    /// Machine whose steps, rates, ramps and travel the settings of grbl or grblhal take: a name
    /// or a TOML file
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

#[cfg(unix)]
impl Emulate {
    /// Refuses options that do not apply to a drill.
    ///
    /// # Errors
    ///
    /// The option.
    pub fn expect_drill(&self) -> Result<(), String> {
        self.of_microfactory()?;
        self.of_network()
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
        self.of_network()
    }

    /// Refuses options that do not apply to a network of servo modules.
    ///
    /// # Errors
    ///
    /// The option.
    pub fn expect_network(&self) -> Result<(), String> {
        self.of_microfactory()?;
        self.not_given("--faithful", self.faithful)?;
        self.not_given("--baud", self.baud.is_some())?;
        self.not_given("--steps", self.steps.is_some())
    }

    fn of_microfactory(&self) -> Result<(), String> {
        self.not_given("--figure", self.figure.is_some())?;
        self.not_given("--machines", self.machines > 1)
    }

    fn of_network(&self) -> Result<(), String> {
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

/// An address to listen at; the name of a host is looked up later.
fn address(text: &str) -> Result<String, String> {
    match text.rsplit_once(':') {
        Some((host, port)) if !host.is_empty() && port.parse::<u16>().is_ok() => Ok(text.into()),
        _ => Err("expected HOST:PORT, as in localhost:7000".into()),
    }
}

/// A number above 0 and below a billion.
fn positive(text: &str) -> Result<f64, String> {
    let number = text
        .parse()
        .ok()
        .filter(|number| *number > 0.0 && *number < 1e9);
    number.ok_or_else(|| "expected a number above 0".into())
}
