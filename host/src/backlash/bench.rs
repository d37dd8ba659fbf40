//! A machine that drives simulated screws, one block at a time.

use husillo_gcode::Dialect;
use husillo_machine::{Event, Origin};
use husillo_metrology::calibration::backlash::{self, Map, Moment};
use husillo_metrology::originals::micromill::{Screws, Settings, TRUE_STEP};
use husillo_sim::observers::AXES;
use husillo_sim::{BacklashField, Rig};
use husillo_simulator::machines::machine_file::MachineFile;
use husillo_simulator::programs::setup::{self, MappedEngine};
use husillo_stepper::{Drive, Motors};
use std::sync::Arc;

/// A homed machine on screws with backlash.
pub struct SimulatedBench {
    machine: MappedEngine,
    motors: Motors<AXES, Drive>,
    rig: Rig<AXES>,
    /// Length of a step as the controller calculates with it, nm.
    nm_per_step: [f64; 3],
    /// True length of a step, nm.
    tool_nm_per_step: [f64; 3],
    timer_hz: f64,
}

impl SimulatedBench {
    /// A machine that takes up the backlash of `maps`, on screws with the backlash of the file's
    /// `[simulated_backlash]`.
    ///
    /// # Errors
    ///
    /// The machine file has mistakes, or no `[simulated_backlash]`.
    pub fn new(file: &MachineFile, maps: [Map; AXES]) -> Result<Self, String> {
        let steps = file.xyz(|axis| axis.step);
        let field = file.backlash.field(steps).ok_or_else(|| {
            format!(
                "{}: no [simulated_backlash], which describes the simulated screws",
                file.path
            )
        })?;
        Self::on(file, maps, field)
    }

    /// A machine like that of the file with the settings of an original mill, on its screws.
    ///
    /// # Errors
    ///
    /// The machine file has mistakes, or the settings do.
    pub fn of_original(
        mut file: MachineFile,
        settings: &Settings,
        screws: &Screws,
    ) -> Result<Self, String> {
        for axis in &mut file.axes {
            axis.step = settings.step;
        }
        let steps = file.xyz(|axis| axis.step);
        let mut maps = setup::no_backlash();
        for (axis, table) in settings.take_up.iter().enumerate() {
            let map = table.map(steps[axis], steps);
            maps[axis] = map.map_err(|why| format!("{}: {why}", ["X", "Y"][axis]))?;
        }
        let mut bench = Self::on(&file, maps, screws.field())?;
        bench.tool_nm_per_step = [TRUE_STEP.num as f64 / TRUE_STEP.den as f64; 3];
        Ok(bench)
    }

    fn on(
        file: &MachineFile,
        maps: [Map; AXES],
        field: Arc<dyn BacklashField<3>>,
    ) -> Result<Self, String> {
        let config = setup::config(file, Dialect::RS274)?;
        let motors = setup::motors(file)?;
        let steps = file.xyz(|axis| axis.step);
        let nm_per_step = steps.map(|step| step.num as f64 / step.den as f64);
        Ok(Self {
            machine: setup::with_maps(config, maps),
            rig: setup::rig(file, &motors).with_backlash_field(setup::field(field)),
            motors,
            nm_per_step,
            tool_nm_per_step: nm_per_step,
            timer_hz: f64::from(file.timer_hz),
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
            let nm = |steps: [i32; AXES], nm_per_step: [f64; 3]| {
                [0, 1, 2].map(|axis| f64::from(steps[axis]) * nm_per_step[axis])
            };
            each(&Moment {
                sent_nm: nm(self.machine.position_steps(), self.nm_per_step),
                tool_nm: nm(self.rig.tool(), self.tool_nm_per_step),
                is_take_up: self.machine.origin() == Origin::TakeUp,
                at_s: self.rig.elapsed_ticks() as f64 / self.timer_hz,
            });
        }
        match self.rig.lost_steps() {
            lost if lost == [0; AXES] => Ok(()),
            lost => Err(refused(&format!("{lost:?} steps lost"))),
        }
    }
}
