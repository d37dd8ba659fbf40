//! Real-time bytes and buttons.

use husillo_gcode::Block;
use husillo_transports::grbl::{Feedback, Realtime};

use super::door::DoorStep;
use super::{Grbl, GrblInputs, Phase, ROOM_FOR_REPORT, Task};

/// Further requests for a report are ignored for this time after a report, in microseconds.
const MERGE_US: u32 = 600;
/// During a dwell requests are handled at whole multiples of this time before its end, as in Grbl,
/// in microseconds.
const DWELL_STEP_US: u64 = 50_000;

/// Requests of real-time bytes and buttons that are not handled yet.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Flags {
    pub(super) reset: bool,
    pub(super) status: bool,
    pub(super) resume: bool,
    pub(super) hold: bool,
    pub(super) door: bool,
    jog_cancel: bool,
    spindle_stop: bool,
    flood: bool,
    mist: bool,
}

impl<const QUEUE: usize> Grbl<QUEUE> {
    /// Takes a real-time byte. Returns whether the motors must stop immediately.
    pub(super) fn take_realtime(&mut self, realtime: Realtime) -> bool {
        if self.options.has_accidents
            && matches!(realtime, Realtime::Feed(_) | Realtime::Spindle(_))
            && !self.accidents.counts(realtime.byte())
        {
            return false;
        }
        let flags = &mut self.flags;
        let [feed, rapid, spindle] = &mut self.overrides;
        let before = [*feed, *rapid, *spindle];
        match realtime {
            Realtime::Reset => {
                flags.reset = true;
                return !self.options.brakes_at_reset();
            }
            // Several requests in quick succession get one report.
            Realtime::Status => flags.status |= self.merge_us == 0,
            Realtime::Resume => flags.resume = true,
            Realtime::Hold => flags.hold = true,
            Realtime::Door => flags.door = true,
            Realtime::JogCancel => flags.jog_cancel = true,
            Realtime::Feed(adjust) => *feed = adjust.apply(*feed),
            Realtime::Rapid(percent) => *rapid = percent,
            Realtime::Spindle(adjust) => *spindle = adjust.apply(*spindle),
            Realtime::SpindleStop => flags.spindle_stop = true,
            Realtime::Flood => flags.flood = true,
            Realtime::Mist => flags.mist = true,
            Realtime::Unknown(_) => {}
        }
        if self.overrides != before {
            self.apply_overrides();
        }
        false
    }

    /// Applies the overrides and reports them.
    pub(super) fn apply_overrides(&mut self) {
        let [feed, rapid, _] = self.effective_overrides();
        self.machine.set_feed_override(feed);
        self.machine.set_rapid_override(rapid);
        self.report_overrides();
        self.drive();
    }

    /// Returns the overrides that take effect, in percent.
    pub(super) fn effective_overrides(&self) -> [u8; 3] {
        #[cfg(feature = "grblhal")]
        if self.is_hal() {
            return self.hal_overrides();
        }
        self.overrides
    }

    /// Takes the levels of the inputs.
    pub(super) fn take_inputs(&mut self, inputs: &GrblInputs) {
        let before = core::mem::replace(&mut self.inputs, *inputs);
        let falls = |before: bool, now: bool| before && !now;
        self.flags.hold |= falls(before.hold, inputs.hold);
        self.flags.resume |= falls(before.start, inputs.start);
        self.flags.reset |= falls(before.reset, inputs.reset);
        if self.options.has_door {
            self.flags.door |= falls(before.door, inputs.door);
        }
        let is_free = !matches!(self.phase, Phase::Alarm | Phase::Home) && !self.is_recovering();
        if before.limits != inputs.limits && self.settings().is_set(21) && is_free {
            self.hard_limit();
        }
        self.watch_homing();
        self.watch_probe();
    }

    /// Whether a limit switch of an axis is closed.
    pub(super) fn is_limit_closed(&self, axis: usize) -> bool {
        let is_high = self.inputs.limits.get(axis).copied().unwrap_or(true);
        is_high == self.settings().is_set(5)
    }

    /// Whether the door is open.
    pub(super) const fn is_door_open(&self) -> bool {
        self.options.has_door && !self.inputs.door
    }

    /// Whether the time of a dwell passes.
    pub(super) fn is_dwelling(&self) -> bool {
        self.task == Task::Dwell && self.phase == Phase::Idle
    }

    /// Returns the time until requests are handled during a dwell, or until its end.
    pub(super) fn dwell_wait_us(&self) -> Option<u32> {
        if !self.is_dwelling() {
            return None;
        }
        let rest = self.dwell_us.checked_sub(1)? % DWELL_STEP_US;
        Some(rest.wrapping_add(1) as u32) // at most one step
    }

