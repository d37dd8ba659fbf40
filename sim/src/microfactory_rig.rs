//! The desktop microfactory's mechanics: four motors behind L297 sequencers, home switches, a work piece before the tool.

use husillo_controllers::{
    MICROFACTORY_MOTORS, MicrofactoryConfig, MicrofactoryEvent, MicrofactoryInputs,
};
use husillo_machine::StepEvent;
use husillo_stepper::{Driver, L297, L297Inputs, Levels, Mode};

use crate::{AxisModel, Rig};

/// The microfactory, in events.
///
/// Every motor has a chip of its own; RESET, ENABLE and CLOCK are driven as the events say, in full step with two phases on.
#[derive(Clone, Debug)]
pub struct MicrofactoryRig {
    chips: [L297; MICROFACTORY_MOTORS],
    inputs: L297Inputs,
    rig: Rig<MICROFACTORY_MOTORS>,
    /// Load steps at which the home switches close, from where the axes were at first.
    switches: [i32; 3],
    /// Load steps of Y at which the tool touches.
    face: i32,
    /// Switches held by hand.
    held: MicrofactoryInputs,
    ticks: u64,
}

/// No current and no edge: what RESET and ENABLE change.
const REST: L297Inputs = L297Inputs {
    clock: false,
    clockwise: true,
    half: false,
    reset: true,
    enable: false,
};

impl MicrofactoryRig {
    /// Axes so many load steps above their home switches, the work piece so many steps of Y above
    /// where the axis is. The motors lose steps that come closer than `pull_out_ticks` of the
    /// timer; 0: none.
    #[must_use]
    pub fn new(
        config: &MicrofactoryConfig,
        above_switches: [u16; 3],
        face: i32,
        pull_out_ticks: u32,
    ) -> MicrofactoryRig {
        let [x, y, z] = config.lash_steps.map(u32::from);
        let axis = |lash| {
            AxisModel::coils(Driver::L297, Mode::Full)
                .with_lash(lash)
                .with_pull_out_ticks(pull_out_ticks)
        };
        let mut chip = L297::new();
        chip.set(REST);
        // The rotors rest where state 1 holds them.
        let home = L297::new().outputs();
        MicrofactoryRig {
            chips: [chip; MICROFACTORY_MOTORS],
            inputs: REST,
            rig: Rig::new(
                [axis(x), axis(y), axis(z), axis(0)],
                [home; MICROFACTORY_MOTORS],
            ),
            switches: above_switches.map(|steps| -i32::from(steps)),
            face,
            held: MicrofactoryInputs::default(),
            ticks: 0,
        }
    }

    /// The switches as they are.
    #[must_use]
    pub fn inputs(&self) -> MicrofactoryInputs {
        let [x, y, z, _] = self.rig.tool();
        let mut home = self.held.home;
        for ((closed, at), switch) in home.iter_mut().zip([x, y, z]).zip(self.switches) {
            *closed |= at <= switch;
        }
        MicrofactoryInputs {
            home,
            contact: self.held.contact || y >= self.face,
        }
    }

    /// Holds switches closed by hand, or lets go of them.
    pub fn hold(&mut self, held: MicrofactoryInputs) {
        self.held = held;
    }

    /// Makes an event happen.
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
        // CLOCK of the motors that step rises, with CW/CCW beside it, and falls again at once.
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

    /// The inputs to all chips, and their outputs to the motors.
    fn present(&mut self, wait_ticks: u32) {
        for chip in &mut self.chips {
            chip.set(self.inputs);
        }
        self.rig.apply(&self.outputs(), wait_ticks);
    }

    fn outputs(&self) -> [Levels; MICROFACTORY_MOTORS] {
        self.chips.map(|chip| chip.outputs())
    }

    /// Load steps of X, Y, Z and steps of the spindle, from where they were at first.
    #[must_use]
    pub fn tool(&self) -> [i32; MICROFACTORY_MOTORS] {
        self.rig.tool()
    }

    /// Steps that the motors lost, by motor.
    #[must_use]
    pub fn lost_steps(&self) -> [u64; MICROFACTORY_MOTORS] {
        self.rig.lost_steps()
    }

    /// Timer ticks since the beginning.
    #[must_use]
    pub const fn ticks(&self) -> u64 {
        self.ticks
    }
}
