//! Alarms, resets and the start.

use husillo_gcode::{Modal, Nm};
use husillo_transports::grbl::{Alarm, ErrorCode, Feedback, Message};

use super::lines::{Origin, Task};
use super::realtime::Flags;
use super::{Grbl, Phase};

/// Time after an alarm during which no line is executed, in microseconds.
const DEAF_US: u32 = 500_000;
/// The same for grblHAL.
#[cfg(feature = "grblhal")]
const HAL_DEAF_US: u32 = 100_000;

/// States in which no line is executed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Recovery {
    None,
    /// No line is executed for this time after an alarm, in microseconds. The second value is what
    /// follows.
    Deaf(u32, After),
    /// No line is executed until the host resets the controller.
    Locked,
    /// The controller waits for this time before the banner, in microseconds.
    Boot(u32),
}

/// What follows the time after an alarm.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum After {
    /// The present line continues.
    GoOn,
    /// The controller is locked until the host resets it.
    Lock,
    /// The controller resets itself.
    Boot,
}

impl Recovery {
    pub(super) const fn wait_us(&self) -> Option<u32> {
        match self {
            Recovery::Deaf(left, _) | Recovery::Boot(left) => Some(*left),
            _ => None,
        }
    }

    pub(super) const fn pass(&mut self, us: u32) {
        if let Recovery::Deaf(left, _) | Recovery::Boot(left) = self {
            *left = left.saturating_sub(us);
        }
    }
}

impl<const QUEUE: usize> Grbl<QUEUE> {
    pub(super) fn is_recovering(&self) -> bool {
        self.recovery != Recovery::None
    }

    fn deaf_us(&self) -> u32 {
        #[cfg(feature = "grblhal")]
        if self.is_hal() {
            return HAL_DEAF_US;
        }
        DEAF_US
    }

    /// Reports an alarm and enters the state Alarm.
    pub(super) fn alarm(&mut self, alarm: Alarm, then: After) {
        self.send(&Message::Alarm(alarm));
        self.phase = Phase::Alarm;
        self.homing.end();
        self.rest_motors();
        self.recovery = Recovery::Deaf(self.deaf_us(), then);
    }

    /// Handles a limit switch that has closed during motion.
    pub(super) fn hard_limit(&mut self) {
        self.drop_moves();
        self.switch_outputs_off();
        self.alarm(Alarm::HardLimit, After::Lock);
    }

    /// Handles a move that leaves the travel. The axes are at rest.
    pub(super) fn soft_limit(&mut self) {
        self.drop_moves();
        self.switch_outputs_off();
        self.alarm(Alarm::SoftLimit, After::Lock);
    }

    /// Continues a reset or an alarm. Returns whether there may be more to do.
    pub(super) fn recover(&mut self) -> bool {
        let is_booting = matches!(
            self.recovery,
            Recovery::Boot(_) | Recovery::Deaf(_, After::Boot)
        );
        if self.flags.reset && !is_booting {
            #[cfg(feature = "grblhal")]
            if self.is_hal() && self.hal_brakes() {
                return false;
            }
            self.flags.reset = false;
            self.interrupt();
            return true;
        }
        match self.recovery {
            Recovery::Deaf(0, then) => {
                self.recovery = Recovery::None;
                match then {
                    After::GoOn => {}
                    After::Lock => {
                        self.send(&Message::Feedback(Feedback::ResetToContinue));
                        self.recovery = Recovery::Locked;
                    }
                    After::Boot => self.boot(),
                }
                true
            }
            Recovery::Boot(0) => {
                self.recovery = Recovery::None;
                self.start();
                true
            }
            _ => false,
        }
    }

    /// Handles a reset: motion stops immediately.
    fn interrupt(&mut self) {
        let alarm = match self.phase {
            Phase::Home => Some(Alarm::HomingReset),
            _ if self.moves() && self.may_have_lost_steps() => Some(Alarm::AbortCycle),
            _ => None,
        };
        self.drop_moves();
        self.switch_outputs_off();
        match alarm {
            Some(alarm) => self.alarm(alarm, After::Boot),
            None => self.boot(),
        }
    }

    /// Whether a motor that stops immediately may have lost steps. It cannot if no axis has moved
    /// since all were at rest. Grbl does not know this.
    fn may_have_lost_steps(&self) -> bool {
        self.has_stepped || self.options.has_accidents
    }

