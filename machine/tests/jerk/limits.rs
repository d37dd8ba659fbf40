//! Limits, ends and events.

use husillo_planner::Ramp;
use proptest::prelude::*;

use crate::machines::{Change, Facts, MACHINES, run};
use husillo_machine::SmoothRamp;

/// Corners, tangents, arcs, chords and short moves; the highest speed is 100 mm/s.
const PART: [&str; 20] = [
    "G1 X3 F3000",
    "G1 X6 F6000",
    "G1 X8 Y0.05",
    "G3 X9 Y1.05 J1 F4800",
    "G1 Y2",
    "G1 X8.98 Y2.02",
    "G1 X8.95 Y2.04",
    "G1 X8.9 Y2.06",
    "G1 X8.85 Y2.07",
    "G1 X8.8 Y2.08",
    "G1 X5 Y3 Z0.2 F1500",
    "G0 Z1",
    "G0 X4.9",
    "G1 Z0.99 F600",
    "G2 X4.9 Y3 I-0.5",
    "G61.1",
    "G1 X4.8 Y3.1 F6000",
    "G1 X4.7 Y3",
    "G64",
    "G0 X0 Y0 Z0",
];
const TOP: f64 = 180e6;

fn same_steps_as_without<const QUEUE: usize>(axes: [Facts; 3], changes: &[(u64, Change)]) {
    let smooth = run::<QUEUE, SmoothRamp>(axes, &PART, changes);
    let plain = run::<QUEUE, Ramp>(axes, &PART, &[]);
    assert!(smooth.steps == plain.steps, "{axes:?}");
    smooth.checker.check(TOP);
}

#[test]
fn the_path_keeps_its_limits_with_queues_of_any_size() {
    for axes in MACHINES {
        same_steps_as_without::<1>(axes, &[]);
        same_steps_as_without::<3>(axes, &[]);
        same_steps_as_without::<16>(axes, &[]);
        same_steps_as_without::<64>(axes, &[]);
    }
}

/// The checker sees a machine without limited jerk.
#[test]
fn the_checker_sees_a_trapezoid() {
    let [axes, ..] = MACHINES;
    let plain = run::<16, Ramp>(axes, &PART, &[]);
    let [_, acceleration, jerk] = plain.checker.ratios(TOP);
    assert!(jerk > 2.0, "{jerk}");
    assert!(acceleration > 1.0, "{acceleration}");
}

/// Without a jerk, `SmoothRamp` makes the events of `Ramp`.
#[test]
fn no_jerk_is_a_ramp() {
    let axes = MACHINES[1].map(|facts| Facts {
        jerk: None,
        ..facts
    });
    let changes = [(900, Change::Feed(150)), (20_000, Change::Hold)];
    let smooth = run::<8, SmoothRamp>(axes, &PART, &changes);
    let plain = run::<8, Ramp>(axes, &PART, &changes);
    assert_eq!(smooth.checker.seconds(), plain.checker.seconds());
    assert!(smooth.steps == plain.steps);
}

/// A rapid override acts within the jerk, at any event, and feeds do not notice it.
#[test]
fn a_rapid_override_keeps_the_limits() {
    let [axes, ..] = MACHINES;
    let lines = ["G0 X20", "G1 X10 F3000", "G0 X0"];
    let seconds = |changes: &[(u64, Change)]| {
        let run = run::<4, SmoothRamp>(axes, &lines, changes);
        run.checker.check(TOP);
        run.checker.seconds()
    };
    let full = seconds(&[]);
    // 30 mm at 100 mm/s, and 10 mm at 50 mm/s between them.
    let quarter = seconds(&[(0, Change::Rapid(25))]);
    assert!((0.75..1.0).contains(&(quarter - full)), "{quarter} {full}");
    // In the first rapid, and back in the second one.
    let changes = [(150_000, Change::Rapid(25)), (700_000, Change::Rapid(100))];
    let between = seconds(&changes);
    assert!(full + 0.3 < between && between < quarter, "{between}");
    // The feed is from event 400 000 to 600 000.
    let changes = [(420_000, Change::Rapid(25)), (560_000, Change::Rapid(100))];
    assert_eq!(seconds(&changes), full);
}

fn change() -> impl Strategy<Value = Change> {
    prop_oneof![
        3 => Just(Change::Hold),
        2 => Just(Change::Resume),
        2 => (10_u8..201).prop_map(Change::Feed),
        2 => (5_u8..101).prop_map(Change::Rapid),
        2 => (0_u8..201).prop_map(Change::Adaptive),
        2 => Just(Change::Starve),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    /// Holds, resumes, overrides and an empty queue at any event neither exceed a limit nor change
    /// a step.
    #[test]
    fn disturbances_keep_the_limits(
        machine in 0..MACHINES.len(),
        is_long: bool,
        changes in prop::collection::vec((0_u64..700_000, change()), 0..40),
    ) {
        let mut changes = changes;
        changes.sort_by_key(|(at, _)| *at);
        if is_long {
            same_steps_as_without::<32>(MACHINES[machine], &changes);
        } else {
            same_steps_as_without::<2>(MACHINES[machine], &changes);
        }
    }
}
