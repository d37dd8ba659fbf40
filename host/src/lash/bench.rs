//! A machine that drives simulated screws, one block at a time.

use crate::machines::machine_file::MachineFile;
use crate::programs::setup::{self, Micromill};
use husillo_gcode::Dialect;
use husillo_machine::{Event, Motors, Origin};
use husillo_metrology::calibration::backlash::{self, Map, Moment};
use husillo_sim::Rig;
use husillo_stepper::Drive;

/// A homed machine on screws with the play of the file's `[simulated_lash]`.
pub struct SimulatedBench {
    machine: Micromill,
    motors: Motors<3, Drive>,
    rig: Rig<3>,
    nm_per_step: [f64; 3],
}

impl SimulatedBench {
    /// A machine that takes up the backlash of `maps`.
    ///
    /// # Errors
    ///
    /// The machine file has mistakes, or no `[simulated_lash]`.
    pub fn new(file: &MachineFile, maps: [Map; 3]) -> Result<Self, String> {
        let steps = file.axes.each_ref().map(|axis| axis.step);
        let field = file.lash.field(steps).ok_or_else(|| {
            format!(
                "{}: no [simulated_lash], which describes the simulated screws",
                file.path
            )
        })?;
        let config = setup::config(file, Dialect::RS274)?;
        let motors = setup::motors(file)?;
        Ok(Self {
            machine: setup::with_maps(config, maps),
            rig: setup::rig(file, &motors).with_lash_field(field),
            motors,
            nm_per_step: steps.map(|step| step.num as f64 / step.den as f64),
        })
    }
}

impl backlash::Bench for SimulatedBench {
    fn make(&mut self, block: &str, each: &mut dyn FnMut(&Moment)) -> Result<(), String> {
        let refused = |why: &dyn std::fmt::Display| format!("{block}: {why}");
        self.machine
            .line(block.as_bytes())
            .map_err(|why| refused(&why))?;
        while let Some(event) = self.machine.next_event() {
            let Event::Step(step) = event else { continue };
            let rig = &mut self.rig;
            self.motors
                .step(step.wait_ticks, &step.delta, |wait_ticks, levels| {
                    rig.apply(levels, wait_ticks);
                });
            let nm = |steps: [i32; 3]| {
                [0, 1, 2].map(|axis| f64::from(steps[axis]) * self.nm_per_step[axis])
            };
            each(&Moment {
                sent_nm: nm(self.machine.position_steps()),
                tool_nm: nm(self.rig.tool()),
                is_take_up: self.machine.origin() == Origin::TakeUp,
            });
        }
        match self.rig.lost_steps() {
            [0, 0, 0] => Ok(()),
            lost => Err(refused(&format!("{lost:?} steps lost"))),
        }
    }
}
