//! Status reports and lists.

use husillo_gcode::SpindleDirection;
use husillo_transports::grbl::{
    Accessories, Message, ModalState, Parameter, Pins, Place, Position, RECEIVE_BYTES, SETTINGS,
    State, Status,
};

use super::block::{distance_code, feed_mode_code, motion_code, plane_code, units_code};
use super::door::DoorStep;
use super::lines::Task;
use super::{Grbl, Phase};

/// Number of reports from one report with the work zero (or the overrides) to the next one. The
/// first value applies while the machine is busy, the second one otherwise.
const WORK_ZERO_EVERY: [u8; 2] = [30, 10];
const OVERRIDES_EVERY: [u8; 2] = [20, 10];

impl<const QUEUE: usize> Grbl<QUEUE> {
    /// Returns the work zero in nanometres, tool length included.
    pub(super) fn work_zero_now(&self) -> [i64; 3] {
        let mut zero = self.modal.work_offset().map(|nm| nm.0);
        for (zero, length) in zero.iter_mut().zip(self.modal.tool_length()) {
            *zero = zero.saturating_add(length.0);
        }
        zero
    }

    /// Puts the overrides into the next report.
    pub(super) const fn report_overrides(&mut self) {
        self.reports[1] = 0;
    }

    /// Puts the work zero into the next report.
    pub(super) const fn report_work_zero(&mut self) {
        self.reports[0] = 0;
    }

    pub(super) fn state(&self) -> State {
        match self.phase {
            Phase::Idle => State::Idle,
            Phase::Run => State::Run,
            Phase::Hold(brakes) => State::Hold(brakes),
            Phase::Jog => State::Jog,
            Phase::Alarm => State::Alarm,
            Phase::Door(DoorStep::Braking) => State::Door(2),
            Phase::Door(DoorStep::Stands) => State::Door(self.is_door_open().into()),
            Phase::Door(_) => State::Door(3),
            Phase::Check => State::Check,
            Phase::Home => State::Home,
            Phase::Sleep => State::Sleep,
            #[cfg(feature = "grblhal")]
            Phase::Tool => State::Tool,
        }
    }

    /// Sends a status report.
    pub(super) fn report_status(&mut self) {
        #[cfg(feature = "grblhal")]
        if self.is_hal() {
            return self.hal_report(false);
        }
        let mask = self.settings().whole(10);
        let position = self.position().map(|nm| nm.0);
        let mut work = position;
        for (work, zero) in work.iter_mut().zip(self.work_zero_now()) {
            *work = work.saturating_sub(zero);
        }
        let position = if mask & 1 == 1 {
            Position::Machine(Place::new(&position))
        } else {
            Position::Work(Place::new(&work))
        };
        let mut status = Status::new(self.state(), position);
        if mask & 2 == 2 {
            // A queue has at most 255 slots.
            let free = QUEUE.saturating_sub(self.machine.queued()) as u8;
            status.free = Some((free.into(), self.receiver.free().into()));
        }
        if self.options.reports_lines {
            let line = self.executing().map(|tag| tag.line);
            status.line = line.filter(|line| *line > 0);
        }
        if self.moves() {
            let speed = u64::from(self.machine.speed_nm_per_s());
            status.feed_nm_per_min = speed.wrapping_mul(60);
        }
        // The settings limit it to 32 bits.
        status.rpm = (self.driven.milli_rpm.saturating_add(500) / 1000) as u32;
        status.pins = self.pins();
        self.add_rare_fields(&mut status);
        self.send(&Message::Status(status));
    }

    fn add_rare_fields(&mut self, status: &mut Status) {
        let is_busy = matches!(
            self.phase,
            Phase::Run | Phase::Jog | Phase::Home | Phase::Hold(_) | Phase::Door(_)
        );
        let every = |[busy, idle]: [u8; 2]| if is_busy { busy } else { idle };
        let [work_zero, overrides] = &mut self.reports;
        if *work_zero == 0 {
            *work_zero = every(WORK_ZERO_EVERY);
            if *overrides == 0 {
                // The overrides follow in the next report.
                *overrides = 1;
            }
            status.work_zero = Some(Place::new(&self.work_zero_now()));
        }
        let [work_zero, overrides] = &mut self.reports;
        *work_zero = work_zero.saturating_sub(1);
        if *overrides > 0 {
            *overrides = overrides.saturating_sub(1);
            return;
        }
        *overrides = every(OVERRIDES_EVERY).saturating_sub(1);
        status.overrides = Some(self.overrides);
        status.accessories = self.accessories();
    }

