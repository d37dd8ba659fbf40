//! Machines of four to six axes: what a feed measures, exact ends, limits and ramps of each axis.

use husillo_gcode::{Axes, Dialect, Nm};
use husillo_machine::{
    Axis, AxisRamp, Config, Equipment, Event, Machine, MoveError, Refused, Scale,
};
use proptest::prelude::*;
use std::collections::VecDeque;

const LETTERS: [char; 6] = ['X', 'Y', 'Z', 'A', 'U', 'C'];

/// Linear axes of 100 steps/mm, rotary ones of 80 steps per degree.
fn config(timer_hz: u32, max_rate_hz: u32, ramp: Option<AxisRamp>) -> Config<6> {
    let axes = Axes::new(b"XYZAUC").unwrap();
    let axis = |number: usize| Axis {
        scale: match axes.is_rotary(number) {
            true => Scale::new(1_000_000, 80).unwrap(),
            false => Scale::new(1_000_000, 100).unwrap(),
        },
        travel: None,
        max_rate_hz,
        backlash_steps: 0,
        ramp,
    };
    Config {
        axes: [0, 1, 2, 3, 4, 5].map(axis),
        timer_hz,
        dialect: Dialect::RS274.with_axes(axes),
        arc_tolerance: None,
        rapid: None,
        top_feed: None,
        corner_deviation: None,
        spindle_counts: None,
        equipment: Equipment::NONE,
    }
}

/// Steps over which a rate is measured. Steps of an axis lie at events of the longest axis, so a
/// single interval may be shorter than that of its rate.
const WINDOW: usize = 20;

/// Seconds until all is made, and the largest rate of each axis in steps/s over some steps.
fn drain(machine: &mut Machine<6>) -> (f64, [f64; 6]) {
    let hz = f64::from(machine.config().timer_hz);
    let (mut ticks, mut fastest) = (0_u64, [0.0_f64; 6]);
    let mut last: [VecDeque<u64>; 6] = Default::default();
    while let Some(event) = machine.next_event() {
        match event {
            Event::Step(step) => {
                ticks += u64::from(step.wait_ticks);
                for axis in 0..6 {
                    if step.delta[axis] != 0 {
                        last[axis].push_back(ticks);
                        if last[axis].len() > WINDOW {
                            let before = last[axis].pop_front().unwrap();
                            let rate = WINDOW as f64 * hz / (ticks - before).max(1) as f64;
                            fastest[axis] = fastest[axis].max(rate);
                        }
                    }
                }
            }
            Event::Dwell { wait_ticks } => ticks += u64::from(wait_ticks),
            _ => {}
        }
    }
    (ticks as f64 / hz, fastest)
}

fn norm(ways: &[f64]) -> f64 {
    ways.iter().map(|way| way * way).sum::<f64>().sqrt()
}

/// Minutes of a straight move by the rule of LinuxCNC, in floating point.
fn minutes(ways: &[f64; 6], feed: f64) -> f64 {
    let [x, y, z, a, u, c] = *ways;
    let xyz = norm(&[x, y, z]);
    let fed = match (xyz > 0.0, u != 0.0) {
        (true, _) => xyz,
        (false, true) => u.abs(),
        (false, false) => norm(&[a, c]),
    };
    fed / feed
}

fn line(head: &str, ways: &[f64; 6]) -> String {
    let mut line = head.to_owned();
    for (letter, way) in LETTERS.iter().zip(ways) {
        if *way != 0.0 {
            line += &format!(" {letter}{way:.2}");
        }
    }
    line
}

