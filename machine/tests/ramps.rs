//! Machines with acceleration ramps: an independent checker examines the events.

mod common;

use common::{BACKLASH_STEPS, Screw};
use husillo_backlash::Backlash;
use husillo_gcode::Dialect;
use husillo_interp::Path;
use husillo_machine::{Axis, AxisRamp, Config, Equipment, Event, Machine, Origin, Scale};
use proptest::prelude::*;

const TIMER_HZ: u32 = 1_000_000;
/// Steps of a micrometre; 100 mm/s^2, up to 50 mm/s.
const ACCELERATION: f64 = 100_000.0;

type Micromill = Machine<3, Path<3>, Backlash, 64>;

fn axis(backlash_steps: u32) -> Axis {
    Axis {
        scale: Scale::new(1000, 1).unwrap(),
        travel: None,
        max_rate_hz: 50_000,
        backlash_steps,
        ramp: Some(AxisRamp {
            acceleration_hz_per_s: ACCELERATION as u32,
            start_rate_hz: 0,
            jerk_hz_per_s2: None,
            junction_hz: None,
        }),
    }
}

fn config(backlash_steps: [u32; 3]) -> Config<3> {
    Config {
        axes: backlash_steps.map(axis),
        timer_hz: TIMER_HZ,
        dialect: Dialect::RS274,
        arc_tolerance: None,
        rapid: None,
        top_feed: None,
        corner_deviation: None,
        equipment: Equipment::NONE,
        spindle_counts: None,
    }
}

/// The steps of a run: the time in seconds, and the load position after each step.
#[derive(Default)]
struct Trace {
    ticks: u64,
    points: Vec<(f64, [i32; 3])>,
    take_ups: Vec<f64>,
}

impl Trace {
    fn event(&mut self, machine: &Micromill, event: &Event<3>) {
        match event {
            Event::Step(step) => {
                self.ticks += u64::from(step.wait_ticks);
                let time = self.ticks as f64 / f64::from(TIMER_HZ);
                if machine.origin() == Origin::TakeUp {
                    self.take_ups.push(time);
                } else {
                    self.points.push((time, machine.position_steps()));
                }
            }
            Event::Dwell { wait_ticks } => self.ticks += u64::from(*wait_ticks),
            _ => {}
        }
    }

    fn seconds(&self) -> f64 {
        self.ticks as f64 / f64::from(TIMER_HZ)
    }

    /// Position of an axis at a time, interpolated between two steps.
    fn at(&self, axis: usize, time: f64) -> f64 {
        let after = self.points.partition_point(|(at, _)| *at <= time);
        let after_point = self.points.get(after);
        let before_point = after
            .checked_sub(1)
            .and_then(|before| self.points.get(before));
        match (before_point, after_point) {
            (None, Some(_)) => 0.0,
            (Some(before), None) => f64::from(before.1[axis]),
            (Some(before), Some(after)) => {
                let part = (time - before.0) / (after.0 - before.0);
                let (from, to) = (f64::from(before.1[axis]), f64::from(after.1[axis]));
                from + part * (to - from)
            }
            (None, None) => 0.0,
        }
    }

    /// No axis changes its speed faster than permitted, nor by more than `jump` (steps/s) at once.
    /// Positions are known to a step, so a second difference over 20 ms is known to 4 steps: a
    /// tenth of the change due to the acceleration.
    fn check_acceleration(&self, jump: f64) {
        let span = 0.02;
        let samples = (self.seconds() / span * 4.0) as usize;
        for axis in 0..3 {
            for sample in 4..samples {
                let time = sample as f64 * span / 4.0;
                let second = self.at(axis, time + span) - 2.0 * self.at(axis, time)
                    + self.at(axis, time - span);
                let most = ACCELERATION * span * span + jump * span + 4.0;
                assert!(
                    second.abs() <= most,
                    "axis {axis} at {time} s: {second} of {most}"
                );
            }
        }
    }

