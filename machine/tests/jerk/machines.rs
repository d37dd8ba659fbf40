//! Machines, programs, and runs of them.

use husillo_backlash::Backlash;
use husillo_gcode::{Dialect, Nm};
use husillo_interp::Path;
use husillo_machine::{
    Axis, AxisRamp, Config, Equipment, Event, Extended, Machine, Origin, PathRamp, Scale,
    SmoothRamp,
};

use crate::checker::Checker;

pub const TIMER_HZ: u32 = 200_000_000;
/// Length of a step in nm.
pub const STEP: f64 = 50.0;

pub type Smooth<const QUEUE: usize> = Machine<3, Path<3>, Backlash, QUEUE, Extended<3>, SmoothRamp>;

/// Acceleration in mm/s^2 and jerk in m/s^3 of an axis; backlash in steps.
#[derive(Clone, Copy, Debug)]
pub struct Facts {
    pub acceleration: u32,
    pub jerk: Option<u32>,
    pub backlash_steps: u32,
}

pub const fn facts(acceleration: u32, jerk: u32) -> Facts {
    Facts {
        acceleration,
        jerk: Some(jerk),
        backlash_steps: 0,
    }
}

/// Windows of 17 ms, 7 ms and 14 ms.
pub const MACHINES: [[Facts; 3]; 3] = [
    [facts(1000, 50); 3],
    [facts(1000, 50), facts(1000, 50), facts(400, 60)],
    [
        facts(500, 30),
        Facts {
            backlash_steps: 100,
            ..facts(500, 30)
        },
        Facts {
            jerk: None,
            ..facts(800, 0)
        },
    ],
];

pub fn config(axes: [Facts; 3]) -> Config<3> {
    let steps = 1_000_000.0 / STEP;
    Config {
        axes: axes.map(|facts| Axis {
            scale: Scale::new(STEP as u32, 1).unwrap(),
            travel: None,
            max_rate_hz: 2_000_000, // 100 mm/s
            backlash_steps: facts.backlash_steps,
            ramp: Some(AxisRamp {
                acceleration_hz_per_s: (f64::from(facts.acceleration) * steps) as u32,
                start_rate_hz: 0,
                jerk_hz_per_s2: facts
                    .jerk
                    .map(|jerk| (f64::from(jerk) * 1000.0 * steps) as u32),
                junction_hz: None,
            }),
        }),
        timer_hz: TIMER_HZ,
        dialect: Dialect::RS274,
        arc_tolerance: None,
        rapid: None,
        top_feed: None,
        corner_deviation: Some(Nm(20_000)),
        equipment: Equipment {
            adaptive_feed: true,
            probe: true,
            ..Equipment::NONE
        },
        spindle_counts: None,
    }
}

/// What happens at some events, by their number.
#[derive(Clone, Copy, Debug)]
pub enum Change {
    Hold,
    Resume,
    Feed(u8),
    Rapid(u8),
    Adaptive(u8),
    /// The next line comes only when the queue is empty.
    Starve,
}

/// The load after each step, and whether it was a take-up.
pub type Steps = Vec<([i8; 3], bool)>;

/// What a run gave.
#[derive(Debug)]
pub struct Run {
    pub checker: Checker,
    pub steps: Steps,
}

/// Runs lines; `changes` are in the order of the numbers of their events.
pub fn run<const QUEUE: usize, R: PathRamp>(
    axes: [Facts; 3],
    lines: &[&str],
    changes: &[(u64, Change)],
) -> Run {
    let mut machine: Machine<3, Path<3>, Backlash, QUEUE, Extended<3>, R> =
        Machine::new(config(axes));
    machine.line(b"M52 P1").unwrap();
    let mut run = Run {
        checker: Checker::new(axes),
        steps: Steps::new(),
    };
    let mut lines = lines.iter();
    let mut changes = changes.iter().peekable();
    let (mut number, mut starves) = (0_u64, false);
    loop {
        while machine.has_room() && !starves {
            let Some(line) = lines.next() else { break };
            machine.line(line.as_bytes()).unwrap();
        }
        while let Some((_, change)) = changes.next_if(|(at, _)| *at <= number) {
            match *change {
                Change::Hold => machine.hold(),
                Change::Resume => machine.resume(),
                Change::Feed(percent) => machine.set_feed_override(percent),
                Change::Rapid(percent) => machine.set_rapid_override(percent),
                Change::Adaptive(percent) => machine.set_adaptive_feed(percent),
                Change::Starve => starves = true,
            }
        }
        number += 1;
        match machine.next_event() {
            Some(Event::Step(step)) => {
                let is_take_up = machine.origin() == Origin::TakeUp;
                run.checker.wait(step.wait_ticks);
                if !is_take_up {
                    let segment = machine.executing().unwrap();
                    run.checker.step(segment, step.delta);
                }
                run.steps.push((step.delta, is_take_up));
            }
            Some(Event::Dwell { wait_ticks }) => run.checker.wait(wait_ticks),
            Some(_) => {}
            None if machine.is_held() => {
                machine.resume();
                machine.set_adaptive_feed(100);
            }
            None if starves => starves = false,
            None if lines.len() == 0 && machine.has_room() => break,
            None => {}
        }
        assert!(number < 20_000_000, "no progress");
    }
    run.checker.finish();
    run
}
