//! The safety door.

use husillo_transports::grbl::{Alarm, Feedback};

use super::recovery::After;
use super::{Grbl, Phase};

/// Time for the spindle to reach its speed, us.
const SPINDLE_US: u32 = 4_000_000;
/// Time for the coolant to flow, us.
const COOLANT_US: u32 = 1_000_000;

/// State of the controller while the safety door is open, and while the outputs are restored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum DoorStep {
    Braking,
    /// The axes are at rest, and spindle and coolant are off.
    Stands,
    /// The spindle starts. The number is the rest of its time, in microseconds.
    Spindle(u32),
    /// The coolant starts. The number is the rest of its time, in microseconds.
    Coolant(u32),
}

impl DoorStep {
    pub(super) fn is_braking(self) -> bool {
        self == DoorStep::Braking
    }
}

impl<const QUEUE: usize> Grbl<QUEUE> {
    /// Handles an opened door, and the byte 0x84.
    pub(super) fn open_door(&mut self) {
        self.flags.door = false;
        match self.phase {
            Phase::Alarm | Phase::Check | Phase::Sleep => return,
            Phase::Home => {
                self.drop_moves();
                return self.alarm(Alarm::HomingDoor, After::Boot);
            }
            Phase::Jog => {
                self.flags.door = true;
                return self.cancel_jog();
            }
            Phase::Run => {
                self.brake();
                self.phase = Phase::Door(DoorStep::Braking);
            }
            Phase::Hold(true) => self.phase = Phase::Door(DoorStep::Braking),
            Phase::Door(DoorStep::Braking) => {}
            #[cfg(feature = "grblhal")]
            Phase::Tool => return,
            Phase::Idle | Phase::Hold(false) | Phase::Door(_) => self.door_stopped(),
        }
        self.tell(Feedback::CheckDoor);
    }

    /// Switches the outputs off when the axes are at rest.
    pub(super) fn door_stopped(&mut self) {
        if self.phase == Phase::Door(DoorStep::Braking) {
            self.rest_motors();
        }
        self.phase = Phase::Door(DoorStep::Stands);
        self.outputs.is_stopped = true;
        self.outputs.is_coolant_stopped = true;
        self.report_overrides();
        #[cfg(feature = "grblhal")]
        self.hal_show_accessories();
        self.drive();
    }

    /// Returns the times that spindle and coolant need, in microseconds.
    fn delays_us(&self) -> [u32; 2] {
        #[cfg(feature = "grblhal")]
        if self.is_hal() {
            return self.hal_delays_us();
        }
        [SPINDLE_US, COOLANT_US]
    }

    /// Restores the outputs when the door is closed and the operator resumes.
    pub(super) fn restore(&mut self) {
        self.phase = Phase::Door(DoorStep::Spindle(0));
        self.outputs.is_stopped = false;
        if self.outputs.is_on() {
            self.phase = Phase::Door(DoorStep::Spindle(self.delays_us()[0]));
            self.report_overrides();
            self.drive();
        } else {
            self.restore_coolant();
        }
    }

    fn restore_coolant(&mut self) {
        self.outputs.is_coolant_stopped = false;
        if self.outputs.flood || self.outputs.mist {
            self.phase = Phase::Door(DoorStep::Coolant(self.delays_us()[1]));
            self.report_overrides();
            self.drive();
        } else {
            self.resume_moves();
        }
    }

    pub(super) const fn door_wait_us(&self) -> Option<u32> {
        match self.phase {
            Phase::Door(DoorStep::Spindle(left) | DoorStep::Coolant(left)) => Some(left),
            _ => None,
        }
    }

    pub(super) fn pass_door(&mut self, us: u32) {
        let Phase::Door(DoorStep::Spindle(left) | DoorStep::Coolant(left)) = &mut self.phase else {
            return;
        };
        *left = left.saturating_sub(us);
        match self.phase {
            Phase::Door(DoorStep::Spindle(0)) => self.restore_coolant(),
            Phase::Door(DoorStep::Coolant(0)) => self.resume_moves(),
            _ => {}
        }
    }
}
