//! Tools: the table, the change by M6, and the length by probe.

use husillo_gcode::{Command, Feed, Nm};
use husillo_transports::grbl::{Alarm, ErrorCode, Text};

use super::super::block::units_code;
use super::super::lines::{Outcome, Task};
use super::super::recovery::After;
use super::super::{Grbl, Phase, ROOM_FOR_REPORT};
use super::setting::{
    CHANGE_MODE, CHANGE_OPTIONS, LOCATE_RATE, PROBE_DISTANCE, PULL_OFF_RATE, SEEK_RATE,
};

/// Distance from the first contact to the start of the second search, in nanometres.
const PULL_OFF_NM: i64 = 2_000_000;

/// How a tool is changed: `$341`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Mode {
    /// The machine waits where it is.
    ByHand,
    /// Z goes up first. `$TPW` measures the tool.
    Touched,
    /// The same, and the machine waits above G59.3 for `$TPW`.
    TouchedAtSensor,
    /// The machine measures the tool at G59.3.
    Measured,
    Ignored,
}

/// A step of a change. Each begins when the previous motion has ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Step {
    /// There is no change.
    Off,
    /// M6 was executed, and its block is not answered yet.
    Requested,
    Up,
    ToChange,
    Wait,
    UpAgain,
    ToSensor,
    /// The first search for the contact, the way back, and the second search.
    Seek,
    PullOff,
    Locate,
    /// The motion after the second contact has ended.
    Located,
    Leave,
    Return,
    ReturnDown,
    End,
}

/// State of the tool, and of its change.
#[derive(Clone, Copy, Debug)]
pub(in super::super) struct Change {
    step: Step,
    /// Tool in the spindle.
    pub(super) tool: u32,
    next_tool: u32,
    /// Position to which the tool returns.
    back: [Nm; 3],
    /// Only the length is measured: `$TPW`.
    only_measures: bool,
    /// The code of the tool length, in tenths, and the length that was set last.
    length_code: u16,
    length: [i64; 3],
}

impl Change {
    pub(super) const NONE: Change = Change {
        step: Step::Off,
        tool: 0,
        next_tool: 0,
        back: [Nm(0); 3],
        only_measures: false,
        length_code: 490,
        length: [0; 3],
    };

    pub(super) fn request(&mut self, tool: u32) {
        self.step = Step::Requested;
        self.next_tool = tool;
    }

    pub(in super::super) fn is_requested(&self) -> bool {
        self.step == Step::Requested
    }

    pub(super) fn is_waiting(&self) -> bool {
        self.step == Step::Wait
    }

    /// Whether the present probe move measures a tool.
    pub(in super::super) fn is_measuring(&self) -> bool {
        matches!(self.step, Step::PullOff | Step::Located)
    }

    pub(super) const fn has_length(&self) -> bool {
        self.length_code != 490
    }

    pub(super) const fn is_of_table(&self) -> bool {
        self.length_code == 430
    }

    pub(super) const fn shown_length(&self) -> [i64; 3] {
        self.length
    }

    pub(super) fn set_length(&mut self, length: [Nm; 3], code: u16) {
        self.length_code = code;
        self.length = length.map(|nm| nm.0);
    }

    /// Returns the state after a reset.
    pub(super) const fn after_reset(&self) -> Change {
        Change {
            tool: self.tool,
            length: self.length,
            ..Change::NONE
        }
    }
}

impl<const QUEUE: usize> Grbl<QUEUE> {
    fn hal_mode(&self) -> Mode {
        match self.memory.hal.milli(CHANGE_MODE) / 1000 {
            0 => Mode::ByHand,
            1 => Mode::Touched,
            2 => Mode::TouchedAtSensor,
            3 => Mode::Measured,
            _ => Mode::Ignored,
        }
    }

    /// Begins the change that M6 has requested. Its block is answered.
    pub(in super::super) fn hal_begin_change(&mut self) {
        let mode = self.hal_mode();
        if mode == Mode::Ignored {
            self.hal.change.step = Step::Off;
            return self.hal_set_tool();
        }
        self.hal.change.only_measures = false;
        self.hal.change.back = self.machine.end_position();
        self.hal.change.step = if mode == Mode::ByHand {
            Step::Wait
        } else {
            Step::Up
        };
        self.outputs.is_stopped = true;
        self.outputs.is_coolant_stopped = true;
        self.drive();
        self.hal.shown.with_accessories = true;
        self.hal.shown.with_tool = true;
        self.report_work_zero();
        self.task = Task::Change;
    }

    fn hal_set_tool(&mut self) {
        self.hal.change.tool = self.hal.change.next_tool;
        self.hal.shown.with_tool = true;
        self.hal.shown.with_accessories = true;
        self.hal_keep_tool();
    }