    /// What turns and flows, as reports have it.
    pub(super) fn accessories(&self) -> Accessories {
        let (direction, flood, mist) = self.running();
        let turns = match direction {
            Some(SpindleDirection::Clockwise) => Accessories::CLOCKWISE,
            Some(SpindleDirection::CounterClockwise) => Accessories::COUNTER_CLOCKWISE,
            _ => 0,
        };
        let flows = |is_on: bool, bit: u8| if is_on { bit } else { 0 };
        let flood = flows(flood, Accessories::FLOOD);
        Accessories(turns | flood | flows(mist, Accessories::MIST))
    }

    pub(super) fn pins(&self) -> Pins {
        let mut pins = 0;
        #[cfg(feature = "grblhal")]
        if self.is_hal() {
            pins = self.hal_pins();
        }
        let mut set = |is_closed: bool, bit: u16| {
            if is_closed {
                pins |= bit;
            }
        };
        set(self.is_probe_closed(), Pins::PROBE);
        for axis in 0..3 {
            let bit = Pins::LIMIT_X.wrapping_shl(axis);
            set(self.is_limit_closed(axis as usize), bit);
        }
        set(self.is_door_open(), Pins::DOOR);
        set(!self.inputs.hold, Pins::HOLD);
        set(!self.inputs.reset, Pins::RESET);
        set(!self.inputs.start, Pins::START);
        Pins(pins)
    }

    /// Sends the modal state, `$G`.
    pub(super) fn report_modal(&mut self) {
        #[cfg(feature = "grblhal")]
        if self.is_hal() {
            return self.hal_modal();
        }
        let modal = &self.modal;
        let (direction, milli_rpm) = modal.spindle();
        let (mist, flood) = modal.coolant();
        let state = ModalState {
            motion: motion_code(modal),
            frame: 540_u16.saturating_add(u16::from(modal.work_system()).saturating_mul(10)),
            plane: plane_code(modal),
            units: units_code(modal),
            distance: distance_code(modal),
            feed_mode: feed_mode_code(modal),
            program: (self.task == Task::Pause).then_some(0),
            spindle: match direction {
                SpindleDirection::Clockwise => 30,
                SpindleDirection::CounterClockwise => 40,
                SpindleDirection::Off => 50,
            },
            mist,
            flood,
            tool: self.tool,
            // The F word of G93 is printed as it was written, so F30 is printed as 30.
            feed_nm_per_min: modal.feed_word(),
            milli_rpm,
        };
        self.send(&Message::Modal(state));
    }

    /// Sends all settings, `$$`.
    pub(super) fn list_settings(&mut self) {
        for index in 0..SETTINGS.len() {
            if let Some((setting, value)) = self.memory.settings.text(index) {
                self.send(&Message::Setting(setting.number, value.bytes()));
            }
        }
    }

    /// Returns the shift of G92 in nanometres.
    pub(super) fn shift(&self) -> [i64; 3] {
        let frame = self.modal.work_zero(self.modal.work_system());
        let mut shift = self.modal.work_offset().map(|nm| nm.0);
        for (shift, zero) in shift.iter_mut().zip(frame.unwrap_or_default()) {
            *shift = shift.saturating_sub(zero.0);
        }
        shift
    }

    /// Sends all coordinate data, `$#`.
    pub(super) fn list_places(&mut self) {
        let shift = self.shift();
        for parameter in Parameter::ALL {
            let nm = match parameter {
                Parameter::Frame(number) => self.modal.work_zero(number).unwrap_or_default(),
                Parameter::G28 => self.modal.home(),
                Parameter::G30 => self.modal.second_home(),
                Parameter::G92 => shift.map(husillo_gcode::Nm),
            };
            let place = Place::new(&nm.map(|nm| nm.0));
            self.send(&Message::Parameter(parameter, place));
        }
        let [_, _, length] = self.modal.tool_length();
        self.send(&Message::ToolLength(length.0));
        self.report_probe();
    }

    /// Sends the position of the last contact, `[PRB:`.
    pub(super) fn report_probe(&mut self) {
        let (place, contact) = self.probe;
        self.send(&Message::Probe(Place::new(&place), contact));
    }

    /// Sends the stored lines, `$N`.
    pub(super) fn list_lines(&mut self) {
        for number in 0..2_u8 {
            if let Some(line) = self.memory.lines.get(usize::from(number)).copied() {
                self.send(&Message::Stored(number, line.bytes()));
            }
        }
    }

    /// Sends version and options, `$I`.
    pub(super) fn report_version(&mut self) {
        let [_, _, user] = self.memory.lines;
        let version = self.options.version;
        self.send(&Message::Version(version, user.bytes()));
        let (letters, count) = self.options.letters();
        let letters = letters.get(..count).unwrap_or_default();
        // A queue has at most 255 slots.
        self.send(&Message::Options(letters, QUEUE as u8, RECEIVE_BYTES));
    }
}
