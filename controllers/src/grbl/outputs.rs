//! Levels of the output pins.

use core::mem::discriminant;

use husillo_gcode::SpindleDirection;

use super::block::motion_code;
use super::spindle::{Outputs, duty};
use super::{Grbl, GrblEvent};

/// Levels that were sent as events.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Driven {
    /// Whether the motors are on.
    motors: bool,
    disable_high: bool,
    counter_clockwise: bool,
    duty: u8,
    flood: bool,
    mist: bool,
    /// Spindle speed that corresponds to the duty cycle.
    pub(super) milli_rpm: u64,
}

impl<const QUEUE: usize> Grbl<QUEUE> {
    /// Appends an event. One of the same kind that is not made yet is replaced, so there are never
    /// more than there are kinds.
    pub(super) fn switch(&mut self, event: GrblEvent) {
        let kind = discriminant(&event);
        match self.events.find_mut(|other| discriminant(other) == kind) {
            Some(other) => *other = event,
            None => self.events.push(event),
        }
    }

    /// Switches the motors on or off.
    pub(super) fn drive_motors(&mut self, on: bool) {
        self.driven.motors = on;
        let is_high = on == self.settings().is_set(4);
        if is_high != self.driven.disable_high {
            self.driven.disable_high = is_high;
            self.switch(GrblEvent::Disable { is_high });
        }
    }

    /// Applies the setting that inverts the enable signal.
    pub(super) fn refresh_motors(&mut self) {
        self.drive_motors(self.driven.motors);
    }

    const fn is_laser(&self) -> bool {
        // This is read at every step, so it is stored with the outputs.
        self.outputs.is_laser
    }

    /// Sends an event for each output that has changed.
    pub(super) fn drive(&mut self) {
        let outputs = self.outputs;
        if outputs.is_on() {
            let is_high = outputs.direction == SpindleDirection::CounterClockwise;
            if is_high != self.driven.counter_clockwise {
                self.driven.counter_clockwise = is_high;
                self.switch(GrblEvent::SpindleDirection { is_high });
            }
        }
        let power = self.power();
        self.drive_duty(power);
        let flows = |is_on: bool| is_on && !outputs.is_coolant_stopped;
        if flows(outputs.flood) != self.driven.flood {
            self.driven.flood = flows(outputs.flood);
            let is_on = self.driven.flood;
            self.switch(GrblEvent::Flood { is_on });
        }
        if flows(outputs.mist) != self.driven.mist {
            self.driven.mist = flows(outputs.mist);
            let is_on = self.driven.mist;
            self.switch(GrblEvent::Mist { is_on });
        }
    }

    /// Switches spindle and coolant off.
    pub(super) fn switch_outputs_off(&mut self) {
        self.outputs = Outputs {
            is_laser: self.settings().is_set(32),
            ..Outputs::OFF
        };
        self.drive();
    }

    /// Adapts the power of a laser to the present move and its speed.
    pub(super) fn drive_laser(&mut self) {
        if self.is_laser() {
            let power = self.power();
            self.drive_duty(power);
        }
    }

    fn drive_duty(&mut self, milli_rpm: u64) {
        let (duty, milli_rpm) = duty(milli_rpm, self.effective_overrides()[2], self.settings());
        self.driven.milli_rpm = milli_rpm;
        if duty != self.driven.duty {
            self.driven.duty = duty;
            self.switch(GrblEvent::SpindleDuty { duty });
        }
    }

    /// Returns the requested speed of the spindle, or power of the laser, at this moment.
    fn power(&self) -> u64 {
        let outputs = &self.outputs;
        if !outputs.is_on() || outputs.is_stopped {
            return 0;
        }
        if !self.is_laser() {
            return outputs.milli_rpm;
        }
        match self.executing().filter(|_| self.moves()) {
            Some(tag) if tag.is_dynamic => {
                let speed = u64::from(self.machine.speed_nm_per_s());
                // The power is below 2^42, because `$30` limits it. The speed is below 2^32.
                let power = u128::from(tag.milli_rpm).wrapping_mul(speed.into());
                let feed = self.machine.executing_feed_nm_per_s().unwrap_or(0);
                let power = power.checked_div(u128::from(feed.max(1)));
                u64::try_from(power.unwrap_or(0)).unwrap_or(u64::MAX)
            }
            Some(tag) => tag.milli_rpm,
            None => {
                let is_constant = outputs.direction == SpindleDirection::Clockwise;
                let is_feed = matches!(motion_code(&self.modal), 10 | 20 | 30);
                if is_constant && is_feed {
                    outputs.milli_rpm
                } else {
                    0
                }
            }
        }
    }

    /// Returns the present direction of the spindle, and whether mist and flood coolant flow.
    pub(super) fn running(&self) -> (Option<SpindleDirection>, bool, bool) {
        let direction = self.outputs.direction;
        let turns = self.driven.duty > 0;
        (
            turns.then_some(direction),
            self.driven.flood,
            self.driven.mist,
        )
    }
}
