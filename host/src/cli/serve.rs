//! `husillo serve`: its arguments.

use super::{Cell, Output};
use clap::Args;

/// `husillo serve`.
#[derive(Debug, Args)]
pub struct Serve {
    /// Port: sim, a serial device, or tcp:HOST:PORT; repeated, for several machines side by side
    #[arg(short, long, value_name = "PORT", default_value = "sim")]
    pub port: Vec<String>,
    /// Machine: micromill, drill, microfactory, cmm, cmm3, or for a controller with Grbl's protocol
    /// the one whose steps, rates, ramps and travel a simulated controller has; a name or a TOML
    /// file; repeated, one for each port
    #[arg(short, long, value_name = "NAME|FILE", default_value = "router")]
    pub machine: Vec<String>,
    /// Work piece of simulated measuring machines [default: that of examples/piece.toml]
    #[arg(long, value_name = "FILE.toml")]
    pub piece: Option<String>,
    /// Address of the page; port 0 chooses a free one
    #[arg(long, value_name = "HOST:PORT", default_value = "127.0.0.1:8017")]
    pub listen: String,
    /// Further name under which browsers reach this computer, such as mill.lan; may be repeated
    #[arg(long, value_name = "NAME")]
    pub host: Vec<String>,
    /// Show the machines and let nobody take control; STOP works
    #[arg(long)]
    pub watch_only: bool,
    /// Bits per second of a serial device [default: 115200, drill 2400, micromill and microfactory
    /// 9600]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(300..=4_000_000))]
    pub baud: Option<u32>,
    /// Simulated machines run this many times as fast as real ones
    #[arg(long, value_name = "FACTOR", default_value_t = 1.0, value_parser = factor)]
    pub speed: f64,
    /// File with the macros of the page [default: husillo/macros.toml in the folder of
    /// configurations, such as ~/.config]
    #[arg(long, value_name = "FILE")]
    pub macros: Option<String>,
    /// Tell an agent of MTConnect what the machines do; without HOST: to this computer only
    #[arg(long, value_name = "PORT|HOST:PORT", value_parser = listening)]
    pub mtconnect: Option<String>,
    /// Print the file of devices for the agent of MTConnect, and end
    #[arg(long)]
    pub mtconnect_devices: bool,
    #[command(flatten)]
    pub cell: Cell,
    /// End after this time instead of at Ctrl-C
    #[arg(long = "for", value_name = "SECONDS", value_parser = seconds)]
    pub seconds: Option<f64>,
    /// How to print the address of the page
    #[arg(long, value_enum, default_value = "text")]
    pub format: Output,
}

/// An address to listen at. A number is a port of this computer.
fn listening(text: &str) -> Result<String, String> {
    let host_and_port = match text.parse::<u16>() {
        Ok(port) => return Ok(format!("127.0.0.1:{port}")),
        Err(_) => text.rsplit_once(':'),
    };
    match host_and_port {
        Some((host, port)) if !host.is_empty() && port.parse::<u16>().is_ok() => Ok(text.into()),
        _ => Err("a port such as 7878, or HOST:PORT".into()),
    }
}

fn factor(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(factor) if (0.01..=1000.0).contains(&factor) => Ok(factor),
        _ => Err("a factor from 0.01 to 1000".into()),
    }
}

fn seconds(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(seconds) if (0.0..=1e9).contains(&seconds) => Ok(seconds),
        _ => Err("a number of seconds".into()),
    }
}
