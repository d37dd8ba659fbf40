//! A simulated mill with a Grbl controller.

use super::{Event, Machine, Pair, block, hold, push};
use crate::text::counted;
use crate::{Emulated, GrblPin, GrblRig, SlideSwitch};
use husillo_controllers::{Grbl, GrblEvent, GrblMemory, GrblOptions};
use husillo_transports::grbl::Settings;

/// Positions at which the limit switches close, above the position at power-on, mm.
const SWITCHES_MM: [i64; 3] = [20, 20, 10];
/// Position of Z at which the probe closes, from the position at power-on, mm.
const PLATE_MM: i64 = -10;
/// Highest step rate that the motors follow, in steps/s.
const MOST_HZ: u64 = 60_000;

/// The device.
pub type Device = super::Device<EmulatedGrbl>;

/// A mill with three axes.
#[derive(Debug)]
pub struct EmulatedGrbl;

impl Device {
    /// Creates a mill that is switched on for the first time, with a line at a rate in bits/s.
    ///
    /// Its mechanics have the steps per millimetre of these settings. As on a real mill, a later
    /// change of the settings does not change the mechanics.
    pub fn new(bits_per_s: u32, settings: Settings) -> Self {
        Self::with_options(bits_per_s, settings, GrblOptions::FULL)
    }

    /// Creates such a mill whose controller speaks the protocol of grblHAL.
    pub fn grblhal(bits_per_s: u32, settings: Settings) -> Self {
        Self::with_options(bits_per_s, settings, GrblOptions::HAL)
    }

    fn with_options(bits_per_s: u32, settings: Settings, options: GrblOptions) -> Self {
        let memory = GrblMemory::FACTORY.with_settings(settings);
        let grbl = Grbl::new(options, Some(&memory));
        let mut rig = GrblRig::new();
        for (axis, mm) in SWITCHES_MM.into_iter().enumerate() {
            rig.add_switch(SlideSwitch {
                pin: GrblPin::Limit(axis),
                axis,
                at_steps: steps(&settings, axis, mm),
                is_above: true,
                closed_level: false,
            });
        }
        rig.add_switch(SlideSwitch {
            pin: GrblPin::Probe,
            axis: 2,
            at_steps: steps(&settings, 2, PLATE_MM),
            is_above: false,
            closed_level: false,
        });
        rig.set_pull_out_hz(MOST_HZ);
        Self::of(EmulatedGrbl, Emulated::new(grbl, vec![rig]), bits_per_s)
    }
}

/// Converts a distance to steps.
fn steps(settings: &Settings, axis: usize, mm: i64) -> i64 {
    // There are three axes.
    let milli = settings.milli(100 + axis as u8);
    mm * i64::from(milli) / 1000
}

const SWITCHES: [&str; 8] = ["x", "y", "z", "probe", "door", "hold", "start", "reset"];

const fn pin(number: usize) -> GrblPin {
    match number {
        0..=2 => GrblPin::Limit(number),
        3 => GrblPin::Probe,
        4 => GrblPin::Door,
        5 => GrblPin::Hold,
        6 => GrblPin::Start,
        _ => GrblPin::Reset,
    }
}

impl Machine for EmulatedGrbl {
    type Controller = Grbl;
    type Plant = GrblRig;

    /// The states are: motors off, spindle counter-clockwise, duty of the spindle, flood, mist.
    const COLUMNS: &'static str = "dx,dy,dz,disable,ccw,duty,flood,mist";
    const PANEL: &'static str = "close|open|free x|y|z|probe|door|hold|start|reset, push x|y|z N, \
                                 block x|y|z, unblock x|y|z, tilt N N";
    const AT_RESET: GrblEvent = GrblEvent::SpindleDuty { duty: 0 };

    fn place(&self, emulated: &Pair<Self>, machine: u8) -> String {
        let (grbl, Some(rig)) = (emulated.controller(), emulated.plant(machine)) else {
            return String::new();
        };
        let [x, y, z] = grbl.position_steps();
        let [at_x, at_y, at_z] = rig.steps();
        let lost: u64 = rig.lost_steps().iter().sum();
        format!(
            "x {x} y {y} z {z} steps of the controller; the axes stand at {at_x} {at_y} {at_z} \
             from their first places; spindle duty {}; {} lost",
            rig.outputs.duty,
            counted(lost, "step")
        )
    }

    fn control(&self, rig: &mut GrblRig, words: &[&str]) -> Option<String> {
        if let ["tilt", x, y] = words {
            let tilt = [x.parse().ok()?, y.parse().ok()?];
            rig.tilt(tilt);
            let [x, y] = tilt;
            return Some(format!(
                "the plate rises by {x} steps of z per 1000 of x, and {y} per 1000 of y"
            ));
        }
        let names = ["x", "y", "z"];
        hold(words, &SWITCHES, |switch, closed| {
            rig.hold(pin(switch), closed);
        })
        .or_else(|| push(words, &names, |axis, steps| rig.push(axis, steps)))
        .or_else(|| block(words, &names, |axis, is| rig.block(axis, is)))
    }

    fn report(event: &GrblEvent) -> Option<String> {
        let on = |is_on: bool| if is_on { "on" } else { "off" };
        Some(match *event {
            GrblEvent::SpindleDuty { duty } => format!("spindle duty {duty}"),
            GrblEvent::Flood { is_on } => format!("flood {}", on(is_on)),
            GrblEvent::Mist { is_on } => format!("mist {}", on(is_on)),
            _ => return None,
        })
    }

    fn row(event: &Event<Self>, rig: &GrblRig) -> Option<(Vec<i8>, Vec<u8>)> {
        let delta = match event {
            GrblEvent::Step { delta, .. } => *delta,
            GrblEvent::Wait { .. } | GrblEvent::Store => return None,
            _ => [0; 3],
        };
        let outputs = rig.outputs;
        let states = [
            outputs.disable.into(),
            outputs.direction.into(),
            outputs.duty,
            outputs.flood.into(),
            outputs.mist.into(),
        ];
        Some((delta.to_vec(), states.to_vec()))
    }
}
