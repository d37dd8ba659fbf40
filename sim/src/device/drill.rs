//! The simulated drill.

use super::{Event, Machine, Pair, block, hold, push};
use crate::text::counted;
use crate::{DrillRig, DrilledHole, Emulated};
use husillo_controllers::{Drill, DrillConfig, DrillEvent, DrillFault, DrillLights, DrillReport};
use husillo_transports::drill::MEMORY_BYTES;

/// First positions of X, Y and Z, in steps from their switches.
const BEGIN: [i32; 3] = [500, 250, 60];
/// Distance between the sensors of Z, 35 mm, and from the upper sensor to the board, 30 mm, in
/// steps.
pub const STROKE_STEPS: u16 = 3745;
const BOARD_STEPS: u16 = 3210;
/// Motors lose steps above 390 Hz, as those of the other machines do.
const PULL_OUT_TICKS: u32 = 2564;

/// The device.
pub type Device = super::Device<EmulatedDrill>;

/// A drill.
#[derive(Debug)]
pub struct EmulatedDrill;

impl Device {
    /// Creates a drill that is switched on, the original or the corrected one, with a line at a
    /// rate in bits/s.
    pub fn new(bits_per_s: u32, is_original: bool) -> Self {
        let rig = DrillRig::new(BEGIN, STROKE_STEPS, BOARD_STEPS, PULL_OUT_TICKS);
        let emulated = Emulated::new(Drill::new(config(is_original)), vec![rig]);
        Self::of(EmulatedDrill, emulated, bits_per_s)
    }

    /// Creates a small and fast drill, so that a test runs many programs in a short time.
    pub fn quick(is_original: bool) -> Self {
        let config = DrillConfig {
            rate_hz: [1000; 3],
            back_off_steps: 8,
            stroke_steps: 20,
            shortest_stroke_steps: config(is_original).shortest_stroke_steps.map(|_| 6),
            upper_opens_steps: 2,
            settle_ticks: 1000,
            ..config(is_original)
        };
        let rig = DrillRig::new([3, 0, 2], 6, 3, 0);
        let emulated = Emulated::new(Drill::new(config), vec![rig]);
        Self::of(EmulatedDrill, emulated, 2400)
    }
}

const fn config(is_original: bool) -> DrillConfig {
    if is_original {
        DrillConfig::ORIGINAL
    } else {
        DrillConfig::FIXED
    }
}

impl Machine for EmulatedDrill {
    type Controller = Drill<MEMORY_BYTES>;
    type Plant = DrillRig;

    /// The states are the levels of the wires of each motor, bit 0 for the first wire, and the
    /// spindle.
    const COLUMNS: &'static str = "dx,dy,dz,lx,ly,lz,spindle";
    const PANEL: &'static str = "lights, holes, board, close x|y|up|down, open x|y|up|down, \
                                 free x|y|up|down, push x|y N, block x|y|z, unblock x|y|z";
    /// The spindle stops with the supply of its relay.
    const AT_RESET: DrillEvent = DrillEvent::Spindle(false);

    fn place(&self, emulated: &Pair<Self>, machine: u8) -> String {
        let (drill, Some(rig)) = (emulated.controller(), emulated.plant(machine)) else {
            return String::new();
        };
        let [x, y] = drill.position_steps();
        let [.., z] = rig.place();
        let frame = if drill.is_homed() {
            "from home"
        } else {
            "not homed"
        };
        let spindle = if rig.spindle_turns() { "on" } else { "off" };
        let (holes, bytes) = (rig.holes().len(), drill.stored().len());
        let lost: u64 = rig.lost_steps().iter().sum();
        format!(
            "x {x} y {y} steps {frame}, z {z} below its sensor, spindle {spindle}; \
             {}, program of {}; {} lost",
            counted(holes, "hole"),
            counted(bytes, "byte"),
            counted(lost, "step")
        )
    }