    /// Path speed in steps/s over a window around a time.
    fn speed(&self, time: f64, window: f64) -> f64 {
        let way = [0, 1, 2]
            .map(|axis| self.at(axis, time + window / 2.0) - self.at(axis, time - window / 2.0));
        way.iter().map(|d| d * d).sum::<f64>().sqrt() / window
    }
}

/// Takes the lines as far ahead as there is room and pulls all events. `each` may act on the
/// machine before each event.
fn run(
    machine: &mut Micromill,
    lines: &[String],
    mut each: impl FnMut(&mut Micromill, usize),
) -> Trace {
    let mut trace = Trace::default();
    let mut lines = lines.iter();
    let mut next = lines.next();
    for number in 0.. {
        while let Some(line) = next {
            if !machine.has_room() {
                break;
            }
            machine.line(line.as_bytes()).unwrap();
            next = lines.next();
        }
        each(machine, number);
        match machine.next_event() {
            Some(event) => trace.event(machine, &event),
            None if machine.is_held() => machine.resume(),
            None => break,
        }
    }
    assert!(next.is_none());
    trace
}

fn lines(text: &str) -> Vec<String> {
    text.lines().map(str::to_owned).collect()
}

#[test]
fn a_move_takes_the_time_of_its_ramps() {
    let mut machine = Micromill::new(config([0; 3]));
    let trace = run(&mut machine, &lines("G1 X20 F1200"), |_, _| {});
    // 20 mm at 20 mm/s with 100 mm/s^2: 1 s and 0.2 s for the ramps.
    assert!((trace.seconds() - 1.2).abs() < 2e-3, "{}", trace.seconds());
    trace.check_acceleration(0.0);
    assert!((trace.speed(0.6, 0.1) - 20_000.0).abs() < 20.0);
}

#[test]
fn short_segments_run_without_a_stop() {
    // A circle of 10 mm in 20 um segments at 20 mm/s, with corners of 0.1 degrees.
    let segments = 3142;
    let mut text = String::from("G64 P0.001 F1200\n");
    for k in 0..=segments {
        let angle = f64::from(k) * std::f64::consts::TAU / f64::from(segments);
        let (y, x) = angle.sin_cos();
        text += &format!("G1 X{:.4} Y{:.4}\n", 10.0 * (x - 1.0), 10.0 * y);
    }
    let mut machine = Micromill::new(config([0; 3]));
    let trace = run(&mut machine, &lines(&text), |_, _| {});
    assert_eq!(machine.position_steps(), [0; 3]);
    // 64 segments of 20 um are 1.28 mm: enough to stop from 16 mm/s.
    let fastest = (2.0 * 100.0 * 63.0 * 0.02_f64).sqrt() * 1000.0;
    for tenth in 4..(trace.seconds() * 10.0) as i32 - 4 {
        let speed = trace.speed(f64::from(tenth) / 10.0, 0.05);
        assert!(
            speed > 0.97 * fastest && speed < 20_020.0,
            "{tenth}: {speed}"
        );
    }
}

#[test]
fn corners_are_stops_slower_or_faster_by_mode() {
    let square = "G1 X5 F1200\nG1 Y5\nG1 X0\nG1 Y0\n";
    let time = |mode: &str| {
        let mut machine = Micromill::new(config([0; 3]));
        run(
            &mut machine,
            &lines(&format!("{mode}\n{square}")),
            |_, _| {},
        )
        .seconds()
    };
    let stop = 4.0 * (5.0 / 20.0 + 0.2);
    assert!((time("G61.1") - stop).abs() < 5e-3, "{}", time("G61.1"));
    assert!((time("G61") - stop).abs() < 5e-3);
    let [narrow, wide] = [time("G64 P0.01"), time("G64 P0.2")];
    assert!(
        wide < narrow && narrow < stop - 0.01,
        "{wide} {narrow} {stop}"
    );
    // A straight line in pieces has no corner, except in the strictest mode.
    let pieces = "G1 X5 F1200\nG1 X10\nG1 X20\n";
    let mut machine = Micromill::new(config([0; 3]));
    let trace = run(&mut machine, &lines(&format!("G61\n{pieces}")), |_, _| {});
    assert!((trace.seconds() - 1.2).abs() < 2e-3);
}

