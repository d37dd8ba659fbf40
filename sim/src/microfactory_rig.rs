//! Mechanics of the desktop microfactory: four motors with L297 sequencers, home switches, and a
//! work piece in front of the tool.

use husillo_controllers::{
    MICROFACTORY_MOTORS, MicrofactoryConfig, MicrofactoryEvent, MicrofactoryInputs,
};
use husillo_machine::StepEvent;
use husillo_stepper::{Driver, L297, L297Inputs, Levels, Mode};

use crate::{AxisModel, Rig};

/// Simulated microfactory, driven by events.
///
/// Every motor has its own chip. RESET, ENABLE and CLOCK follow the events, in full step with two
/// phases on.
#[derive(Clone, Debug)]
pub struct MicrofactoryRig {
    chips: [L297; MICROFACTORY_MOTORS],
    inputs: L297Inputs,
    rig: Rig<MICROFACTORY_MOTORS>,
    /// Positions where the home switches close, in load steps from the initial positions.
    switches: [i32; 3],
    /// Position of Y in load steps where the tool touches.
    face: i32,
    /// Switches held closed or open by hand.
    held: [Option<bool>; 4],
    ticks: u64,
}

/// Inputs without current and without an edge. RESET and ENABLE differ from them while the motors
/// run.
const REST: L297Inputs = L297Inputs {
    clock: false,
    clockwise: true,
    half: false,
    reset: true,
    enable: false,
};

/// Distance of the mechanical end of an axis below its home switch. The description of the original
/// does not state it.
const END_BELOW_SWITCH_STEPS: u32 = 100;

impl MicrofactoryRig {
    /// Creates a rig. `above_switches` has the first positions of the axes, in load steps above
    /// their home switches. `face` is the distance of Y to the work piece, in load steps. A motor
    /// loses a step that follows the previous one in less than `pull_out_ticks` timer ticks. With 0
    /// no step is lost.
    #[must_use]
    pub fn new(
        config: &MicrofactoryConfig,
        above_switches: [u16; 3],
        face: i32,
        pull_out_ticks: u32,
    ) -> MicrofactoryRig {
        let [x, y, z] = config.backlash_steps.map(u32::from);
        let model = AxisModel::coils(Driver::L297, Mode::Full).with_pull_out_ticks(pull_out_ticks);
        let axis = |backlash, above| {
            let end_below = u32::from(above) + backlash + END_BELOW_SWITCH_STEPS;
            model.with_backlash(backlash).with_end_below(end_below)
        };
        let [above_x, above_y, above_z] = above_switches;
        let mut chip = L297::new();
        chip.set(REST);
        // The rotors rest at state 1.
        let home = L297::new().outputs();
        MicrofactoryRig {
            chips: [chip; MICROFACTORY_MOTORS],
            inputs: REST,
            rig: Rig::new(
                [axis(x, above_x), axis(y, above_y), axis(z, above_z), model],
                [home; MICROFACTORY_MOTORS],
            ),
            switches: above_switches.map(|steps| -i32::from(steps)),
            face,
            held: [None; 4],
            ticks: 0,
        }
    }

    /// The present state of the switches.
    #[must_use]
    pub fn inputs(&self) -> MicrofactoryInputs {
        let [x, y, z, _] = self.rig.tool();
        let [switch_x, switch_y, switch_z] = self.switches;
        let [held_x, held_y, held_z, held_contact] = self.held;
        MicrofactoryInputs {
            home: [
                held_x.unwrap_or(x <= switch_x),
                held_y.unwrap_or(y <= switch_y),
                held_z.unwrap_or(z <= switch_z),
            ],
            contact: held_contact.unwrap_or(y >= self.face),
        }
    }

    /// Holds a switch closed or open, or releases it: 0 of X, 1 of Y, 2 of Z, 3 the contact.
    pub fn hold(&mut self, switch: usize, closed: Option<bool>) {
        if let Some(held) = self.held.get_mut(switch) {
            *held = closed;
        }
    }

    /// Blocks the rotor of an axis, or releases it, as a chip in the guide or an end stop does.
    /// While it is blocked, every step is lost.
    pub fn block(&mut self, axis: usize, is_blocked: bool) {
        self.rig.block(axis, is_blocked);
    }

    /// Carries out an event.
    pub fn apply(&mut self, event: &MicrofactoryEvent) {
        match event {
            MicrofactoryEvent::Step(step) => self.step(step),
            MicrofactoryEvent::Dwell { wait_ticks } => self.wait(*wait_ticks),
            MicrofactoryEvent::Enable(on) => {
                self.inputs.enable = *on;
                self.present(0);
            }
            MicrofactoryEvent::Reset { ticks } => {
                self.inputs.reset = false;
                self.present(0);
                self.wait(*ticks);
                self.inputs.reset = true;
                self.present(0);
            }
            MicrofactoryEvent::Report(_) | MicrofactoryEvent::Idle => {}
        }
    }

    fn step(&mut self, step: &StepEvent<MICROFACTORY_MOTORS>) {
        self.ticks += u64::from(step.wait_ticks);
        let levels = self.outputs();
        // CLOCK of the stepping motors rises, together with CW/CCW, and falls again at once.
        for (chip, delta) in self.chips.iter_mut().zip(step.delta) {
            chip.set(L297Inputs {
                clock: delta != 0,
                clockwise: delta > 0,
                ..self.inputs
            });
            chip.set(self.inputs);
        }
        if self.outputs() == levels {
            self.rig.wait(step.wait_ticks.into());
        } else {
            self.rig.apply(&self.outputs(), step.wait_ticks);
        }
    }

    fn wait(&mut self, ticks: u32) {
        self.ticks += u64::from(ticks);
        self.rig.wait(ticks.into());
    }

    /// Passes the inputs to all chips, and their outputs to the motors.
    fn present(&mut self, wait_ticks: u32) {
        for chip in &mut self.chips {
            chip.set(self.inputs);
        }
        self.rig.apply(&self.outputs(), wait_ticks);
    }

    fn outputs(&self) -> [Levels; MICROFACTORY_MOTORS] {
        self.chips.map(|chip| chip.outputs())
    }

    /// Load steps of X, Y and Z and steps of the spindle, relative to the initial positions.
    #[must_use]
    pub fn tool(&self) -> [i32; MICROFACTORY_MOTORS] {
        self.rig.tool()
    }

    /// Whether the motors have current.
    #[must_use]
    pub const fn has_current(&self) -> bool {
        self.inputs.enable
    }

    /// Steps that the motors lost, by motor.
    #[must_use]
    pub fn lost_steps(&self) -> [u64; MICROFACTORY_MOTORS] {
        self.rig.lost_steps()
    }

    /// Timer ticks since the start.
    #[must_use]
    pub const fn ticks(&self) -> u64 {
        self.ticks
    }
}
