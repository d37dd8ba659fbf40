//! The position of Z between its sensors, and a check of these sensors.

use super::task::{Next, Task};
use super::{Drill, DrillConfig, DrillEvent, DrillFault, DrillInputs, Z};

/// The steps of Z, for comparison with its sensors.
#[derive(Copy, Clone, Debug)]
pub(super) struct Stroke {
    /// Steps below the point where the upper sensor closed last. `None`: not known.
    depth: Option<u16>,
    /// Whether the upper sensor has ever closed. If it has not, it may stick when it closes.
    has_closed: bool,
    /// Whether the upper sensor has opened since it closed last.
    has_opened: bool,
    /// Whether the lower sensor was closed at the last check.
    was_down: bool,
}

impl Stroke {
    /// The state after power-on or a reset.
    pub(super) const UNKNOWN: Self = Self {
        depth: None,
        has_closed: false,
        has_opened: false,
        was_down: false,
    };

    fn step(&mut self, direction: i8) {
        self.depth = (self.depth).map(|depth| depth.saturating_add_signed(direction.into()));
    }

    /// Compares the sensors with the steps. `rises`: Z moves up, so the upper sensor closes at its
    /// known position.
    fn check(
        &mut self,
        config: &DrillConfig,
        inputs: &DrillInputs,
        rises: bool,
    ) -> Option<DrillFault> {
        let shortest = config.shortest_stroke_steps?;
        let (is_up, is_down) = (inputs.is_up, inputs.is_down);
        let was_down = core::mem::replace(&mut self.was_down, is_down);
        if let Some(depth) = self.depth {
            if is_up && depth > config.back_off_steps {
                return Some(DrillFault::UpClosed);
            }
            // The sensor closes at a known position. It opens again at a position that is not known
            // exactly.
            let play = if was_down { config.back_off_steps } else { 0 };
            if is_down && (is_up || depth < shortest.saturating_sub(play)) {
                return Some(DrillFault::DownClosed);
            }
        } else if is_up && is_down {
            return Some(DrillFault::BothClosed);
        }
        if is_up && rises && self.has_opened {
            (self.depth, self.has_opened) = (Some(0), false);
        }
        self.has_closed |= is_up;
        self.has_opened |= self.has_closed && !is_up;
        None
    }
}

impl<const N: usize> Drill<N> {
    /// Whether the steps of Z show that a sensor is wrong. The drill then stops with a fault.
    pub(super) fn finds_stuck_sensor(&mut self, inputs: &DrillInputs, rises: bool) -> bool {
        let fault = self.stroke.check(&self.config, inputs, rises);
        if let Some(fault) = fault {
            self.task = self.fault(fault);
        }
        fault.is_some()
    }

    /// Whether Z has to move off the upper sensor, because the sensor is closed but has not been
    /// seen to open and close again. A sensor that sticks reports closed even while the bit is
    /// in the board.
    pub(super) const fn doubts_upper_sensor(&self) -> bool {
        self.config.shortest_stroke_steps.is_some() && self.stroke.depth.is_none()
    }

    /// Moves down until the upper sensor opens. When Z moves up again, the sensor closes after a
    /// short distance.
    pub(super) fn open_up(
        &mut self,
        left: u16,
        next: Next,
        inputs: &DrillInputs,
    ) -> Option<DrillEvent> {
        if self.finds_stuck_sensor(inputs, false) {
            return None;
        }
        if !inputs.is_up {
            self.task = Task::Up {
                left: self.config.back_off_steps,
                next,
            };
            return None;
        }
        let Some(left) = left.checked_sub(1) else {
            self.task = self.fault(DrillFault::UpClosed);
            return None;
        };
        self.task = Task::OpenUp { left, next };
        self.step_z(1)
    }

    /// Steps Z; positive is down.
    pub(super) fn step_z(&mut self, direction: i8) -> Option<DrillEvent> {
        self.stroke.step(direction);
        self.step(Z, direction)
    }
}
