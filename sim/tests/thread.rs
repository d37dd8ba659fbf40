//! A thread is cut: an axis follows the encoder of a spindle with varying speed.

use husillo_interp::Line;
use husillo_planner::{Due, Follower};
use husillo_sim::{AxisModel, Rig, Spindle};
use husillo_stepper::{CoilDriver, StepToggle};

const TIMER_HZ: u32 = 1_000_000;
const COUNTS_PER_TURN: u32 = 4096;
/// Steps of 1 um and a pitch of 1.5 mm: more counts than steps per turn.
const STEPS_PER_TURN: u32 = 1500;

/// Cuts 20 turns of thread. Returns the largest distance of the nut from the thread in steps, and
/// the largest number of steps due at once.
fn cut(speed: impl Fn(f64) -> (f64, f64)) -> (f64, u32) {
    let turns = 20;
    let mut spindle = Spindle::new(COUNTS_PER_TURN, TIMER_HZ);
    let mut motor = StepToggle::new();
    let mut rig = Rig::new([AxisModel::step_toggle()], [motor.levels()]);
    // The thread begins at the second turn.
    let start = COUNTS_PER_TURN as i32 * 2;
    let (counts, events) = (COUNTS_PER_TURN * turns, STEPS_PER_TURN * turns);
    let mut follower = Follower::new(counts, events, start, 0).unwrap();
    let mut path = Line::new([events as i32]);
    let (mut worst, mut most) = (0.0_f64, 0);
    for now in 0_u32..60_000_000 {
        let (target, load) = speed(f64::from(now) / f64::from(TIMER_HZ));
        spindle.set_target_rpm(target);
        spindle.set_load_rpm(load);
        spindle.advance(1);
        follower.measure(now, spindle.count());
        let mut at_once = 0;
        while path.len() > 0 && follower.due(now) == Due::Now {
            let step = path.next().unwrap();
            rig.apply(&[motor.step(step.delta(0))], 1);
            follower.advance();
            at_once += 1;
        }
        most = most.max(at_once);
        // Position on the thread; the first step is due when the thread begins.
        let thread = (spindle.turns() - f64::from(start) / f64::from(COUNTS_PER_TURN))
            * f64::from(STEPS_PER_TURN);
        let nut = f64::from(rig.tool()[0]);
        if thread >= 0.0 && path.len() > 0 {
            worst = worst.max((nut - 0.5 - thread).abs());
        }
        if path.len() == 0 {
            assert_eq!(rig.tool(), [events as i32]);
            return (worst, most);
        }
    }
    panic!("the thread was not finished");
}

#[test]
fn pitch_is_right_to_a_step_at_a_speed_that_wavers() {
    let (worst, most) = cut(|time| (600.0 + 150.0 * (time * 12.0).sin(), 0.0));
    assert!(worst <= 1.0, "{worst}");
    assert_eq!(most, 1);
}

#[test]
fn pitch_is_right_to_a_step_as_the_tool_bites() {
    let (worst, most) = cut(|time| {
        (
            900.0,
            if (0.4..0.9).contains(&time) {
                500.0
            } else {
                0.0
            },
        )
    });
    assert!(worst <= 1.0, "{worst}");
    assert_eq!(most, 1);
}

#[test]
fn the_nut_stands_with_the_spindle_and_goes_on_where_it_was() {
    let (worst, _) = cut(|time| {
        (
            if (0.5..2.5).contains(&time) {
                0.0
            } else {
                400.0
            },
            0.0,
        )
    });
    assert!(worst <= 1.0, "{worst}");
}

#[test]
fn a_spindle_that_turns_back_finds_its_thread_again() {
    // While the spindle is behind, the nut waits. They move together only ahead of the farthest
    // point.
    let (_, most) = cut(|time| {
        (
            if (0.5..1.0).contains(&time) {
                -300.0
            } else {
                400.0
            },
            0.0,
        )
    });
    assert_eq!(most, 1);
}
