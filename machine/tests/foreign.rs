//! Foreign implementations of every seam work in the machine without a change to it.

mod common;

use common::config;
use husillo_backlash::Lash;
use husillo_interp::{ArcError, ArcMove, Interpolator, Moves, Step};
use husillo_machine::{Event, Idle, Machine, Motors};
use husillo_stepper::{CoilDriver, Levels};

/// One axis after the other, as an old drilling machine moves; arcs are its chords.
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

/// An axis that is worn on one side.
struct Worn {
    direction: i8,
}

impl Lash<3> for Worn {
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

#[test]
fn interpolator_lash_and_driver_of_others() {
    let lash = [(); 3].map(|()| Worn { direction: 1 });
    let mut machine: Machine<3, AxisByAxis, Worn> = Machine::with_lash(config(), lash);
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
    // Five steps forth and five back, three of them take-up: the ring is home again.
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
