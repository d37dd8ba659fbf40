//! Probe moves.

use husillo_gcode::Command;
use husillo_transports::grbl::Alarm;

use super::lines::{Outcome, Task};
use super::recovery::After;
use super::{Grbl, Phase};

impl<const QUEUE: usize> Grbl<QUEUE> {
    pub(super) fn is_probe_closed(&self) -> bool {
        self.inputs.probe == self.settings().is_set(6)
    }

    /// Begins a probe move. The axes are at rest.
    pub(super) fn begin_probe(&mut self, command: Command<3>, away: bool, must: bool) {
        self.contact = None;
        if self.is_probe_closed() != away {
            self.drop_moves();
            self.task = Task::ProbeFailed { has_moved: false };
            return self.alarm(Alarm::ProbeInitial, After::GoOn);
        }
        self.task = Task::Probe { away, must };
        self.append(command);
    }

    /// Latches the position of the contact, and begins to brake.
    pub(super) fn watch_probe(&mut self) {
        let Task::Probe { away, .. } = self.task else {
            return;
        };
        if self.contact.is_none() && self.moves() && self.is_probe_closed() != away {
            self.contact = Some(self.steps);
            self.brake();
        }
    }

    /// Ends the probe move.
    pub(super) fn probe_stopped(&mut self) {
        let Task::Probe { must, .. } = self.task else {
            return;
        };
        self.drop_moves();
        self.phase = Phase::Idle;
        self.rest_motors();
        #[cfg(feature = "grblhal")]
        if self.hal.change.is_measuring() {
            return self.hal_takes_contact();
        }
        #[cfg(feature = "height-map")]
        if self.is_surveying() {
            return self.take_height();
        }
        match self.contact {
            Some(steps) => self.probe = (self.position_of(steps).map(|nm| nm.0), true),
            None if must => {
                self.probe.1 = false;
                #[cfg(feature = "grblhal")]
                if self.is_hal() {
                    self.probe.0 = self.position().map(|nm| nm.0);
                }
                self.task = Task::ProbeFailed { has_moved: true };
                return self.alarm(Alarm::ProbeContact, After::GoOn);
            }
            None => self.probe = (self.position().map(|nm| nm.0), false),
        }
        self.report_probe();
        self.end_line(Ok(Outcome::Done));
    }
}