#[test]
fn a_corner_jumps_by_no_more_than_it_may() {
    let mut config = config([0; 3]);
    for axis in &mut config.axes {
        axis.ramp.as_mut().unwrap().junction_hz = Some(2000);
    }
    let mut machine = Micromill::new(config);
    let program =
        "G1 X5 F1200\nG1 Y5\nG1 X0 Y2\nG2 X0 Y-2 I0 J-2\nG1 X3\nG3 X3 Y2 I0 J2 Z1\nG1 Y5 Z0";
    let trace = run(&mut machine, &lines(program), |_, _| {});
    trace.check_acceleration(2000.0);
}

#[test]
fn arcs_stay_within_the_acceleration_and_stop_before_take_up() {
    let mut machine = Micromill::new(config(BACKLASH_STEPS));
    // The last arc reverses Y at its first step, at a corner that would be passed otherwise.
    let program = "G64 P0.2\nG1 X5 Y2 F1200\nG3 X5 Y2 I-3 J0 P2\nG2 X6 Y3 I1 J0\nG1 X9 Y3.5\n\
                   G2 X9 Y2.5 I-0.5 J-0.5\nG1 X0 Y0";
    let mut screw = Screw::new();
    let mut trace = Trace::default();
    for line in program.lines() {
        machine.line(line.as_bytes()).unwrap();
    }
    let mut was_take_up = false;
    let mut waits = Vec::new();
    while let Some(event) = machine.next_event() {
        if let Event::Step(step) = event {
            screw.step(step.delta);
            assert_eq!(screw.tool, machine.position_steps().map(i64::from));
            let is_take_up = machine.origin() == Origin::TakeUp;
            waits.push((is_take_up, was_take_up, step.wait_ticks));
            was_take_up = is_take_up;
        }
        trace.event(&machine, &event);
    }
    assert!(trace.take_ups.len() > 1457);
    // From rest a step takes sqrt(2 / a) = 4.5 ms. The path stands before and after each take-up,
    // which has ramps itself.
    for (k, (is_take_up, was_take_up, wait)) in waits.iter().enumerate() {
        if is_take_up != was_take_up {
            assert!(*wait > 4000, "event {k}: {wait} after the change");
            assert!(
                k == 0 || waits[k - 1].2 > 4000,
                "event {k}: {} before it",
                waits[k - 1].2
            );
        }
    }
    trace.check_acceleration(15_000.0);
}

#[test]
fn moves_to_the_same_place_do_not_undo_stops() {
    for program in [
        "G1 X10 F1200\nG1 X10",
        "G61.1\nG1 X10 F1200\nG1 X10\nG1 Y10",
        "G61\nG1 X10 F1200\nG1 X10\nG1 Y10",
        "G1 X5 F1200\nG93 G1 X5 F600\nG94 G1 X10 F1200",
        "G1 X5 F1200\nG2 I0.0001\nG1 Y5",
    ] {
        let mut machine = Micromill::new(config([0; 3]));
        run(&mut machine, &lines(program), |_, _| {}).check_acceleration(0.0);
    }
    // On a straight line they do not matter.
    let program = lines("G61\nG1 X10 F1200\nG1 X10\nG1 X20");
    let trace = run(&mut Micromill::new(config([0; 3])), &program, |_, _| {});
    assert!((trace.seconds() - 1.2).abs() < 2e-3);
    // From rest again.
    let mut machine = Micromill::new(config([0; 3]));
    run(&mut machine, &lines("G1 X10 F1200"), |_, _| {});
    let trace = run(&mut machine, &lines("G1 X10\nG1 X20"), |_, _| {});
    assert!((trace.seconds() - 0.7).abs() < 2e-3);
}

