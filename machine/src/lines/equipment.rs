//! What a machine has besides its axes and the encoder of its spindle.

use husillo_gcode::{Command, Feed, Input, Switch};

use crate::Means;

/// Equipment of a machine, without which commands are refused. [`Equipment::NONE`] is a machine of
/// axes, a spindle and coolant.
///
/// It takes effect in a machine with [`Extended`](crate::Extended) only; another one has none.
#[derive(Copy, Clone, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Equipment {
    /// Curves: G5 to G5.3.
    pub splines: bool,
    /// A probe: G38.2 to G38.5.
    pub probe: bool,
    /// Number of digital outputs: M62 to M65.
    pub digital_outputs: u8,
    /// Number of analogue outputs: M67, M68.
    pub analog_outputs: u8,
    /// Number of digital inputs: M66 P.
    pub digital_inputs: u8,
    /// Number of analogue inputs: M66 E.
    pub analog_inputs: u8,
    /// The spindle can be held at an angle: M19.
    pub spindle_angle: bool,
    /// Highest speed of a spindle whose speed can change during a move, in thousandths of a turn
    /// per minute: G96. `None`: its speed changes between moves only.
    pub surface_milli_rpm: Option<u32>,
    /// The spindle reverses within this number of turns, and its encoder counts in both directions:
    /// G33.1. `None`: no rigid tapping. While it reverses, the tap goes this far beyond the bottom
    /// and the start, so both must be within the travel.
    pub tapping_overrun_turns: Option<u8>,
    /// Heaters and fans of a printer: M104 to M109, M140, M141, M190, M191.
    pub heaters: bool,
    /// An input scales the feed: M52 P1.
    pub adaptive_feed: bool,
    /// Pallets are changed by hand: M60 waits for the operator.
    pub pallets: bool,
}

impl Equipment {
    /// Nothing.
    pub const NONE: Equipment = Equipment {
        splines: false,
        probe: false,
        digital_outputs: 0,
        analog_outputs: 0,
        digital_inputs: 0,
        analog_inputs: 0,
        spindle_angle: false,
        surface_milli_rpm: None,
        tapping_overrun_turns: None,
        heaters: false,
        adaptive_feed: false,
        pallets: false,
    };

    /// The equipment that a command needs and that is not here. `has_encoder`: the spindle has an
    /// encoder.
    pub(crate) const fn missing<const N: usize>(
        &self,
        command: &Command<N>,
        has_encoder: bool,
    ) -> Option<Means> {
        Some(match command {
            Command::Linear {
                feed: Feed::PerRevolution(_),
                ..
            }
            | Command::Arc {
                feed: Feed::PerRevolution(_),
                ..
            }
            | Command::Spline {
                feed: Feed::PerRevolution(_),
                ..
            }
            | Command::NurbsBegin {
                feed: Feed::PerRevolution(_),
                ..
            }
            | Command::Thread { .. }
                if !has_encoder =>
            {
                Means::SpindleFeedback
            }
            // A spindle cannot brake at a contact.
            Command::Probe {
                feed: Feed::PerRevolution(_),
                ..
            } => Means::ProbeFeed,
            Command::Surface { .. } if self.surface_milli_rpm.is_none() => Means::SurfaceSpeed,
            Command::Spline { .. }
            | Command::NurbsBegin { .. }
            | Command::NurbsPoint { .. }
            | Command::NurbsEnd { .. }
                if !self.splines =>
            {
                Means::Splines
            }
            Command::Tap { .. } if !has_encoder || self.tapping_overrun_turns.is_none() => {
                Means::RigidTapping
            }
            Command::Orient { .. } if !self.spindle_angle => Means::SpindleAngle,
            Command::Probe { .. } if !self.probe => Means::Probe,
            Command::Compensation { side: Some(_), .. } => Means::RadiusCompensation,
            Command::Output { number, .. } if *number >= self.digital_outputs => {
                Means::InputsAndOutputs
            }
            Command::Analog { number, .. } if *number >= self.analog_outputs => {
                Means::InputsAndOutputs
            }
            Command::Wait { input, .. } if !self.has(input) => Means::InputsAndOutputs,
            Command::Heat { .. } | Command::Fan { .. } if !self.heaters => Means::Heaters,
            Command::Pallet if !self.pallets => Means::Pallets,
            Command::Switch {
                what: Switch::AdaptiveFeed,
                on: true,
            } if !self.adaptive_feed => Means::AdaptiveFeed,
            _ => return None,
        })
    }

    const fn has(&self, input: &Input) -> bool {
        match input {
            Input::Digital(number) => *number < self.digital_inputs,
            Input::Analog(number) => *number < self.analog_inputs,
        }
    }
}
