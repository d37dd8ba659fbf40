//! The position of a drill, and the content of its memory.

use super::client::{Client, ClientError};
use super::part::millimetres;
use husillo_sim::text::{self, counted};
use husillo_transports::drill::{Failure, MachineState, Reading, STEPS_PER_MM};
use std::fmt;

/// What a drill with extras reports about itself.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Place {
    /// Positions, spindle and sensors.
    pub machine: MachineState,
    /// The number of records in its memory. `None`: the memory holds the end of a longer program.
    pub records: Option<u16>,
    /// Drillings of programs that were done since the memory was cleared. `None`: the memory was
    /// not cleared since the reset.
    pub drillings: Option<u16>,
}

impl Place {
    /// Asks a drill at rest.
    ///
    /// # Errors
    ///
    /// The link failed. [`Failure::Wrong`]: the device does not know its position, like an
    /// original.
    pub fn read(client: &mut Client) -> Result<Self, ClientError> {
        let value = |client: &mut Client, reading, letter| match client.read(reading)? {
            (read, value) if read == letter => Ok(value),
            (other, _) => Err(ClientError::Link(Failure::Wrong(other))),
        };
        let mut machine = MachineState {
            place_steps: [
                value(client, Reading::X, b'X')?,
                value(client, Reading::Y, b'Y')?,
            ],
            zero_steps: [
                value(client, Reading::ZeroX, b'x')?,
                value(client, Reading::ZeroY, b'y')?,
            ],
            ..MachineState::UNKNOWN
        };
        machine.set_bits(value(client, Reading::State, b's')?);
        let (letter, records) = client.read(Reading::Records)?;
        Ok(Self {
            machine,
            records: (letter == b'n').then_some(records),
            drillings: client.drillings()?,
        })
    }

    /// The lines about a drill that cannot be asked, with the reason.
    pub fn unknown(error: &ClientError) -> String {
        let state = match error {
            ClientError::AtWork => {
                "runs a program alone, and does not report its position meanwhile"
            }
            ClientError::Link(Failure::Fault) => {
                "has stopped with a fault: the spindle is off, and nothing moves until its reset"
            }
            _ => "does not answer: it is off, unplugged, homing, or an original at work",
        };
        format!("state    {state}\n{UNKNOWN}")
    }

    /// The lines about an original. It is at rest, because it answers.
    pub fn of_original() -> String {
        format!("state    at rest; an original drill, which reports nothing else\n{UNKNOWN}")
    }
}

const UNKNOWN: &str = "x        unknown\n\
                       y        unknown\n\
                       z        unknown\n\
                       spindle  unknown\n\
                       program  unknown";

/// A position in steps, millimetres and inches.
fn position(steps: u16) -> String {
    let inches = f64::from(steps) / f64::from(STEPS_PER_MM) / 25.4;
    let mm = millimetres(steps).0 as f64 / 1e6;
    format!(
        "{}, {mm:.3} mm, {inches:.4} in",
        text::position(steps, "step")
    )
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let machine = &self.machine;
        let homed = match (machine.is_homed, machine.zero_steps) {
            (true, [0, 0]) => "homed: positions count from the switches".into(),
            (true, [x, y]) => {
                format!("homed: positions count from a zero at {x} and {y} steps from the switches")
            }
            (false, _) => "not homed: positions count from where it was switched on".to_owned(),
        };
        writeln!(f, "state    at rest, {homed}")?;
        for (name, steps) in ["x", "y"].iter().zip(machine.place_steps) {
            writeln!(f, "{name}        {}", position(steps))?;
        }
        let z = match (machine.is_up, machine.is_down) {
            (true, _) => "up, at its sensor",
            (false, true) => "down, at its sensor",
            (false, false) => "between its sensors, at an unknown height",
        };
        writeln!(f, "z        {z}")?;
        let spindle = if machine.spindle_turns { "on" } else { "off" };
        writeln!(f, "spindle  {spindle}")?;
        match self.records {
            Some(0) => write!(f, "program  none")?,
            Some(records) => write!(f, "program  {}", counted(records, "record"))?,
            None => write!(f, "program  the end of a longer one")?,
        }
        match self.drillings {
            Some(drillings) => {
                let done = counted(drillings, "drilling");
                write!(f, "; {done} done since it was cleared")
            }
            None => write!(f, "; drillings done are unknown since the reset"),
        }
    }
}
