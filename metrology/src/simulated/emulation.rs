//! The simulated network as an emulated device with a control panel.

use super::SimulatedNetwork;
use husillo_sim::device::Emulation;

/// The commands of the panel of a simulated network.
pub const PANEL: &str = "close|open|free probe, close|open|free end MODULE, power off|on, \
                         block MODULE, unblock MODULE, encoder MODULE off|on, unplug, plug";
/// The commands of the panel for a network with input and output modules.
pub const IO_PANEL: &str = "pin MODULE PIN high|low, analogue MODULE 1|2|3 VALUE, \
                            pulses MODULE NUMBER, outputs MODULE";

/// Pins of an input and output module.
const PINS: u8 = 12;

/// Connects a pin of a module to a level.
fn pin_of(network: &mut SimulatedNetwork, module: &str, pin: &str, level: &str) -> Option<String> {
    let number: u8 = pin.parse().ok().filter(|pin| *pin < PINS)?;
    let is_connected = network.connect(module.parse().ok()?, |inputs| {
        let mask = 1 << number;
        inputs.pins = inputs.pins & !mask | if level == "high" { mask } else { 0 };
    });
    is_connected.then(|| format!("pin {number} of module {module}: {level}"))
}

/// Sets the reading of an analogue input of a module.
fn analogue(
    network: &mut SimulatedNetwork,
    module: &str,
    input: &str,
    value: &str,
) -> Option<String> {
    let place: usize = input.parse().ok().filter(|input| (1..=3).contains(input))?;
    let reading: u8 = value.parse().ok()?;
    let is_connected = network.connect(module.parse().ok()?, |inputs| {
        inputs.analogue[place - 1] = reading;
    });
    is_connected.then(|| format!("analogue input {place} of module {module}: {reading}"))
}

/// Sends pulses to the counter of a module.
fn pulses(network: &mut SimulatedNetwork, module: &str, number: &str) -> Option<String> {
    let number: u32 = number.parse().ok()?;
    let is_connected = network.connect(module.parse().ok()?, |inputs| {
        inputs.pulses = inputs.pulses.wrapping_add(number);
    });
    is_connected.then(|| format!("counter of module {module}: {number} more pulses"))
}

/// The outputs of a module.
fn outputs(network: &SimulatedNetwork, module: &str) -> Option<String> {
    let (pins, [one, two]) = network.outputs(module.parse().ok()?)?;
    let pins: Vec<String> = (0..PINS)
        .filter(|pin| pins >> pin & 1 == 1)
        .map(|pin| pin.to_string())
        .collect();
    let high = if pins.is_empty() {
        "none".to_owned()
    } else {
        pins.join(", ")
    };
    Some(format!(
        "outputs of module {module}: high {high}; PWM {one} and {two} of 255"
    ))
}

impl Emulation for SimulatedNetwork {
    const PERIOD_NS: u64 = super::PERIOD_NS;

    fn set_host_rate(&mut self, bits_per_s: Option<u32>) {
        self.set_host_rate(bits_per_s);
    }

    fn send(&mut self, byte: u8) {
        self.send(byte);
    }

    fn on_the_line(&self) -> usize {
        self.on_the_line()
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
            [held @ ("close" | "open" | "free"), "end", module] => {
                let is_closed = match held {
                    "close" => Some(true),
                    "open" => Some(false),
                    _ => None,
                };
                let number = module.parse().unwrap_or(0);
                match self.hold_ends(number, is_closed) {
                    true => format!("the end switches of module {number}: {held}"),
                    false => format!("module {module} has no end switch: see --end"),
                }
            }
            ["power", power @ ("off" | "on")] => {
                self.set_power(power == "on");
                format!("power is {power}")
            }
            [word @ ("block" | "unblock"), module] => match module.parse() {
                Ok(number) => {
                    self.block(number, word == "block");
                    format!("the motor of module {number}: {word}")
                }
                Err(_) => format!("{word} MODULE"),
            },
            ["encoder", module, state @ ("off" | "on")] => match module.parse() {
                Ok(number) => {
                    self.silence(number, state == "off");
                    format!("the encoder of module {number}: {state}")
                }
                Err(_) => "encoder MODULE off|on".into(),
            },
            ["pin", module, pin, level @ ("high" | "low")] => pin_of(self, module, pin, level)
                .unwrap_or_else(|| format!("pin MODULE 0..{} high|low", PINS - 1)),
            ["analogue", module, input, value] => analogue(self, module, input, value)
                .unwrap_or_else(|| "analogue MODULE 1|2|3 0..255".into()),
            ["pulses", module, number] => {
                pulses(self, module, number).unwrap_or_else(|| "pulses MODULE NUMBER".into())
            }
            ["outputs", module] => {
                outputs(self, module).unwrap_or_else(|| format!("module {module} has no outputs"))
            }
            _ => format!("there are {PANEL}; {IO_PANEL}"),
        }
    }
}
