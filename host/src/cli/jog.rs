//! `husillo jog`: its arguments.

use super::Output;
use clap::Args;

/// `husillo jog`.
#[derive(Debug, Args)]
pub struct Jog {
    /// Actions, done in turn
    #[arg(required = true, value_name = "ACTION", allow_negative_numbers = true)]
    pub actions: Vec<String>,
    /// Machine: drill, micromill, microfactory, a TOML file of such a machine, or grbl for any
    /// controller with the protocol of Grbl
    #[arg(short, long, value_name = "NAME|FILE", default_value = "microfactory")]
    pub machine: String,
    /// Port: sim, a serial device, or tcp:HOST:PORT; repeated, for several machines at once; PORT#2
    /// for the second machine of a controller
    #[arg(short, long, value_name = "PORT", default_value = "sim")]
    pub port: Vec<String>,
    /// Figure of the simulated device: a G-code program of straight moves in X and Z, or a list of
    /// them (NAME.fig)
    #[arg(long, value_name = "FILE")]
    pub figure: Option<String>,
    /// Bits per second of the link [default: 2400 for a drill, 115200 for Grbl, otherwise 9600]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(300..=4_000_000))]
    pub baud: Option<u32>,
    /// A motion of the machine ends if it receives no byte of this program for this time, ms; 0: a
    /// motion continues without this program [default: 250]
    #[arg(long, value_name = "MS", value_parser = clap::value_parser!(u16).range(0..=9999))]
    pub lease: Option<u16>,
    /// How to print what the machine does
    #[arg(long, value_enum, default_value = "text")]
    pub format: Output,
    /// Micro mill: `where` reports positions in inches instead of millimetres
    #[arg(long)]
    pub inch: bool,
    /// The device does not answer, as the original: wait the longest time of each action
    #[arg(long)]
    pub without_answers: bool,
}