    /// Continues a change when the previous motion has ended. Returns whether there may be more to
    /// do.
    pub(in super::super) fn hal_continue_change(&mut self) -> bool {
        if !self.is_drained() {
            return false;
        }
        let step = self.hal.change.step;
        let at = self.machine.end_position();
        let [x, y, _] = at;
        let [sensor_x, sensor_y, _] = self.modal.work_zero(8).unwrap_or_default();
        match step {
            Step::Up => self.hal_rapid([x, y, Nm(0)], Step::ToChange),
            Step::ToChange => {
                let is_at_g30 = self.hal_has_option(1);
                match self.hal_mode() {
                    Mode::TouchedAtSensor => {
                        self.hal_rapid([sensor_x, sensor_y, Nm(0)], Step::Wait);
                    }
                    _ if is_at_g30 => {
                        let [x, y, _] = self.modal.second_home();
                        self.hal_rapid([x, y, Nm(0)], Step::Wait);
                    }
                    _ => self.hal.change.step = Step::Wait,
                }
            }
            Step::Wait => {
                self.task = Task::None;
                self.phase = Phase::Tool;
                return true;
            }
            Step::UpAgain => self.hal_rapid([x, y, Nm(0)], Step::ToSensor),
            Step::ToSensor => self.hal_rapid([sensor_x, sensor_y, Nm(0)], Step::Seek),
            Step::Seek | Step::PullOff | Step::Locate | Step::Located => self.hal_measure_step(),
            Step::Leave if self.hal.change.only_measures => {
                let [_, _, z] = self.hal.change.back;
                self.hal_rapid([x, y, z], Step::End);
            }
            Step::Leave => self.hal_rapid([x, y, Nm(0)], Step::Return),
            Step::Return => {
                if self.hal_has_option(0) {
                    let [x, y, _] = self.hal.change.back;
                    self.hal_rapid([x, y, Nm(0)], Step::ReturnDown);
                } else {
                    self.hal.change.step = Step::End;
                }
            }
            Step::ReturnDown => {
                let [_, _, z] = self.hal.change.back;
                self.hal_rapid([x, y, z], Step::End);
            }
            Step::End | Step::Off | Step::Requested => self.hal_finish_change(),
        }
        true
    }

    /// Makes the next step of the measurement of a tool.
    fn hal_measure_step(&mut self) {
        let [x, y, z] = self.machine.end_position();
        let [_, _, sensor_z] = self.modal.work_zero(8).unwrap_or_default();
        match self.hal.change.step {
            // The search begins at the height of G59.3.
            Step::Seek if !self.hal.change.only_measures && sensor_z < z => {
                self.hal_rapid([x, y, sensor_z], Step::Seek);
            }
            Step::Seek => self.hal_search(SEEK_RATE, Step::PullOff),
            Step::PullOff => {
                let up = Nm(z.0.saturating_add(PULL_OFF_NM));
                self.hal_feed([x, y, up], PULL_OFF_RATE, Step::Locate);
            }
            Step::Locate => self.hal_search(LOCATE_RATE, Step::Located),
            _ => {
                self.hal_take_length();
                self.hal.change.step = Step::Leave;
            }
        }
    }

    /// Whether a bit of `$346` is set.
    fn hal_has_option(&self, bit: u32) -> bool {
        let bits = self.memory.hal.milli(CHANGE_OPTIONS) / 1000;
        bits.wrapping_shr(bit) & 1 == 1
    }

    /// Ends a change, or the measurement by `$TPW`, which is answered.
    fn hal_finish_change(&mut self) {
        let only_measures = self.hal.change.only_measures;
        self.hal_end_change();
        let position: [Nm; 3] = self.machine.end_position();
        self.modal.set_position(position);
        if only_measures {
            // The change goes on when the operator resumes it.
            if self.hal.stash.is_some() {
                self.hal_wait_again();
            }
            self.end_line(Ok(Outcome::Done));
            return;
        }
        self.outputs.is_stopped = false;
        self.outputs.is_coolant_stopped = false;
        self.drive();
    }

    /// Returns to the state in which the operator changes the tool.
    pub(super) fn hal_wait_again(&mut self) {
        self.phase = Phase::Tool;
        self.hal.change.step = Step::Wait;
    }

    /// Forgets a change in progress, and takes the lines that have waited for it.
    pub(super) fn hal_end_change(&mut self) {
        self.hal.change.step = Step::Off;
        self.task = Task::None;
        if !self.hal.change.only_measures {
            if let Some(waiting) = self.hal.stash.take() {
                self.receiver = waiting;
            }
        }
    }

