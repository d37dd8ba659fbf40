//! External implementations of every trait work in the machine without changes to it.

mod common;

use common::config;
use husillo_backlash::BacklashModel;
use husillo_interp::{ArcError, ArcMove, Interpolator, Moves, Step};
use husillo_machine::{
    Event, Machine, MoveError, Refused, Scale, ServoAxis, ServoInputs, ServoStop,
};
use husillo_pid::{Drive, Gains, Integration, Limits, Pid, Regulator};
use husillo_planner::ServoMotion;
use husillo_stepper::{CoilDriver, Idle, Levels, Motors};

// ANCHOR: interpolator
/// Moves one axis after the other, as an old drilling machine does; arcs are replaced by chords.
#[derive(Clone)]
struct AxisByAxis {
    left: [i32; 3],
    steps: u32,
}

impl Iterator for AxisByAxis {
    type Item = Step;

    fn next(&mut self) -> Option<Step> {
        let axis = self.left.iter().position(|left| *left != 0)?;
        let is_negative = self.left[axis] < 0;
        self.left[axis] -= self.left[axis].signum();
        Some(Step {
            axes: 1 << axis,
            negative: u8::from(is_negative) << axis,
            sweep: 1,
        })
    }
}

impl Interpolator for AxisByAxis {
    fn remaining(&self) -> u32 {
        self.left.iter().map(|left| left.unsigned_abs()).sum()
    }

    fn total_sweep(&self) -> u64 {
        u64::from(self.steps)
    }

    fn largest_sweep(&self) -> u32 {
        1
    }
}

impl Moves<3> for AxisByAxis {
    fn line(left: [i32; 3]) -> Self {
        let steps = left.iter().map(|left| left.unsigned_abs()).sum();
        Self { left, steps }
    }

    fn arc(_: &ArcMove, _: [usize; 2], along: [i32; 3]) -> Result<Self, ArcError> {
        Ok(Self::line(along))
    }

    fn radius(&self) -> Option<u64> {
        None
    }
}
// ANCHOR_END: interpolator

/// An axis that is worn on one side.
struct Worn {
    direction: i8,
}

impl BacklashModel<3> for Worn {
    fn take_up(&mut self, axis: usize, direction: i8, load: &[i32; 3]) -> u32 {
        let turned = direction != self.direction;
        self.direction = direction;
        match (turned, load[axis] >= 5) {
            (false, _) => 0,
            (true, false) => 2,
            (true, true) => 3,
        }
    }
}

// ANCHOR: driver
/// A ring counter of five phases.
struct Ring {
    phase: u8,
    is_on: bool,
}

impl CoilDriver for Ring {
    fn step(&mut self, delta: i8) -> Levels {
        self.phase = (self.phase as i8 + delta).rem_euclid(5) as u8;
        self.levels()
    }

    fn levels(&self) -> Levels {
        Levels(if self.is_on { 1 << self.phase } else { 0 })
    }

    fn set_enabled(&mut self, on: bool) -> Levels {
        self.is_on = on;
        self.levels()
    }
}

// ANCHOR_END: driver

/// The levels after a step event.
fn stepped<const N: usize, D: CoilDriver>(
    motors: &mut Motors<N, D>,
    delta: [i8; N],
) -> [Levels; N] {
    motors.step(1, &delta, |_, _| {});
    *motors.levels()
}

/// The levels after a rest.
fn rested<const N: usize, D: CoilDriver>(motors: &mut Motors<N, D>, ticks: u32) -> [Levels; N] {
    motors.rest(ticks, |_, _| {});
    *motors.levels()
}

/// Methods without ellipses refuse arcs on unequal steps when they are given, not later.
#[test]
fn an_interpolator_without_ellipses_refuses_them() {
    let mut config = config();
    config.axes[2].scale = Scale::new(70, 1).unwrap();
    let backlash = [(); 3].map(|()| Worn { direction: 1 });
    let mut machine: Machine<3, AxisByAxis, Worn> = Machine::with_backlash(config, backlash);
    let refused = machine.line(b"G18 G2 X0 Z0 I-3 K0 F1.2");
    assert_eq!(refused, Err(Refused::Move(MoveError::UnequalSteps)));
    assert_eq!(machine.line(b"G17 G2 X0 Y0 I-3 J0 F1.2"), Ok(()));
}