#[test]
fn feeds_beyond_the_planner_s_fastest_are_as_fast_as_the_axes() {
    for program in ["G1 X20 F999999", "G93 G1 X20 F60000"] {
        let mut machine = Micromill::new(config([0; 3]));
        let trace = run(&mut machine, &lines(program), |_, _| {});
        // Up to 44.7 mm/s and down again.
        let seconds = 2.0 * (20.0 / 100.0_f64).sqrt();
        assert!(
            (trace.seconds() - seconds).abs() < 2e-3,
            "{}",
            trace.seconds()
        );
    }
}

#[test]
fn a_hold_lets_a_take_up_slow_down() {
    let mut machine = Micromill::new(config([2000, 0, 0]));
    machine.line(b"G0 X-0.1").unwrap();
    let mut waits = Vec::new();
    while let Some(event) = machine.next_event() {
        let Event::Step(step) = event else { continue };
        waits.push(step.wait_ticks);
        if waits.len() == 1000 {
            machine.hold();
        }
    }
    assert!(machine.is_held());
    assert_eq!(waits.len(), 2000);
    assert!(waits[1999].abs_diff(4472) <= 2);
    machine.resume();
    assert!(machine.next_event().is_some());
}

#[test]
fn an_axis_without_a_junction_rate_does_not_jump() {
    let mut config = config([0; 3]);
    config.axes[0].ramp.as_mut().unwrap().junction_hz = Some(5000);
    let mut machine = Micromill::new(config);
    run(&mut machine, &lines("G1 Y5 F1200\nG1 Y0\nG1 X5"), |_, _| {}).check_acceleration(0.0);
}

#[test]
fn an_arc_starts_as_slowly_as_its_slower_axis() {
    let mut config = config([0; 3]);
    config.axes[0].ramp = None;
    let mut machine = Micromill::new(config);
    run(&mut machine, &lines("G2 X5 Y5 I5 J0 F1200"), |_, _| {}).check_acceleration(0.0);
}

#[test]
fn an_abort_ends_a_hold_and_keeps_the_mode() {
    let mut machine: Machine<3, Path<3>, Backlash, 1> = Machine::new(config([0; 3]));
    machine.line(b"M3 S100").unwrap();
    machine.line(b"G1 X10 F600").unwrap();
    machine.next_event();
    machine.next_event();
    // The mode takes effect after the move.
    machine.line(b"G61.1 G1 X11").unwrap();
    machine.hold();
    while machine.next_event().is_some() {}
    machine.abort();
    assert!(matches!(machine.next_event(), Some(Event::Output(_))));
    while machine.next_event().is_some() {}
    let mut ticks = 0;
    for line in ["G91 G1 X1", "X1"] {
        machine.line(line.as_bytes()).unwrap();
    }
    while let Some(event) = machine.next_event() {
        if let Event::Step(step) = event {
            ticks += step.wait_ticks;
        }
    }
    // Twice 1 mm at 10 mm/s with both ramps.
    assert!(ticks.abs_diff(400_000) < 4000, "{ticks}");
}

#[test]
fn a_take_up_is_as_smooth_as_its_axis() {
    let intervals = |jerk_hz_per_s2| {
        let mut config = config([2000, 0, 0]);
        config.axes[0].ramp.as_mut().unwrap().jerk_hz_per_s2 = jerk_hz_per_s2;
        let mut machine = Micromill::new(config);
        machine.line(b"G0 X-0.1").unwrap();
        let mut intervals = Vec::new();
        while let Some(Event::Step(step)) = machine.next_event() {
            if machine.origin() == Origin::TakeUp {
                intervals.push(step.wait_ticks);
            }
        }
        intervals
    };
    let [sharp, smooth] = [intervals(None), intervals(Some(500_000))];
    assert_eq!([sharp.len(), smooth.len()], [2000; 2]);
    // From rest: t = sqrt(2 / a), and t = (6 / j)^(1/3).
    assert!(sharp[0].abs_diff(4472) <= 2, "{}", sharp[0]);
    assert!(smooth[0].abs_diff(22_894) <= 2, "{}", smooth[0]);
}