    /// Handles the start button while a tool is changed by hand.
    pub(in super::super) fn hal_resume_change(&mut self) {
        self.phase = Phase::Idle;
        self.hal_set_tool();
        if let Some(waiting) = self.hal.stash.take() {
            self.receiver = waiting;
            self.hal.reader.clear();
        }
        let mode = self.hal_mode();
        self.hal.change.only_measures = false;
        self.hal.change.step = match mode {
            Mode::Measured => Step::UpAgain,
            Mode::Touched | Mode::TouchedAtSensor => Step::Leave,
            _ => Step::End,
        };
        self.task = Task::Change;
        if mode == Mode::ByHand {
            // The position is where the operator has left it.
            self.hal_finish_change();
            if self.room() >= ROOM_FOR_REPORT {
                self.hal_report(false);
            }
        }
    }

    fn hal_rapid(&mut self, to: [Nm; 3], next: Step) {
        self.hal.change.step = next;
        self.append(Command::Rapid { to });
    }

    fn hal_feed(&mut self, to: [Nm; 3], rate: usize, next: Step) {
        self.hal.change.step = next;
        let feed = self.hal_rate(rate);
        self.append(Command::Linear { to, feed });
    }

    fn hal_rate(&self, rate: usize) -> Feed {
        // In thousandths of a millimetre per minute, below 2^32.
        let nm = i64::from(self.memory.hal.milli(rate)).wrapping_mul(1000);
        Feed::PerMinute(Nm(nm.max(1_000_000)))
    }

    fn hal_search(&mut self, rate: usize, next: Step) {
        self.hal.change.step = next;
        let [x, y, z] = self.machine.end_position();
        let distance = i64::from(self.memory.hal.milli(PROBE_DISTANCE)).wrapping_mul(1000);
        let to = [x, y, Nm(z.0.saturating_sub(distance))];
        let feed = self.hal_rate(rate);
        if self.is_probe_closed() {
            return self.hal_fail_search(Alarm::ProbeInitial, false);
        }
        self.begin_probe(Command::Linear { to, feed }, false, true);
    }

    /// Takes the contact of a probe move that measures a tool.
    pub(in super::super) fn hal_takes_contact(&mut self) {
        match self.contact {
            Some(steps) => {
                self.probe = (self.position_of(steps).map(|nm| nm.0), true);
                self.task = Task::Change;
            }
            None => self.hal_fail_search(Alarm::ProbeContact, true),
        }
    }

    /// Ends a change whose probe move has failed.
    fn hal_fail_search(&mut self, alarm: Alarm, has_moved: bool) {
        let only_measures = self.hal.change.only_measures;
        self.hal_end_change();
        self.drop_moves();
        if only_measures {
            self.task = Task::ProbeFailed { has_moved };
        }
        self.alarm(alarm, After::GoOn);
    }

    /// Takes the contact as that of the reference tool, or sets the length of the tool from it.
    fn hal_take_length(&mut self) {
        self.report_probe();
        let ([_, _, contact], _) = self.probe;
        match self.hal.reference {
            None => {
                self.hal.reference = Some(contact);
                self.hal.shown.with_reference = true;
            }
            Some(reference) => self.hal_set_length(contact.saturating_sub(reference)),
        }
    }

    /// Sets the length of the tool along Z in nanometres, as G43.1 does.
    fn hal_set_length(&mut self, nm: i64) {
        let mut text = Text::new();
        text.put(b"G21G43.1Z");
        text.put_decimal(nm, 6);
        let units: &[u8] = if units_code(&self.modal) == 200 {
            b"G20"
        } else {
            b"G21"
        };
        self.change_modes(text.bytes());
        self.change_modes(units);
        let length = self.modal.tool_length();
        self.hal.change.set_length(length, 431);
        self.report_work_zero();
    }

    /// `$TPW`: measures the tool by the probe below it.
    ///
    /// # Errors
    /// The tool is not changed by touching the probe.
    pub(super) fn hal_measure(&mut self) -> Result<Outcome, ErrorCode> {
        if !matches!(self.hal_mode(), Mode::Touched | Mode::TouchedAtSensor) {
            return Err(ErrorCode::InvalidStatement);
        }
        self.hal.change.only_measures = true;
        self.hal.change.back = self.machine.end_position();
        self.hal.change.step = Step::Seek;
        self.phase = Phase::Idle;
        self.task = Task::Change;
        Ok(Outcome::Waits)
    }

    /// `$TLR`: takes the last contact as that of the reference tool. Without a contact there is no
    /// reference any more.
    pub(super) fn hal_take_reference(&mut self) {
        let ([_, _, z], is_contact) = self.probe;
        let had = self.hal.reference.is_some();
        self.hal.reference = (is_contact && !had).then_some(z);
        self.hal.shown.with_reference = self.hal.reference.is_some() != had;
    }
}
