//! The simulated machine: step events drive motors, coils, rotors and screws.

use crate::machines::encoder_file::Push;
use crate::machines::machine_file::MachineFile;
use crate::programs::setup;
use husillo_machine::StepEvent;
use husillo_sim::Rig;
use husillo_sim::observers::AXES;
use husillo_sim::observers::losses::{FirstLoss, Losses};
use husillo_stepper::{Drive, Levels, Motors};

/// The simulated machine, and its clock.
#[derive(Clone, Debug)]
pub struct Mechanics {
    motors: Motors<AXES, Drive>,
    rig: Rig<AXES>,
    timer_hz: u32,
    nm_per_step: [f64; AXES],
    events: u64,
    ticks: u64,
    /// Simulated losses that are still to come.
    pushes: Vec<Push>,
    losses: Losses,
    /// That of the rig when `losses` was last renewed.
    loss_count: u64,
    /// Counts and steps of each encoder.
    encoders: [Option<(i64, i64)>; AXES],
}

impl Mechanics {
    /// A homed machine at rest. It has the backlash of its file or, if worn, that of
    /// `[simulated_backlash]`.
    ///
    /// # Errors
    ///
    /// A driver does not have the step mode of the machine file, or a worn machine has no
    /// `[simulated_backlash]`.
    pub fn new(machine: &MachineFile, is_worn: bool) -> Result<Self, String> {
        let motors = setup::motors(machine)?;
        let mut rig = setup::rig(machine, &motors);
        if is_worn {
            let steps = machine.xyz(|axis| axis.step);
            let field = machine.backlash.field(steps).ok_or_else(|| {
                let path = &machine.path;
                format!("{path}: no [simulated_backlash], which describes the worn screws")
            })?;
            rig = rig.with_backlash_field(setup::field(field));
        }
        Ok(Self {
            motors,
            rig,
            timer_hz: machine.timer_hz,
            nm_per_step: machine.each(1.0, |axis| axis.step.num as f64 / axis.step.den as f64),
            events: 0,
            ticks: 0,
            pushes: Vec::new(),
            losses: Losses::default(),
            loss_count: 0,
            encoders: machine.each(None, |axis| {
                let encoder = axis.encoder.as_ref()?.encoder;
                Some((encoder.counts.into(), encoder.steps.into()))
            }),
        })
    }

    /// Puts the tool at these steps before the run.
    pub fn start_at(&mut self, steps: [i32; AXES]) {
        self.rig = self.rig.clone().with_tool_at(steps);
    }

    /// Sets the simulated losses.
    pub fn set_pushes(&mut self, pushes: &[Push]) {
        self.pushes = pushes.to_vec();
    }

    /// Makes a step.
    #[inline]
    pub fn step(&mut self, step: &StepEvent<AXES>) {
        self.events += 1;
        self.ticks += u64::from(step.wait_ticks);
        if !self.pushes.is_empty() {
            self.push();
        }
        let rig = &mut self.rig;
        self.motors
            .step(step.wait_ticks, &step.delta, |wait_ticks, levels| {
                rig.apply(levels, wait_ticks);
            });
        if self.rig.loss_count() != self.loss_count {
            self.lose();
        }
    }

    /// Waits without a step.
    pub fn rest(&mut self, wait_ticks: u32) {
        self.ticks += u64::from(wait_ticks);
        let rig = &mut self.rig;
        // Levels that change when the motors idle reach the driver at the end of the wait.
        self.motors.rest(wait_ticks, |wait_ticks, levels| {
            rig.apply(levels, wait_ticks);
        });
    }

    /// Makes the simulated losses of this event.
    #[cold]
    fn push(&mut self) {
        let events = self.events;
        let (now, later): (Vec<Push>, _) =
            self.pushes.iter().partition(|push| push.event <= events);
        self.pushes = later;
        for push in now {
            self.rig.push(push.axis, push.steps);
        }
    }

    #[cold]
    fn lose(&mut self) {
        self.loss_count = self.rig.loss_count();
        let here = FirstLoss {
            event: self.events,
            time_s: self.seconds(),
            at_nm: self.in_nm(self.tool()),
        };
        self.losses.lose(self.rig.lost_steps(), here);
    }

    /// Step events so far, including take-up.
    pub const fn events(&self) -> u64 {
        self.events
    }

    /// Timer ticks so far.
    pub const fn ticks(&self) -> u64 {
        self.ticks
    }

    /// Seconds so far.
    pub fn seconds(&self) -> f64 {
        self.in_seconds(self.ticks)
    }

    /// Converts timer ticks to seconds.
    pub fn in_seconds(&self, ticks: u64) -> f64 {
        ticks as f64 / f64::from(self.timer_hz)
    }

    /// Position of the tool, steps.
    pub const fn tool(&self) -> [i32; AXES] {
        self.rig.tool()
    }

    /// Nanometres per step of each axis.
    pub const fn nm_per_step(&self) -> [f64; AXES] {
        self.nm_per_step
    }

    /// Converts steps to nm.
    #[inline]
    pub fn in_nm(&self, steps: [i32; AXES]) -> [f64; AXES] {
        std::array::from_fn(|axis| f64::from(steps[axis]) * self.nm_per_step[axis])
    }

    /// Inputs of the drivers.
    pub fn levels(&self) -> &[Levels; AXES] {
        self.motors.levels()
    }

    /// Steps that the motors lost.
    pub const fn losses(&self) -> &Losses {
        &self.losses
    }

    /// Counts of the encoders, from the homed position.
    pub fn counts(&self) -> [i64; AXES] {
        let motor = self.rig.motor();
        std::array::from_fn(|axis| {
            self.encoders[axis].map_or(0, |(counts, steps)| {
                (i64::from(motor[axis]) * counts).div_euclid(steps)
            })
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const FORWARD: StepEvent<AXES> = StepEvent {
        wait_ticks: 10_000,
        delta: [1, 0, 0, 0, 0, 0],
    };

    #[test]
    fn the_tool_follows_and_a_push_is_a_loss() {
        let file = MachineFile::built_in("micromill").unwrap();
        let mut mechanics = Mechanics::new(&file, false).unwrap();
        mechanics.set_pushes(&["X:6:-4".parse().unwrap()]);
        for _ in 0..5 {
            mechanics.step(&FORWARD);
        }
        assert_eq!(
            (mechanics.tool(), mechanics.events()),
            ([5, 0, 0, 0, 0, 0], 5)
        );
        assert_eq!(mechanics.losses().lost(), [0; AXES]);
        mechanics.rest(7);
        mechanics.step(&FORWARD);
        assert_eq!(mechanics.ticks(), 60_007);
        assert_eq!(mechanics.losses().lost(), [4, 0, 0, 0, 0, 0]);
        let first = mechanics.losses().first()[0].unwrap();
        assert_eq!((first.event, first.time_s), (6, mechanics.seconds()));
    }

    #[test]
    fn backlash_holds_the_tool_back() {
        let file = MachineFile::built_in("micromill").unwrap();
        let mut mechanics = Mechanics::new(&file, false).unwrap();
        mechanics.start_at([3, 0, 0, 0, 0, 0]);
        let back = StepEvent {
            delta: [-1, 0, 0, 0, 0, 0],
            ..FORWARD
        };
        for _ in 0..5 {
            mechanics.step(&back);
        }
        assert_eq!(mechanics.tool(), [3, 0, 0, 0, 0, 0]);
    }
}