    /// Answers the present line, and resets the controller.
    pub(super) fn boot(&mut self) {
        let is_of_host = matches!(self.origin, Origin::Host | Origin::Store(_))
            && !self.options.brakes_at_reset();
        if self.task != Task::None && is_of_host {
            self.origin = Origin::Host;
            self.send(&Message::Ok);
        }
        self.task = Task::None;
        self.next = None;
        self.commands.clear();
        self.homing.end();
        // Bytes that arrive from now on are kept.
        self.drop_checks();
        self.receiver.clear();
        self.reader.clear();
        #[cfg(feature = "grblhal")]
        self.hal.reader.clear();
        self.flags = Flags::default();
        self.drop_moves();
        self.switch_outputs_off();
        let delay_ms = self.settings().whole(1);
        let delay_us = if delay_ms == 255 || self.options.brakes_at_reset() {
            0
        } else {
            delay_ms.wrapping_mul(1000)
        };
        self.recovery = Recovery::Boot(delay_us);
    }

    /// Starts the controller at power-on.
    pub(super) fn power_on(&mut self) {
        if self.is_blank {
            self.send(&Message::Error(ErrorCode::StoreRead));
            if !self.options.brakes_at_reset() {
                self.list_settings();
            }
        }
        if self.settings().is_set(22) && !self.options.brakes_at_reset() {
            self.phase = Phase::Alarm;
        }
        self.driven_at_start();
        self.boot();
    }

    fn driven_at_start(&mut self) {
        self.drive_motors(true);
        self.rest_motors();
    }

    /// Sets the state after a reset, and sends the banner.
    fn start(&mut self) {
        self.overrides = [100; 3];
        self.machine.set_feed_override(100);
        self.machine.set_rapid_override(100);
        self.reports = [0; 2];
        self.probe = ([0; 3], false);
        self.contact = None;
        self.is_cancelling = false;
        #[cfg(feature = "height-map")]
        self.drop_map();
        self.modal = Modal::new(self.options.dialect());
        self.load_places();
        self.drop_moves();
        #[cfg(feature = "grblhal")]
        if self.is_hal() {
            self.hal_start();
        }
        self.work_zero = self.work_zero_now();
        self.switch_outputs_off();
        self.send(&Message::Blank);
        let banner = self.options.banner;
        self.send(&Message::Banner(banner));
        let is_at_limit = (0..3).any(|axis| self.is_limit_closed(axis));
        if self.settings().is_set(21) && is_at_limit {
            self.phase = Phase::Alarm;
            self.send(&Message::Feedback(Feedback::CheckLimits));
        }
        if matches!(self.phase, Phase::Alarm | Phase::Sleep) {
            self.phase = Phase::Alarm;
            self.tell_lock();
            return;
        }
        self.phase = Phase::Idle;
        self.flags.door = self.is_door_open();
        self.origin = Origin::Startup(0);
        self.task = Task::Startup(0);
    }

    /// Tells that motion is locked.
    fn tell_lock(&mut self) {
        #[cfg(feature = "grblhal")]
        if self.is_hal() {
            return self.hal_tell_lock();
        }
        self.send(&Message::Feedback(Feedback::Unlock));
    }

    /// Copies the stored coordinate data to the modal state.
    pub(super) fn load_places(&mut self) {
        for (number, place) in (0_u8..).zip(self.memory.places) {
            let place = place.map(Nm);
            match number {
                0..=5 => {
                    self.modal.set_work_zero(number, place);
                }
                6 => self.modal.set_home(place),
                _ => self.modal.set_second_home(place),
            }
        }
    }

    /// Stores the coordinate data of the modal state if they have changed.
    pub(super) fn keep_places(&mut self) {
        let mut places = [[0; 3]; 8];
        for (number, slot) in (0_u8..).zip(&mut places) {
            let place = match number {
                0..=5 => self.modal.work_zero(number).unwrap_or([Nm(0); 3]),
                6 => self.modal.home(),
                _ => self.modal.second_home(),
            };
            *slot = place.map(|nm| nm.0);
        }
        if places != self.memory.places {
            self.memory.places = places;
            self.store();
        }
    }
}
