//! The three crates give the same events as the machine that is composed of them.

use husillo_gcode::Dialect;
use husillo_interp::Scale;
use husillo_line_to_events::{Controller, Failure};
use husillo_machine::{Axis, Config, Equipment, Event, Machine};

const TIMER_HZ: u32 = 1_000_000;

const PROGRAM: [&str; 8] = [
    "G21 G90 G94 F60",
    "G0 X3 Y-1 Z0.5",
    "G1 X5 Y2.125 F37.5",
    "G2 X8 Y5.125 I3",
    "G3 X8 Y5.125 I-0.333 J0.25 Z1.75 P2",
    "G18 G2 X9 Z2.75 I1",
    "G17 G1 X0 Y0 Z0 F1000",
    "G2 X0.0001 I0.0002",
];

fn scales() -> [Scale; 3] {
    [(140, 1), (1_000_000, 107), (1000, 1)].map(|(nm, steps)| Scale::new(nm, steps).unwrap())
}

#[test]
fn steps_are_those_of_the_machine() {
    for scale in scales() {
        // Fast enough that the axes never limit the speed.
        let axis = Axis {
            scale,
            travel: None,
            max_rate_hz: 1_000_000_000,
            backlash_steps: 0,
            ramp: None,
        };
        let mut machine: Machine<3> = Machine::new(Config {
            axes: [axis; 3],
            timer_hz: TIMER_HZ,
            dialect: Dialect::RS274,
            arc_tolerance: None,
            rapid: Some(husillo_gcode::Nm(200_000_000)),
            top_feed: None,
            spindle_counts: None,
            corner_deviation: None,
            equipment: Equipment::NONE,
        });
        let mut controller = Controller::new(Dialect::RS274, scale, TIMER_HZ, 200_000_000);
        for line in PROGRAM {
            let mut steps = Vec::new();
            let mut ticks = 0_u64;
            for command in controller.line(line.as_bytes()).unwrap() {
                let Some(path) = controller.begin(&command).unwrap() else {
                    continue;
                };
                for (wait, step) in path {
                    ticks += wait;
                    steps.push(step.deltas::<3>());
                }
            }
            machine.line(line.as_bytes()).unwrap();
            let mut expected = Vec::new();
            let mut expected_ticks = 0_u64;
            while let Some(event) = machine.next_event() {
                match event {
                    Event::Step(step) => {
                        expected_ticks += u64::from(step.wait_ticks);
                        expected.push(step.delta);
                    }
                    Event::Dwell { wait_ticks } => expected_ticks += u64::from(wait_ticks),
                    other => panic!("{other:?}"),
                }
            }
            assert_eq!(steps, expected, "{line}");
            // The machine also keeps fractions of a tick and of a nanometre.
            assert!(
                ticks.abs_diff(expected_ticks) <= 2,
                "{line}: {ticks}, {expected_ticks}"
            );
        }
    }
}

#[test]
fn wrong_lines_say_so() {
    let mut controller = Controller::new(Dialect::RS274, scales()[0], TIMER_HZ, 200_000_000);
    assert!(matches!(controller.line(b"G1 X"), Err(Failure::Program(_))));
    // 2^31 steps are 300 m.
    let far = controller.line(b"G0 X400000").unwrap().next().unwrap();
    assert_eq!(controller.begin(&far).err(), Some(Failure::TooFar));
}
