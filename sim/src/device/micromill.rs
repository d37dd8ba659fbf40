//! The simulated micro mill.

use super::{Event, Machine, Pair, block, hold, push};
use crate::text::counted;
use crate::{Emulated, MicromillRig};
use husillo_controllers::{Micromill, MicromillConfig, MicromillEvent};
use husillo_gcode::SpindleDirection;

/// First positions of the axes above their home switches, in load steps.
const ABOVE_SWITCHES: [u32; 3] = [90, 70, 50];
/// The motors lose steps above 390 Hz.
const PULL_OUT_TICKS: u32 = 2564;

static CONFIG: MicromillConfig = MicromillConfig::MICROMILL;

/// The device.
pub type Device = super::Device<EmulatedMicromill>;

/// A micro mill. Its queues have the sizes of the firmware.
#[derive(Debug)]
pub struct EmulatedMicromill;

impl Device {
    /// Creates a mill that is switched on, with a line at a rate in bits/s.
    pub fn new(bits_per_s: u32) -> Self {
        let rig = MicromillRig::new(&CONFIG, ABOVE_SWITCHES, PULL_OUT_TICKS);
        let emulated = Emulated::new(Micromill::new(&CONFIG), vec![rig]);
        Self::of(EmulatedMicromill, emulated, bits_per_s)
    }
}

impl Machine for EmulatedMicromill {
    type Controller = Micromill<'static, 16, 16, 80>;
    type Plant = MicromillRig;

    /// The states are the levels of the wires of each motor, bit 0 for the first wire, and the
    /// spindle: 1 is clockwise, 2 counter-clockwise.
    const COLUMNS: &'static str = "dx,dy,dz,lx,ly,lz,spindle";
    const PANEL: &'static str = "close x|y|z, open x|y|z, free x|y|z, push x|y|z N, \
                                 block x|y|z, unblock x|y|z";
    const AT_RESET: MicromillEvent = MicromillEvent::Spindle {
        direction: SpindleDirection::Off,
        rpm: 0,
    };

    fn place(&self, emulated: &Pair<Self>, machine: u8) -> String {
        let (mill, Some(rig)) = (emulated.controller(), emulated.plant(machine)) else {
            return String::new();
        };
        let [x, y, z] = mill.position_steps();
        let frame = if mill.is_homed() {
            "from machine zero"
        } else {
            "not homed"
        };
        let [above_x, above_y, above_z] = rig.place();
        let (direction, rpm) = rig.spindle();
        let spindle = spindle(direction, rpm);
        let lost: u64 = rig.lost_steps().iter().sum();
        format!(
            "x {x} y {y} z {z} steps {frame}; {above_x} {above_y} {above_z} above the switches; \
             {spindle}; {} lost",
            counted(lost, "step")
        )
    }

    fn control(&self, rig: &mut MicromillRig, words: &[&str]) -> Option<String> {
        let names = ["x", "y", "z"];
        hold(words, &names, |switch, closed| rig.hold(switch, closed))
            .or_else(|| push(words, &names, |axis, steps| rig.push(axis, steps)))
            .or_else(|| block(words, &names, |axis, is| rig.block(axis, is)))
    }

    fn report(event: &MicromillEvent) -> Option<String> {
        match *event {
            MicromillEvent::Step(_) => None,
            MicromillEvent::Spindle { direction, rpm } => Some(spindle(direction, rpm)),
            MicromillEvent::Tool { number } => Some(format!("tool {number} is requested")),
        }
    }

    fn row(event: &Event<Self>, rig: &MicromillRig) -> Option<(Vec<i8>, Vec<u8>)> {
        let delta = match event {
            MicromillEvent::Step(step) => step.deltas(),
            MicromillEvent::Spindle { .. } => [0; 3],
            MicromillEvent::Tool { .. } => return None,
        };
        let [x, y, z] = rig.levels().map(|levels| levels.0);
        let spindle = match rig.spindle() {
            (SpindleDirection::Off, _) => 0,
            (SpindleDirection::Clockwise, _) => 1,
            (SpindleDirection::CounterClockwise, _) => 2,
        };
        Some((delta.to_vec(), vec![x, y, z, spindle]))
    }
}

fn spindle(direction: SpindleDirection, rpm: u16) -> String {
    match direction {
        SpindleDirection::Off => "spindle off".into(),
        SpindleDirection::Clockwise => format!("spindle clockwise, {rpm} rpm"),
        SpindleDirection::CounterClockwise => format!("spindle counter-clockwise, {rpm} rpm"),
    }
}