#[test]
fn a_jerk_that_the_timer_is_too_slow_for_leaves_the_ramp() {
    let first = |jerk_hz_per_s2| {
        let mut config = config([2000, 0, 0]);
        config.timer_hz = 20_000;
        config.axes[0].max_rate_hz = 6000;
        let ramp = config.axes[0].ramp.as_mut().unwrap();
        (ramp.acceleration_hz_per_s, ramp.jerk_hz_per_s2) = (20_000, jerk_hz_per_s2);
        let mut machine = Micromill::new(config);
        machine.line(b"G0 X-0.1").unwrap();
        machine.next_event()
    };
    assert_eq!(first(Some(2_000_000)), first(None));
}

#[test]
fn rapids_and_outputs_stop() {
    let mut machine = Micromill::new(config([0; 3]));
    let trace = run(
        &mut machine,
        &lines("G0 X5\nM3 S100\nG0 X10\nG4 P0.1\nG1 X15 F600"),
        |_, _| {},
    );
    trace.check_acceleration(0.0);
    assert_eq!(machine.position_steps(), [15_000, 0, 0]);
}

#[test]
fn an_override_changes_the_time_of_feeds_alone() {
    let time = |percent: u8| {
        let mut machine = Micromill::new(config([0; 3]));
        machine.set_feed_override(percent);
        let feed = run(&mut machine, &lines("G1 X20 F600"), |_, _| {}).seconds();
        let rapid = run(&mut machine, &lines("G0 X0"), |_, _| {}).seconds();
        (feed, rapid)
    };
    assert!((time(100).0 - 2.1).abs() < 2e-3);
    assert!((time(200).0 - 1.2).abs() < 2e-3);
    assert!((time(10).0 - 20.01).abs() < 2e-3);
    // The fraction of a tick that the feed leaves is carried to the rapid.
    assert!((time(10).1 - time(200).1).abs() < 1.5 / f64::from(TIMER_HZ));
    // Without ramps the override acts from the next move on.
    let mut steady: Machine<3> = Machine::new(common::config());
    steady.set_feed_override(50);
    steady.line(b"G1 X0.14 F1").unwrap();
    let mut screw = Screw::new();
    let (ticks, _) = common::drain(&mut steady, &mut screw);
    assert_eq!(ticks, 2 * 8_400_000);
    // It does not exceed the rate of the axes.
    steady.set_feed_override(200);
    steady.line(b"G1 X0.28 F1.2").unwrap();
    let (ticks, _) = common::drain(&mut steady, &mut screw);
    assert!(ticks >= 1000 * 1_000_000 / 170, "{ticks}");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    /// A hold at any event brakes within the acceleration and loses no step. After a resume the
    /// same steps are made in the same order as without it.
    #[test]
    fn holds_lose_no_step(holds in prop::collection::vec(0_usize..9000, 1..4), has_backlash: bool) {
        let backlash = if has_backlash { [20, 30, 0] } else { [0; 3] };
        let program = lines(
            "G64 P0.02 F900\nG1 X3\nG1 X4 Y0.3\nG3 X4 Y4.3 I0 J2\nG1 X2 Y1 Z1\nG0 X0 Y0\nG1 Z0",
        );
        let without = run(&mut Micromill::new(config(backlash)), &program, |_, _| {});
        let mut machine = Micromill::new(config(backlash));
        let with = run(&mut machine, &program, |machine, number| {
            if holds.contains(&number) {
                machine.hold();
            }
        });
        let steps = |trace: &Trace| trace.points.iter().map(|(_, at)| *at).collect::<Vec<_>>();
        prop_assert_eq!(steps(&with), steps(&without));
        // At a corner it is fast enough for the tolerance of 20 um: v^2 = a d s / (1 - s), s <
        // 0.92.
        with.check_acceleration(8000.0);
        prop_assert!(with.seconds() >= without.seconds() - 1e-3);
    }
}
