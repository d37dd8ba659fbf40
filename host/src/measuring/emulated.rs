//! The simulated chain of a measuring machine behind a port of `husillo emulate`.

use crate::link::emulation::Emulation;
use husillo_metrology::simulated::{self, SimulatedChain};

/// What may be typed at the panel.
#[cfg(unix)]
pub const PANEL: &str = "close probe, open probe, free probe, power off|on, unplug, plug";

impl Emulation for SimulatedChain {
    const PERIOD_NS: u64 = simulated::PERIOD_NS;

    fn send(&mut self, byte: u8) {
        self.send(byte);
    }

    fn tick(&mut self) -> Vec<u8> {
        self.tick()
    }

    #[cfg(unix)]
    fn control(&mut self, line: &str) -> String {
        match line.split_whitespace().collect::<Vec<_>>()[..] {
            [held @ ("close" | "open" | "free"), "probe"] => {
                self.hold_probe(match held {
                    "close" => Some(true),
                    "open" => Some(false),
                    _ => None,
                });
                format!("probe: {held}")
            }
            ["power", power @ ("off" | "on")] => {
                self.set_power(power == "on");
                format!("power is {power}")
            }
            _ => format!("there are {PANEL}"),
        }
    }
}

/// Versions of a list such as `servo:4,servo:4`, from the far end.
///
/// # Errors
///
/// A sentence about the list.
pub fn versions(list: &str) -> Result<Vec<u8>, String> {
    let version = |module: &str| match module {
        "servo" | "servo:4" => Some(4),
        "servo:5" => Some(5),
        "servo:10" => Some(10),
        _ => None,
    };
    let versions: Option<Vec<u8>> = list.split(',').map(version).collect();
    let versions = versions.ok_or_else(|| {
        format!("`{list}`: expected servo:4, servo:5 or servo:10, with commas between")
    })?;
    if versions.len() > usize::from(husillo_transports::nmc::LAST_ADDRESS) {
        return Err(format!("{} modules: a line has 32 at most", versions.len()));
    }
    Ok(versions)
}