    /// Handles the requests. Returns whether there may be more to do.
    pub(super) fn take_flags(&mut self) -> bool {
        if self.is_dwelling() && !self.dwell_us.is_multiple_of(DWELL_STEP_US) {
            return false;
        }
        let has_room = self.room() >= ROOM_FOR_REPORT;
        if self.flags.status && self.phase != Phase::Home && has_room {
            self.flags.status = false;
            self.merge_us = MERGE_US;
            self.report_status();
            return true;
        }
        #[cfg(feature = "grblhal")]
        if self.is_hal() && self.phase != Phase::Home && self.hal_take_flags() {
            return true;
        }
        let flags = self.flags;
        self.flags = Flags {
            status: flags.status,
            door: flags.door && self.is_cancelling,
            ..Flags::default()
        };
        if flags.door && !self.is_cancelling {
            self.open_door();
        }
        if flags.hold {
            self.hold();
        }
        if flags.jog_cancel && self.phase == Phase::Jog {
            self.cancel_jog();
        }
        if flags.resume {
            self.resume();
        }
        if flags.spindle_stop && self.phase == Phase::Hold(false) && self.outputs.is_on() {
            self.toggle_spindle();
        }
        if matches!(self.phase, Phase::Idle | Phase::Run | Phase::Hold(_)) {
            self.toggle_coolant(flags.flood, flags.mist && self.options.has_mist);
        }
        false
    }

    fn hold(&mut self) {
        match self.phase {
            Phase::Idle => self.phase = Phase::Hold(false),
            Phase::Run => {
                self.brake();
                self.phase = Phase::Hold(true);
            }
            Phase::Jog => self.cancel_jog(),
            _ => {}
        }
    }

    pub(super) fn cancel_jog(&mut self) {
        self.brake();
        self.is_cancelling = true;
    }

    /// Handles a hold whose motors have stopped.
    pub(super) fn hold_stopped(&mut self) {
        self.phase = Phase::Hold(false);
        self.rest_motors();
        if self.outputs.is_laser && self.outputs.is_on() {
            self.outputs.is_stopped = true;
            self.report_overrides();
            self.drive();
        }
    }

    fn resume(&mut self) {
        match self.phase {
            Phase::Hold(false) => {
                if self.outputs.is_stopped {
                    let reports = self.reports;
                    self.toggle_spindle();
                    if self.outputs.is_laser {
                        self.reports = reports;
                    }
                }
                self.resume_moves();
                #[cfg(feature = "grblhal")]
                if self.is_hal() {
                    self.tell(Feedback::Other(b""));
                }
            }
            Phase::Door(DoorStep::Stands) if !self.is_door_open() => self.restore(),
            Phase::Idle => self.start_us = 0,
            #[cfg(feature = "grblhal")]
            Phase::Tool if !self.is_door_open() => self.hal_resume_change(),
            _ => {}
        }
    }

    /// Continues with the program, or ends a probe move that has found its contact.
    pub(super) fn resume_moves(&mut self) {
        if matches!(self.task, Task::Probe { .. }) && self.contact.is_some() {
            return self.probe_stopped();
        }
        if self.task == Task::Pause {
            self.task = Task::Block;
        }
        self.machine.resume();
        // The hold may have ended before Grbl's segments.
        self.brake_us = 0;
        let has_moves = self.machine.queued() > 0 || self.rest.is_some();
        self.phase = if has_moves { Phase::Run } else { Phase::Idle };
    }

    fn toggle_spindle(&mut self) {
        self.outputs.is_stopped = !self.outputs.is_stopped;
        self.report_overrides();
        self.drive();
        if !self.outputs.is_stopped {
            self.tell(Feedback::RestoringSpindle);
        }
    }

    fn toggle_coolant(&mut self, flood: bool, mist: bool) {
        if !flood && !mist {
            return;
        }
        self.outputs.flood ^= flood;
        self.outputs.mist ^= mist;
        self.report_overrides();
        self.drive();
        // The modal state must agree with the outputs.
        self.change_modes(b"M9");
        if self.outputs.flood {
            self.change_modes(b"M8");
        }
        if self.outputs.mist {
            self.change_modes(b"M7");
        }
    }

    /// Changes the modal state by a block that gives no commands.
    pub(super) fn change_modes(&mut self, text: &[u8]) {
        let mut block = Block::new();
        if block.read(text, self.modal.dialect()).is_ok() {
            if let Ok((modal, _)) = self.modal.plan(&block) {
                self.modal = modal;
            }
        }
    }
}
