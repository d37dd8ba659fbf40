//! The micro mill's mechanics: three motors behind PBL3717A drivers, screws with backlash, home
//! switches, a spindle.

use husillo_controllers::{MicromillConfig, MicromillEvent, MicromillInputs, MicromillStep};
use husillo_gcode::SpindleDirection;
use husillo_stepper::{CoilDriver, Driver, Levels, Mode, Sequencer};

use crate::{AxisModel, Rig};

/// Simulated micro mill, driven by events.
#[derive(Clone, Debug)]
pub struct MicromillRig {
    motors: [Sequencer; 3],
    rig: Rig<3>,
    /// Positions where the home switches close, in load steps from the initial positions.
    switches: [i32; 3],
    /// Switches held closed or open by hand.
    held: [Option<bool>; 3],
    spindle: SpindleDirection,
    rpm: u16,
    tool: u8,
}

/// Distance of the mechanical ends of an axis beyond both ends of its travel. The description of
/// the original does not state it.
const END_STEPS: u32 = 300;

impl MicromillRig {
    /// Creates a rig with the backlash of the configuration. `above_switches` has the first
    /// positions of the axes, in load steps above their home switches.
    ///
    /// A motor loses a step that follows the previous one in less than `pull_out_ticks` timer
    /// ticks. With 0 no step is lost.
    #[must_use]
    pub fn new(
        config: &MicromillConfig,
        above_switches: [u32; 3],
        pull_out_ticks: u32,
    ) -> MicromillRig {
        let driver = Driver::Pbl3717a;
        let motor = Sequencer::new(driver, Mode::Full).unwrap_or_else(|_| unreachable!());
        let [x, y, z] = &config.machine.axes;
        let [above_x, above_y, above_z] = above_switches;
        let axis = |axis: &husillo_machine::Axis, above: u32| {
            let model = AxisModel::coils(driver, Mode::Full)
                .with_backlash(axis.backlash_steps)
                .with_pull_out_ticks(pull_out_ticks)
                .with_end_below(above + axis.backlash_steps + END_STEPS);
            let high = axis.travel.and_then(|[_, high]| axis.scale.nearest(high.0));
            match high {
                Some(steps) => {
                    model.with_end_above(steps.unsigned_abs().saturating_sub(above) + END_STEPS)
                }
                None => model,
            }
        };
        MicromillRig {
            motors: [motor; 3],
            rig: Rig::new(
                [axis(x, above_x), axis(y, above_y), axis(z, above_z)],
                [motor.levels(); 3],
            ),
            switches: above_switches.map(|steps| -i32::try_from(steps).unwrap_or(i32::MAX)),
            held: [None; 3],
            spindle: SpindleDirection::Off,
            rpm: 0,
            tool: 0,
        }
    }

    /// The present state of the switches.
    #[must_use]
    pub fn inputs(&self) -> MicromillInputs {
        let tool = self.rig.tool();
        let closed = tool.iter().zip(self.switches).zip(self.held);
        let home = closed.rev().fold(0, |word, ((at, switch), held)| {
            word << 1 | u8::from(held.unwrap_or(*at <= switch))
        });
        MicromillInputs { home }
    }

    /// Holds a switch closed or open, or releases it: 0 of X, 1 of Y, 2 of Z.
    pub fn hold(&mut self, switch: usize, closed: Option<bool>) {
        if let Some(held) = self.held.get_mut(switch) {
            *held = closed;
        }
    }

    /// Turns the rotor of an axis by about `steps` against its field, as a stronger load does.
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
    pub fn apply(&mut self, event: &MicromillEvent) {
        match event {
            MicromillEvent::Step(step) => self.step(step),
            MicromillEvent::Spindle { direction, rpm } => {
                (self.spindle, self.rpm) = (*direction, *rpm);
            }
            MicromillEvent::Tool { number } => self.tool = *number,
        }
    }

    fn step(&mut self, step: &MicromillStep) {
        if step.axes == 0 {
            return self.rig.wait(step.wait_ticks.into());
        }
        for (motor, delta) in self.motors.iter_mut().zip(step.deltas()) {
            if delta != 0 {
                motor.step(delta);
            }
        }
        self.rig.apply(&self.levels(), step.wait_ticks);
    }

    /// Levels of the wires of the motors of X, Y and Z.
    #[must_use]
    pub fn levels(&self) -> [Levels; 3] {
        self.motors.each_ref().map(CoilDriver::levels)
    }

    /// Load steps of X, Y and Z above their home switches.
    #[must_use]
    pub fn place(&self) -> [i32; 3] {
        let mut switches = self.switches.into_iter();
        let above = |at: i32| at.wrapping_sub(switches.next().unwrap_or(0));
        self.rig.tool().map(above)
    }

    /// Direction and speed of the spindle, in turns per minute.
    #[must_use]
    pub const fn spindle(&self) -> (SpindleDirection, u16) {
        (self.spindle, self.rpm)
    }

    /// The last requested tool. 0: none.
    #[must_use]
    pub const fn tool_number(&self) -> u8 {
        self.tool
    }

    /// Steps that the motors lost, by motor.
    #[must_use]
    pub fn lost_steps(&self) -> [u64; 3] {
        self.rig.lost_steps()
    }
}
