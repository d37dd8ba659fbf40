//! The height map: Z follows a surface that is not flat.
//!
//! ```text
//!  $Z lines ─► command ─► map       grid and heights, kept while the power is off
//!                 ├─────► survey    the machine probes the grid
//!                 └─────► limits    rates that keep Z within its own
//!  steps of the engine ─► follower ─► steps of the motors
//! ```
//!
//! The engine knows nothing of the map. Its steps are those of the program, and all positions are
//! its positions. The follower adds steps of Z between them, as the surface requires.

mod command;
mod follower;
mod limits;
mod map;
mod survey;

use husillo_gcode::Nm;
use husillo_machine::Config;
use husillo_transports::grbl::{Feedback, Message};

use super::{Grbl, config};

pub(super) use map::HeightMap;

use follower::Follower;
use limits::limit;
use survey::Survey;

/// State of the height map.
#[derive(Clone, Debug)]
pub(super) struct Height {
    /// `None`: the map is off.
    follower: Option<Follower>,
    survey: Survey,
}

impl Height {
    pub(super) const OFF: Height = Height {
        follower: None,
        survey: Survey::NONE,
    };

    /// Returns the steps of the motor of Z that the program has not made.
    pub(super) const fn correction(&self) -> i32 {
        match &self.follower {
            Some(follower) => follower.correction(),
            None => 0,
        }
    }

    pub(super) const fn is_on(&self) -> bool {
        self.follower.is_some()
    }

    /// Handles the end of an event that has waited for `us`.
    pub(super) fn made(&mut self, us: u32) {
        if let Some(follower) = &mut self.follower {
            follower.made(us);
        }
    }

    /// Forgets the event that is not made.
    pub(super) fn dropped(&mut self) {
        if let Some(follower) = &mut self.follower {
            follower.dropped();
        }
    }
}

impl<const QUEUE: usize> Grbl<QUEUE> {
    /// Returns the configuration of the engine. If the map is on, the axes have limits with which Z
    /// follows it. A map that the settings do not permit any more is switched off.
    pub(super) fn config_with_map(&mut self) -> Config<3> {
        let mut config = config(self.settings());
        if self.height.is_on() && self.follow_map(&config) {
            limit(&self.memory.map, &mut config);
        }
        config
    }

    /// Switches the map on. Nothing moves: the position that is reported for Z changes by the
    /// height at the present place.
    ///
    /// Returns `false` without a map, or if its grid cannot be represented in steps.
    pub(super) fn switch_map_on(&mut self) -> bool {
        let config = config(self.settings());
        let is_on = self.follow_map(&config);
        self.configure();
        is_on
    }

    /// Makes a follower for these axes. Returns whether there is one.
    fn follow_map(&mut self, config: &Config<3>) -> bool {
        self.forget_correction();
        let Some(mut follower) = Follower::new(&self.memory.map, &config.axes) else {
            return false;
        };
        let correction = follower.begin(&self.memory.map, self.steps);
        let [_, _, z] = &mut self.steps;
        *z = z.wrapping_sub(correction);
        self.height.follower = Some(follower);
        true
    }

    /// Returns the step of the motor of Z for an event that steps the axes by `delta`.
    pub(super) fn follow(&mut self, delta: [i8; 3], wait_us: u32) -> [i8; 3] {
        let Some(follower) = &mut self.height.follower else {
            return delta;
        };
        let [x, y, z] = delta;
        let [at_x, at_y, _] = self.steps;
        let at = [at_x.wrapping_add(x.into()), at_y.wrapping_add(y.into())];
        let z = follower.step(&self.memory.map, at, z, wait_us);
        [x, y, z]
    }

    /// Returns the time until a step of Z that had to wait, if it is due before the next event of
    /// the engine.
    pub(super) fn late_us(&self) -> Option<u32> {
        self.height.follower.as_ref()?.late_us()
    }

    /// Returns the same when the engine has no further event.
    pub(super) fn last_us(&mut self) -> Option<u32> {
        let follower = self.height.follower.as_mut()?;
        let [x, y, _] = self.steps;
        follower.rest(&self.memory.map, [x, y]);
        follower.late_us()
    }

    /// Switches the map off. Nothing moves: the position that is reported for Z is that of its
    /// motor.
    pub(super) fn switch_map_off(&mut self) {
        self.forget_correction();
        self.configure();
    }

    /// Switches the map off after a reset, or before the axes are homed, and tells it.
    pub(super) fn drop_map(&mut self) {
        self.height.survey.end();
        if self.height.is_on() {
            self.switch_map_off();
            self.send(&Message::Feedback(Feedback::Other(b"Height map off")));
        }
    }

    fn forget_correction(&mut self) {
        let correction = self.height.correction();
        let [_, _, z] = &mut self.steps;
        *z = z.wrapping_add(correction);
        self.height.follower = None;
    }

    /// Returns a position in the present work frame in the machine frame.
    fn of_work(&self, axis: usize, nm: i64) -> Nm {
        let zero = self.work_zero_now();
        Nm(nm.saturating_add(zero.get(axis).copied().unwrap_or(0)))
    }
}
