//! Mechanics of the circuit-board drill: three unipolar motors, switches of X and Y, two sensors of
//! Z, and a board.

use husillo_controllers::{DrillEvent, DrillInputs};
use husillo_machine::StepEvent;
use husillo_stepper::{CoilDriver, Driver, Levels, Mode, Sequencer};

use crate::{AxisModel, Rig};

/// A hole in the board.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DrilledHole {
    /// Position in steps of X and Y from the points where their switches close.
    pub at: [i32; 2],
    /// Deepest position of the drill in steps below the upper sensor.
    pub depth: i32,
    /// Whether the spindle turned during the whole hole.
    pub is_clean: bool,
}

/// Simulated mechanics of the drill, in steps.
///
/// X and Y count from the points where their switches close, Z from the upper sensor downwards.
#[derive(Clone, Debug)]
pub struct DrillRig {
    motors: [Sequencer; 3],
    rig: Rig<3>,
    /// Initial positions of the axes.
    begin: [i32; 3],
    /// Distance from the upper sensor to the lower one.
    stroke: i32,
    /// Distance from the upper sensor to the board.
    board: i32,
    spindle: bool,
    /// The hole in progress.
    open: Option<DrilledHole>,
    holes: Vec<DrilledHole>,
    dragged_steps: u64,
    /// Switches and sensors held closed or open by hand.
    held: [Option<bool>; 4],
    ticks: u64,
}

/// Distance of the mechanical end of an axis below its switch. The description of the original does
/// not state it.
const END_BELOW_SWITCH_STEPS: u32 = 100;

impl DrillRig {
    /// Creates a rig with the axes at `begin`. `stroke` is the distance between the sensors of Z,
    /// `board` the distance of the board below the upper sensor.
    ///
    /// A motor loses a step that follows the previous one in less than `pull_out_ticks` timer
    /// ticks.
    #[must_use]
    pub fn new(begin: [i32; 3], stroke: u16, board: u16, pull_out_ticks: u32) -> DrillRig {
        let motor = Sequencer::new(Driver::Unipolar, Mode::Full).unwrap_or_else(|_| unreachable!());
        let model =
            AxisModel::coils(Driver::Unipolar, Mode::Full).with_pull_out_ticks(pull_out_ticks);
        let axis = |begin: i32| {
            model.with_end_below(begin.unsigned_abs().wrapping_add(END_BELOW_SWITCH_STEPS))
        };
        DrillRig {
            motors: [motor; 3],
            rig: Rig::new(begin.map(axis), [motor.levels(); 3]),
            begin,
            stroke: i32::from(stroke),
            board: i32::from(board),
            spindle: false,
            open: None,
            holes: Vec::new(),
            dragged_steps: 0,
            held: [None; 4],
            ticks: 0,
        }
    }

    /// The present state of the switches and sensors.
    #[must_use]
    pub fn inputs(&self) -> DrillInputs {
        let [x, y, z] = self.place();
        let [held_x, held_y, held_up, held_down] = self.held;
        DrillInputs {
            home: [held_x.unwrap_or(x <= 0), held_y.unwrap_or(y <= 0)],
            is_up: held_up.unwrap_or(z <= 0),
            is_down: held_down.unwrap_or(z >= self.stroke),
        }
    }

    /// Holds a switch closed or open, or releases it: 0 is X, 1 is Y, 2 the upper sensor, 3 the
    /// lower sensor.
    pub fn hold(&mut self, switch: usize, closed: Option<bool>) {
        if let Some(held) = self.held.get_mut(switch) {
            *held = closed;
        }
    }

    /// Turns the rotor of X, Y or Z by about `steps` against its field, as a stronger load does.
    /// Returns the steps it turned.
    pub fn push(&mut self, axis: usize, steps: i32) -> i32 {
        self.rig.push(axis, steps)
    }

    /// Blocks the rotor of an axis, or releases it, as a chip in the guide or an end stop does.
    /// While it is blocked, every step is lost.
    pub fn block(&mut self, axis: usize, is_blocked: bool) {
        self.rig.block(axis, is_blocked);
    }

    /// Carries out an event.
    pub fn apply(&mut self, event: &DrillEvent) {
        match event {
            DrillEvent::Step(step) => self.step(step),
            DrillEvent::Dwell { wait_ticks } => {
                self.ticks += u64::from(*wait_ticks);
                self.rig.wait(u64::from(*wait_ticks));
            }
            DrillEvent::Spindle(on) => {
                self.spindle = *on;
                if let Some(hole) = &mut self.open {
                    hole.is_clean &= *on;
                }
            }
            DrillEvent::Report(_) | DrillEvent::Idle => {}
        }
    }

    fn step(&mut self, step: &StepEvent<3>) {
        self.ticks += u64::from(step.wait_ticks);
        for (motor, delta) in self.motors.iter_mut().zip(step.delta) {
            if delta != 0 {
                motor.step(delta);
            }
        }
        self.rig.apply(&self.levels(), step.wait_ticks);
        let [x, y, z] = self.place();
        if z <= self.board {
            self.holes.extend(self.open.take());
            return;
        }
        let hole = self.open.get_or_insert(DrilledHole {
            at: [x, y],
            depth: z,
            is_clean: self.spindle,
        });
        hole.depth = hole.depth.max(z);
        self.dragged_steps += u64::from(hole.at != [x, y]);
    }

    /// Levels of the wires of the motors of X, Y and Z.
    #[must_use]
    pub fn levels(&self) -> [Levels; 3] {
        self.motors.each_ref().map(CoilDriver::levels)
    }

    /// Position in steps: X and Y from their switches, Z from its upper sensor.
    #[must_use]
    pub fn place(&self) -> [i32; 3] {
        let mut tool = self.rig.tool().into_iter();
        self.begin.map(|begin| begin + tool.next().unwrap_or(0))
    }

    /// The finished holes in the order of drilling.
    #[must_use]
    pub fn holes(&self) -> &[DrilledHole] {
        &self.holes
    }

    /// Replaces the board by one without holes.
    pub fn change_board(&mut self) {
        self.holes.clear();
    }

    /// Whether the spindle turns.
    #[must_use]
    pub const fn spindle_turns(&self) -> bool {
        self.spindle
    }

    /// Steps of X and Y while the drill was in the board; each of them may break it.
    #[must_use]
    pub const fn dragged_steps(&self) -> u64 {
        self.dragged_steps
    }

    /// Steps lost by each motor.
    #[must_use]
    pub fn lost_steps(&self) -> [u64; 3] {
        self.rig.lost_steps()
    }

    /// Timer ticks since the start.
    #[must_use]
    pub const fn ticks(&self) -> u64 {
        self.ticks
    }
}