    fn shown(&self, emulated: &Pair<Self>, words: &[&str]) -> Option<String> {
        (words == ["lights"]).then(|| {
            let heartbeats = emulated.now_us() / u64::from(DrillConfig::HEARTBEAT_US);
            let bits = emulated.controller().lights().bits(heartbeats % 2 == 1);
            let lamps = DrillLights::NAMES.iter().enumerate();
            let lamp = |(number, name): (usize, &&str)| {
                format!(
                    "{name} {}",
                    if bits >> number & 1 == 1 { "on" } else { "off" }
                )
            };
            lamps.map(lamp).collect::<Vec<_>>().join(", ")
        })
    }

    fn control(&self, rig: &mut DrillRig, words: &[&str]) -> Option<String> {
        match words {
            ["holes"] => Some(holes(rig)),
            ["board"] => {
                rig.change_board();
                Some("a board without holes".into())
            }
            _ => hold(words, &["x", "y", "up", "down"], |switch, closed| {
                rig.hold(switch, closed);
            })
            .or_else(|| push(words, &["x", "y"], |axis, steps| rig.push(axis, steps)))
            .or_else(|| block(words, &["x", "y", "z"], |axis, is| rig.block(axis, is))),
        }
    }

    fn report(event: &DrillEvent) -> Option<String> {
        match *event {
            DrillEvent::Report(report) => Some(text(report)),
            DrillEvent::Spindle(on) => Some(format!("spindle {}", if on { "on" } else { "off" })),
            _ => None,
        }
    }

    fn row(event: &Event<Self>, rig: &DrillRig) -> Option<(Vec<i8>, Vec<u8>)> {
        let delta = match *event {
            DrillEvent::Step(step) => step.delta,
            DrillEvent::Dwell { wait_ticks } if wait_ticks > 0 => [0; 3],
            DrillEvent::Spindle(_) => [0; 3],
            DrillEvent::Dwell { .. } | DrillEvent::Report(_) | DrillEvent::Idle => return None,
        };
        let [x, y, z] = rig.levels().map(|levels| levels.0);
        Some((delta.to_vec(), vec![x, y, z, rig.spindle_turns().into()]))
    }
}

fn holes(rig: &DrillRig) -> String {
    let hole = |hole: &DrilledHole| {
        let ([x, y], depth) = (hole.at, hole.depth);
        let how = if hole.is_clean {
            ""
        } else {
            " with a spindle that stood"
        };
        format!("{x},{y} depth {depth}{how}")
    };
    let holes: Vec<_> = rig.holes().iter().map(hole).collect();
    format!("{}: {}", counted(holes.len(), "hole"), holes.join("; "))
}

/// The text of a report.
fn text(report: DrillReport) -> String {
    let letter = |axis: u8| if axis == 0 { "x" } else { "y" };
    match report {
        DrillReport::Homed => "homed".into(),
        DrillReport::Drilled { at: [x, y] } => format!("drilled at {x},{y}"),
        DrillReport::Taught { at: [x, y] } => format!("taught {x},{y}"),
        DrillReport::Expired => {
            "the host is silent: its lease has expired, and the work ends".into()
        }
        DrillReport::Fault(fault) => {
            let why = match fault {
                DrillFault::NoSwitch { axis } => {
                    format!("no home switch {} within the longest search", letter(axis))
                }
                DrillFault::StillClosed { axis } => format!(
                    "home switch {} is still closed after moving off it",
                    letter(axis)
                ),
                DrillFault::NotUp => "the upper sensor does not see the spindle".into(),
                DrillFault::NotDown => "the lower sensor does not see the spindle".into(),
                DrillFault::UpClosed => {
                    "the upper sensor is closed although Z has moved down from it: it sticks, or Z \
                     does not move; free it, and see that the bit is out of the board"
                        .into()
                }
                DrillFault::DownClosed => {
                    "the lower sensor is closed although Z is above it: it sticks; free it, and \
                     drill the present hole again"
                        .into()
                }
                DrillFault::BothClosed => {
                    "both sensors of Z are closed at once: one sticks; free it, and see that the \
                     bit is out of the board"
                        .into()
                }
                DrillFault::LostSteps { axis } => format!(
                    "home switch {} closed too early: steps were lost",
                    letter(axis)
                ),
                DrillFault::OffTable { axis } => {
                    format!("a record is beyond the table in {}", letter(axis))
                }
            };
            format!("fault: {why}; nothing moves until a reset")
        }
    }
}
