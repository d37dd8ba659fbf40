//! `husillo stop`: its arguments.

use super::Output;
use clap::Args;

/// `husillo stop`.
#[derive(Debug, Args)]
pub struct Stop {
    /// Machine: micromill, drill, microfactory, cmm, grbl, or a machine file [default: every
    /// machine that a running husillo drives]
    #[arg(short, long, value_name = "NAME|FILE")]
    pub machine: Option<String>,
    /// Port: a serial device, or tcp:HOST:PORT [default: that of the running husillo]
    #[arg(short, long, value_name = "PORT")]
    pub port: Option<String>,
    /// Bits per second of the link [default: that of the machine]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(300..=4_000_000))]
    pub baud: Option<u32>,
    /// How to print what the machine does
    #[arg(long, value_enum, default_value = "text")]
    pub format: Output,
    /// An emergency stop where the machine has one: the microfactory, until the reset of its panel
    #[arg(long)]
    pub emergency: bool,
    /// The device does not answer, as the original microfactory
    #[arg(long)]
    pub without_answers: bool,
}
