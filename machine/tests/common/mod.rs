//! Machines and a screw with backlash, shared by the tests.
#![allow(dead_code, reason = "every test binary uses its own part")]

use husillo_backlash::Backlash;
use husillo_gcode::{Dialect, Nm};
use husillo_interp::Path;
use husillo_machine::{Axis, Config, Equipment, Event, Machine, Origin, Scale};

pub const BACKLASH_STEPS: [u32; 3] = [1457, 1271, 0];

pub fn axis(backlash_steps: u32) -> Axis {
    Axis {
        scale: Scale::new(140, 1).unwrap(),
        travel: None,
        max_rate_hz: 170,
        backlash_steps,
        ramp: None,
    }
}

/// The micro mill, without limits.
pub fn config() -> Config<3> {
    Config {
        axes: BACKLASH_STEPS.map(axis),
        timer_hz: 1_000_000,
        dialect: Dialect::RS274,
        arc_tolerance: None,
        rapid: None,
        top_feed: None,
        corner_deviation: None,
        equipment: Equipment::NONE,
        spindle_counts: None,
    }
}

/// The micro mill with X and Y limited to the work area.
pub fn limited() -> Config<3> {
    let mut config = config();
    config.axes[0].travel = Some([Nm(0), Nm(10_000_000)]);
    config.axes[1].travel = Some([Nm(0), Nm(7_000_000)]);
    config
}

/// A nut on a screw with backlash, engaged on its positive flank at zero.
#[derive(Clone, Debug)]
pub struct Screw {
    pub motor: [i64; 3],
    pub tool: [i64; 3],
}

impl Screw {
    pub fn new() -> Self {
        Self {
            motor: [0; 3],
            tool: [0; 3],
        }
    }

    pub fn step(&mut self, delta: [i8; 3]) {
        for axis in 0..3 {
            self.motor[axis] += i64::from(delta[axis]);
            let low = self.motor[axis];
            let high = low + i64::from(BACKLASH_STEPS[axis]);
            self.tool[axis] = self.tool[axis].clamp(low, high);
        }
    }
}

/// Pulls all events. The tool must be where the machine reports it after every step of the path.
pub fn drain<const QUEUE: usize>(
    machine: &mut Machine<3, Path<3>, Backlash, QUEUE>,
    screw: &mut Screw,
) -> (u64, u64) {
    let (mut ticks, mut steps) = (0, 0);
    while let Some(event) = machine.next_event() {
        match event {
            Event::Step(step) => {
                screw.step(step.delta);
                ticks += u64::from(step.wait_ticks);
                steps += 1;
                let load = machine.position_steps().map(i64::from);
                assert_eq!(screw.tool, load, "{:?}", machine.origin());
                assert_ne!(machine.origin(), Origin::Rest);
            }
            Event::Dwell { wait_ticks } => ticks += u64::from(wait_ticks),
            Event::Output(_) | Event::Pause(_) => {}
            Event::Index | Event::Follow(_) => panic!("there is no encoder"),
            other => panic!("{other:?} of a plain machine"),
        }
    }
    (ticks, steps)
}