fn ways() -> impl Strategy<Value = [f64; 6]> {
    // Hundredths, so that the text is exact; about half of the axes stand.
    prop::array::uniform6(prop_oneof![Just(0_i32), -500..500])
        .prop_map(|ways| ways.map(|way| f64::from(way) / 100.0))
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    /// F measures X, Y and Z, without them U, without it the rotary axes; every axis ends exactly.
    #[test]
    fn feed_is_that_of_linuxcnc(ways in ways(), feed in 10..2000_i32) {
        let mut machine: Machine<6> = Machine::new(config(1_000_000, 1_000_000, None));
        machine.line(line(&format!("G91 G1 F{feed}"), &ways).as_bytes()).unwrap();
        let (seconds, _) = drain(&mut machine);
        let expected = minutes(&ways, feed.into()) * 60.0;
        prop_assert!((seconds - expected).abs() < 2e-6 + 1e-6 * expected, "{seconds} {expected}");
        let ends = machine.position_steps();
        for axis in 0..6 {
            let per_unit = if [3, 5].contains(&axis) { 80.0 } else { 100.0 };
            let exact = ways[axis] * per_unit;
            prop_assert!((f64::from(ends[axis]) - exact).abs() < 0.5 + 1e-6, "{axis}");
        }
    }

    /// Under G93 a move takes its time, whatever moves.
    #[test]
    fn inverse_time_is_exact(ways in ways(), per_minute in 1..200_u32) {
        prop_assume!(ways.iter().any(|way| way.abs() > 0.02));
        let mut machine: Machine<6> = Machine::new(config(1_000_000, 1_000_000, None));
        let head = format!("G91 G93 G1 F{per_minute}");
        machine.line(line(&head, &ways).as_bytes()).unwrap();
        let (seconds, _) = drain(&mut machine);
        prop_assert!((seconds - 60.0 / f64::from(per_minute)).abs() < 2e-6, "{seconds}");
    }

    /// With ramps no axis exceeds its own rate; a combined move is as slow as its slowest axis.
    #[test]
    fn each_axis_keeps_its_limits(moves in prop::collection::vec(ways(), 1..6)) {
        let ramp = AxisRamp {
            acceleration_hz_per_s: 20_000,
            start_rate_hz: 100,
            jerk_hz_per_s2: None,
            junction_hz: Some(200),
        };
        let mut config = config(8_000_000, 2_000, Some(ramp));
        config.axes[3].max_rate_hz = 900;
        let mut machine: Machine<6> = Machine::new(config);
        let (mut most, mut ends) = ([0.0_f64; 6], [0.0_f64; 6]);
        for ways in &moves {
            let text = line("G91 G1 F100000", ways);
            while machine.line(text.as_bytes()) == Err(Refused::Busy) {
                let (_, fastest) = drain(&mut machine);
                for axis in 0..6 {
                    most[axis] = most[axis].max(fastest[axis]);
                }
            }
            for axis in 0..6 {
                ends[axis] += ways[axis];
            }
        }
        let (_, fastest) = drain(&mut machine);
        for axis in 0..6 {
            let limit = f64::from(machine.config().axes[axis].max_rate_hz);
            let rate = fastest[axis].max(most[axis]);
            // 20 intervals take the time of more than 19 (the axis steps at events of another
            // one), and a move may have a part of a step too many: one in 64. The README of the
            // crate has the reasons, `tests/borders.rs` each interval.
            let most = limit * (1.0 + 1.0 / WINDOW as f64) * (1.0 + 1.0 / 64.0);
            prop_assert!(rate <= most, "axis {axis}: {rate} Hz of {limit}");
            let per_unit = if [3, 5].contains(&axis) { 80.0 } else { 100.0 };
            let end = f64::from(machine.position_steps()[axis]);
            prop_assert!((end - ends[axis] * per_unit).abs() < 0.5 + 1e-6);
        }
    }
}

/// The feed of an arc is that of its helix in X, Y and Z; the other axes move in proportion to the
/// angle and end exactly.
#[test]
fn an_arc_carries_the_other_axes() {
    let mut machine: Machine<6> = Machine::new(config(1_000_000, 1_000_000, None));
    machine
        .line(b"G2 X10 Y-10 I0 J-10 Z2 A-90 U3 C720 F300")
        .unwrap();
    let (mut ticks, mut middle) = (0_u64, None);
    while let Some(event) = machine.next_event() {
        if let Event::Step(step) = event {
            ticks += u64::from(step.wait_ticks);
            let at = machine.position_steps();
            // The middle of the quarter turn.
            if middle.is_none() && -at[1] >= 293 {
                middle = Some(at);
            }
        }
    }
    let arc = core::f64::consts::FRAC_PI_2 * 10.0;
    let seconds = arc.hypot(2.0) / 300.0 * 60.0;
    let found = ticks as f64 / 1e6;
    assert!(
        (found / seconds - 1.0).abs() < 1e-3,
        "{found} s, not {seconds}"
    );
    assert_eq!(
        machine.position_steps(),
        [1000, -1000, 200, -7200, 300, 57_600]
    );
    let middle = middle.unwrap();
    for (axis, half) in [(2, 100), (3, -3600), (4, 150), (5, 28_800)] {
        assert!((middle[axis] - half).abs() <= 60, "{axis}: {middle:?}");
    }
}

#[test]
fn a_turn_beyond_the_travel_is_refused() {
    let mut config = config(1_000_000, 10_000, None);
    config.axes[3].travel = Some([Nm(-90_000_000), Nm(90_000_000)]);
    let mut machine: Machine<6> = Machine::new(config);
    let refused = machine.line(b"G0 A90.1 C9999");
    let limit = Nm(90_000_000);
    let position = Nm(90_100_000);
    let error = MoveError::Travel {
        axis: 3,
        position,
        limit,
    };
    assert_eq!(refused, Err(Refused::Move(error)));
    machine.line(b"G0 A-90 C9999").unwrap();
}

/// A wrapped axis goes on turning: 30 turns and back by the sign of its words.
#[test]
fn a_wrapped_axis_turns_without_end() {
    let mut config = config(1_000_000, 10_000, None);
    let axes = config.dialect.axes().with_wrapped(b"C").unwrap();
    config.dialect = Dialect::RS274.with_axes(axes);
    let mut machine: Machine<6> = Machine::new(config);
    for turn in 0..30 {
        for word in ["C120", "C240", "C0"] {
            while machine.line(format!("G0 {word}").as_bytes()) == Err(Refused::Busy) {
                drain(&mut machine);
            }
        }
        drain(&mut machine);
        assert_eq!(machine.position_steps()[5], (turn + 1) * 360 * 80);
    }
    machine.line(b"G0 C-359").unwrap();
    drain(&mut machine);
    assert_eq!(machine.position_steps()[5], (30 * 360 - 1) * 80);
}
