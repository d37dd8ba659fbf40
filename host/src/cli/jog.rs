//! `husillo jog`: its arguments.

use clap::Args;

/// `husillo jog`.
#[derive(Debug, Args)]
pub struct Jog {
    /// Actions, done in turn
    #[arg(required = true, value_name = "ACTION", allow_negative_numbers = true)]
    pub actions: Vec<String>,
    /// Machine: drill, micromill, microfactory, or the file of one like it
    #[arg(short, long, value_name = "NAME|FILE", default_value = "microfactory")]
    pub machine: String,
    /// Port: sim, a serial device, or tcp:HOST:PORT; several for as many machines at once; PORT#2
    /// for the second machine of a controller
    #[arg(long, value_name = "PORT", default_value = "sim")]
    pub port: Vec<String>,
    /// Figure of the simulated device: a G-code program of straight moves in X and Z, or a list of
    /// them (NAME.fig)
    #[arg(long, value_name = "FILE")]
    pub figure: Option<String>,
    /// Bits a second of the link [default: 9600, of a drill 2400]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(300..=115_200))]
    pub baud: Option<u32>,
    /// Micro mill: a motion ends this many milliseconds after the last byte of this program; 0: it
    /// needs no host [default: 250]
    #[arg(long, value_name = "MS", value_parser = clap::value_parser!(u16).range(0..=9999))]
    pub lease: Option<u16>,
    /// Micro mill: `where` reports positions in inches instead of millimetres
    #[arg(long)]
    pub inch: bool,
    /// The device does not answer, as the original did not: wait as long as it may take
    #[arg(long)]
    pub without_answers: bool,
}
