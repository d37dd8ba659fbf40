//! Real-time bytes beyond those of Grbl.

use husillo_transports::grbl::{Feedback, Receiver};

use super::super::{Grbl, Phase, ROOM_FOR_REPORT, Task};

/// Requests that are not handled yet.
#[derive(Clone, Copy, Debug)]
pub(super) struct HalFlags {
    full_report: bool,
    report: bool,
    modal: bool,
    stop: bool,
    tool: bool,
}

impl HalFlags {
    pub(super) const NONE: HalFlags = HalFlags {
        full_report: false,
        report: false,
        modal: false,
        stop: false,
        tool: false,
    };
}

impl<const QUEUE: usize> Grbl<QUEUE> {
    /// Takes a byte of the line before the receive buffer. Returns whether it was a real-time byte.
    pub(in super::super) fn hal_takes(&mut self, byte: u8) -> bool {
        let hal = &mut self.hal;
        match byte {
            0x05 => hal.flags.report = true,
            0x0b => {}
            0x19 => hal.flags.stop = true,
            0x80 => self.flags.status = true,
            0x81 => self.flags.resume = true,
            0x82 => self.flags.hold = true,
            0x83 => hal.flags.modal = true,
            0x87 => hal.flags.full_report = true,
            0x88 => hal.ignores_optional_stop = !hal.ignores_optional_stop,
            0x89 => hal.is_single_block = !hal.is_single_block,
            0xa3 => hal.flags.tool = true,
            _ => return false,
        }
        true
    }

    /// Handles the requests. Returns whether there may be more to do.
    pub(in super::super) fn hal_take_flags(&mut self) -> bool {
        let mut flags = core::mem::replace(&mut self.hal.flags, HalFlags::NONE);
        if self.room() < ROOM_FOR_REPORT {
            // Reports wait, other requests do not.
            self.hal.flags = HalFlags {
                stop: false,
                tool: false,
                ..flags
            };
            (flags.full_report, flags.report, flags.modal) = (false, false, false);
        }
        if flags.full_report || flags.report {
            self.hal_report(flags.full_report);
        }
        if flags.modal {
            self.report_modal();
        }
        if flags.tool {
            self.hal_acknowledge_tool();
        }
        if flags.stop {
            self.hal_stop();
        }
        flags.full_report || flags.report || flags.modal || flags.stop
    }

    /// Stops like a reset, without one: lines and moves are dropped, and outputs go off. Moves
    /// brake first.
    fn hal_stop(&mut self) {
        self.tell(Feedback::Other(b"Stop"));
        self.receiver.clear();
        self.hal.reader.clear();
        self.hal.shown.with_accessories = true;
        self.hal_drop_line();
        match self.phase {
            Phase::Run | Phase::Jog => self.cancel_jog(),
            Phase::Hold(_) | Phase::Tool => {
                self.hal_end_change();
                self.drop_moves();
                self.phase = Phase::Idle;
            }
            _ => {}
        }
        self.switch_outputs_off();
        self.change_modes(b"M5M9");
    }

    /// Drops the rest of the present line, which is answered, and the lines that wait for the
    /// change of a tool.
    fn hal_drop_line(&mut self) {
        self.hal.stash = None;
        self.commands.clear();
        self.next = None;
        self.dwell_us = 0;
        if matches!(self.task, Task::Sync | Task::Dwell | Task::Pause) {
            self.task = Task::Block;
        }
    }

    /// Lets the sender work during the change of a tool: lines that were sent before wait until it
    /// is over.
    fn hal_acknowledge_tool(&mut self) {
        if self.phase == Phase::Tool && self.hal.stash.is_none() {
            let waiting = core::mem::replace(&mut self.receiver, Receiver::new());
            self.hal.stash = Some(waiting);
            self.hal.reader.clear();
        }
    }

    /// Counts the time to the next report that no byte requests.
    pub(in super::super) fn hal_pass(&mut self, us: u32) {
        let every_ms = self.memory.hal.milli(super::setting::REPORT_EVERY) / 1000;
        if every_ms == 0 {
            return;
        }
        let left = self.hal.report_us.saturating_sub(us);
        self.hal.report_us = left;
        if left == 0 {
            self.hal.report_us = every_ms.wrapping_mul(1000); // at most 1 000 000
            self.hal.flags.report = true;
        }
    }

    /// Returns the time to the next report that no byte requests.
    pub(in super::super) fn hal_wait_us(&self) -> Option<u32> {
        let every_ms = self.memory.hal.milli(super::setting::REPORT_EVERY) / 1000;
        (every_ms > 0).then(|| self.hal.report_us.max(1))
    }
}
