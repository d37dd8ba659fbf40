//! The simulated chain as an emulated device with a control panel.

use super::SimulatedChain;
use husillo_sim::device::Emulation;

/// The commands of the panel of a simulated chain.
pub const PANEL: &str = "close probe, open probe, free probe, power off|on, unplug, plug";

impl Emulation for SimulatedChain {
    const PERIOD_NS: u64 = super::PERIOD_NS;

    fn send(&mut self, byte: u8) {
        self.send(byte);
    }

    fn tick(&mut self) -> Vec<u8> {
        self.tick()
    }

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