#[test]
fn interpolator_backlash_and_driver_of_others() {
    let backlash = [(); 3].map(|()| Worn { direction: 1 });
    let mut machine: Machine<3, AxisByAxis, Worn> = Machine::with_backlash(config(), backlash);
    let ring = [(); 3].map(|()| Ring {
        phase: 0,
        is_on: true,
    });
    let mut motors = Motors::new(ring, Idle::Off { after_ticks: 10 });
    let mut trace = String::new();
    for line in ["G0 X0.0007 Y0.00028", "G0 X0.00042"] {
        machine.line(line.as_bytes()).unwrap();
        while let Some(event) = machine.next_event() {
            let Event::Step(step) = event else {
                panic!("{event:?}")
            };
            motors.step(step.wait_ticks, &step.delta, |_, _| {});
            let axis = step.delta.iter().position(|delta| *delta != 0).unwrap();
            trace.push(['x', 'y', 'z'][axis]);
            trace.push(if step.delta[axis] > 0 { '+' } else { '-' });
        }
    }
    assert_eq!(trace, "x+x+x+x+x+y+y+x-x-x-x-x-");
    // Five steps forward and five back, three of them take-up: the ring counter is at its start
    // again.
    assert_eq!(motors.levels(), &[Levels(1), Levels(4), Levels(1)]);
    assert_eq!(rested(&mut motors, 10), [Levels(0); 3]);
    assert!(motors.was_released());
    assert_eq!(
        stepped(&mut motors, [0; 3]),
        [Levels(1), Levels(4), Levels(1)]
    );
}

#[test]
fn resting_motors_hold_with_less_current_and_step_with_all_of_it() {
    use husillo_stepper::{Driver, Mode, Sequencer};
    let driver = Sequencer::new(Driver::Pbl3717a, Mode::Full).unwrap();
    let mut motors = Motors::new([driver], Idle::Reduced { after_ticks: 100 });
    let currents = |levels: [Levels; 1]| Driver::Pbl3717a.currents(levels[0]).map(i16::abs);
    assert_eq!(currents(stepped(&mut motors, [1])), [1000, 1000]);
    assert_eq!(currents(rested(&mut motors, 99)), [1000, 1000]);
    assert_eq!(currents(rested(&mut motors, 1)), [600, 600]);
    assert!(!motors.was_released());
    let mut again = driver;
    again.step(1);
    assert_eq!(stepped(&mut motors, [1]), [again.step(1)]);
}

/// Two-point control: full force towards the set point; switches off beyond an error of a thousand
/// counts.
struct BangBang;

impl Regulator for BangBang {
    type State = bool;

    fn begin(&self) -> bool {
        false
    }

    fn regulate(&self, has_given_up: &mut bool, set_point: i32, measured: i32, _: u8) -> Drive {
        *has_given_up = set_point.abs_diff(measured) > 1000;
        Drive {
            pwm: if set_point == measured { 0 } else { 255 },
            is_reverse: measured > set_point,
        }
    }

    fn has_given_up(&self, has_given_up: &bool) -> bool {
        *has_given_up
    }
}

/// Ticks until the axis holds. The motor moves 1/16 of its PWM in counts per period.
fn settle<R: Regulator>(axis: &mut ServoAxis<R>, inputs: &mut ServoInputs) -> Option<usize> {
    (1..1000).find(|_| {
        let drive = axis.tick(inputs);
        inputs.counts += i32::from(drive.signed()).div_euclid(16);
        drive.pwm == 0 && axis.status().is_done
    })
}

#[test]
fn law_of_others_moves_an_axis() {
    let powered = ServoInputs {
        has_power: true,
        ..ServoInputs::default()
    };
    let mut inputs = powered;
    let mut axis = ServoAxis::new(BangBang);
    axis.tick(&inputs);
    // Ten times the motion per period, so that it comes to rest.
    axis.stop(ServoStop::At(150));
    assert!(settle(&mut axis, &mut inputs).is_some());
    assert_eq!((axis.position(), axis.error_counts()), (150, 0));
    axis.stop(ServoStop::At(2000));
    axis.tick(&inputs);
    assert_eq!(axis.error_counts(), 1850);
    assert!(!axis.status().is_on, "it has given up");

    use fixed::types::{I16F16, I32F0};
    let gains = Gains {
        proportional: I16F16::lit("4"),
        integral: I16F16::lit("0.0625"),
        ..Gains::default()
    };
    let limits = Limits {
        low: I32F0::from_num(-255),
        high: I32F0::from_num(255),
    };
    let pid = Pid::new(gains, Integration::Backward, limits).unwrap();
    let (mut axis, mut inputs) = (ServoAxis::new(pid), powered);
    axis.tick(&inputs);
    axis.stop(ServoStop::Abrupt);
    axis.load(ServoMotion::Trapezoid {
        goal: 3000,
        velocity: 10 << 16,
        acceleration: 1 << 14,
    });
    assert!(axis.start());
    for _ in 0..2000 {
        let drive = axis.tick(&inputs);
        inputs.counts += i32::from(drive.signed()).div_euclid(16);
    }
    assert!(axis.status().is_done && axis.status().is_on);
    assert!(axis.position().abs_diff(3000) <= 4, "{}", axis.position());
}
