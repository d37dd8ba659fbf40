//! Re-emitted steps cross the same backlash as the motion, including one that a map describes.

mod common;

use common::config;
use husillo_backlash::{BacklashMap, Flank, MappedBacklash};
use husillo_interp::Path;
use husillo_machine::{
    AxisEncoder, ClosedLoop, Config, Event, Followed, Machine, OnLoss, StepEvent,
};
use proptest::prelude::*;

type Mapped = MappedBacklash<Vec<i32>, Vec<u32>>;

/// X on a screw whose backlash at the load position is that of the map, and disturbances of its
/// motor.
struct Screw {
    map: BacklashMap<Vec<i32>, Vec<u32>>,
    motor: i32,
    tool: i32,
}

impl Screw {
    fn go(&mut self, steps: i32, load: [i32; 3]) {
        self.motor += steps;
        let play = self.map.steps([load[0], load[1]]) as i32;
        self.tool = self.tool.clamp(self.motor, self.motor + play);
    }
}

/// The backlash of X grows from 40 to 80 steps over 400 steps of Y, while the machine file says 5.
/// Each disturbance moves the motor of X after the given number of events. Returns the final
/// positions of motor and tool, and how often a loss was reported and corrected.
fn run(lines: &[&str], pushes: &[(u32, i32)]) -> (i32, i32, [u32; 2]) {
    let map = BacklashMap::new([0, 1], [vec![0], vec![0, 400]], vec![40, 80]).unwrap();
    let none = BacklashMap::new([0, 1], [vec![0], vec![0]], vec![0]).unwrap();
    let plain: Config<3> = config();
    let axes = plain.axes.map(|axis| husillo_machine::Axis {
        backlash_steps: 5,
        ..axis
    });
    let backlash = [map.clone(), none.clone(), none].map(|map| Mapped::new(map, Flank::Positive));
    let machine: Machine<3, Path<3>, Mapped, 8> =
        Machine::with_backlash(Config { axes, ..plain }, backlash);
    let encoder = AxisEncoder {
        counts: 1,
        steps: 1,
        tolerance_steps: 2,
        on_loss: OnLoss::Correct,
        correction_rate_hz: 100,
        settle_ticks: 1000,
        attempts: 3,
    };
    let mut axes = ClosedLoop::new(machine, [Some(encoder), None, None]);
    let mut screw = Screw {
        map,
        motor: 0,
        tool: 0,
    };
    let mut pushes = pushes.iter().peekable();
    let (mut events, mut told) = (0, [0; 2]);
    for line in lines {
        axes.machine_mut().line(line.as_bytes()).unwrap();
        while let Some(entry) = axes.next_event(&[screw.motor.into(), 0, 0]) {
            match entry {
                Followed::Event(Event::Step(StepEvent { delta, .. })) => {
                    events += 1;
                    screw.go(delta[0].into(), axes.machine().position_steps());
                }
                Followed::Lost { .. } => told[0] += 1,
                Followed::Corrected { .. } => told[1] += 1,
                Followed::Event(_) => {}
                Followed::Stalled { .. } => panic!("nothing blocks it"),
            }
            assert!(events < 100_000, "hangs");
            if let Some((_, push)) = pushes.next_if(|(at, _)| *at <= events) {
                screw.go(*push, axes.machine().position_steps());
            }
        }
    }
    (screw.motor, screw.tool, told)
}

#[test]
fn across_the_backlash_of_the_map_and_back() {
    // To 100, and back to 50 at Y 200, where the backlash is 60.
    let lines = ["G1 X0.014 Y0.028 F1.2", "G1 X0.007"];
    let (motor, tool, told) = run(&lines, &[]);
    assert_eq!((motor, tool, told), (50 - 60, 50, [0, 0]));
    // At its end it is pushed by 8. The tool went with it and returns only from beyond the whole
    // backlash.
    assert_eq!(run(&lines, &[(310, -8)]), (motor, tool, [1, 1]));
}

/// On the negative flank, along Y, X gives up a step now and then because of less backlash. This is
/// no reversal of X.
#[test]
fn what_the_map_owes_is_no_turn() {
    let lines = ["G1 X0.014 Y0.056 F1.2", "G1 X0.007", "G1 Y0.014"];
    let (motor, tool, _) = run(&lines, &[]);
    assert_eq!((motor, tool), (50 - 50, 50));
    for push in [-8, 8] {
        assert_eq!(run(&lines, &[(700, push)]), (motor, tool, [1, 1]));
    }
}

/// With counts of three steps and a tolerance of one step: no loss is reported, and the motion
/// ends.
#[test]
fn a_tolerance_finer_than_a_count_is_a_count() {
    let machine: Machine<3> = Machine::new(config());
    let encoder = AxisEncoder {
        counts: 1,
        steps: 3,
        tolerance_steps: 1,
        on_loss: OnLoss::Stop,
        correction_rate_hz: 100,
        settle_ticks: 1000,
        attempts: 3,
    };
    let mut axes = ClosedLoop::new(machine, [Some(encoder), None, None]);
    axes.machine_mut().line(b"G1 X0.014 F1.2").unwrap();
    let (mut motor, mut entries) = (0_i64, 0);
    while let Some(entry) = axes.next_event(&[motor.div_euclid(3), 0, 0]) {
        entries += 1;
        assert!(entries < 1000, "hangs");
        match entry {
            Followed::Event(Event::Step(step)) => motor += i64::from(step.delta[0]),
            Followed::Event(_) => {}
            told => panic!("{told:?}"),
        }
    }
    assert_eq!(motor, 100);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(60))]

    /// Pushed at any event in either direction, the motor ends at its expected position, and so
    /// does a tool that was carried along.
    #[test]
    fn pushed_anywhere(at in 1u32..900, push in prop_oneof![-30i32..-3, 4i32..30]) {
        let lines = ["G1 X0.014 Y0.056 F1.2", "G1 X0.007", "G1 Y0.014", "G1 X0.021 Y0.028"];
        let (motor, tool, _) = run(&lines, &[]);
        let (pushed, carried, told) = run(&lines, &[(at, push)]);
        prop_assert_eq!((pushed, carried), (motor, tool));
        prop_assert_eq!(told[0], told[1]);
    }
}
