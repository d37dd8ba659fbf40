//! Status reports by fields, the modal state, and the data of `$#` and `$I`.

use husillo_gcode::SpindleDirection;
use husillo_transports::grbl::{Accessories, Message, Parameter, Pins, Place, Text, Units};

use super::super::Grbl;
use super::super::block::{
    distance_code, feed_mode_code, motion_code, plane_code, put_code, units_code,
};
use super::setting::{COOLANT_DELAY, REPORT_FIELDS, SPINDLE_DELAY};

/// Reports from one report with the work zero, or the overrides, to the next one at rest and in
/// motion.
const EVERY: [u8; 2] = [10, 20];

// Bits of `$10`.
const MACHINE: u32 = 1;
const BUFFER: u32 = 1 << 1;
const LINE_NUMBER: u32 = 1 << 2;
const FEED: u32 = 1 << 3;
const INPUTS: u32 = 1 << 4;
const WORK_ZERO: u32 = 1 << 5;
const OVERRIDES: u32 = 1 << 6;

/// Names of the work frames.
pub(super) const FRAMES: [&str; 9] = [
    "G54", "G55", "G56", "G57", "G58", "G59", "G59.1", "G59.2", "G59.3",
];

fn put(text: &mut Text, parts: &[&str]) {
    parts.iter().for_each(|part| text.put(part.as_bytes()));
}

fn put_place(text: &mut Text, name: &str, nm: &[i64], units: Units) {
    text.put(name.as_bytes());
    Place::new(nm).put(text, units);
}

impl<const QUEUE: usize> Grbl<QUEUE> {
    /// Sends a status report. A full one has all fields.
    pub(in super::super) fn hal_report(&mut self, is_full: bool) {
        let mask = self.memory.hal.milli(REPORT_FIELDS) / 1000;
        let has = |bit: u32| mask & bit != 0;
        let units = self.units();
        let zero = self.work_zero_now();
        let mut place = self.position().map(|nm| nm.0);
        let mut text = Text::new();
        put(&mut text, &["<", self.state().name()]);
        if has(MACHINE) {
            put_place(&mut text, "|MPos:", &place, units);
        } else {
            for (place, zero) in place.iter_mut().zip(zero) {
                *place = place.saturating_sub(zero);
            }
            put_place(&mut text, "|WPos:", &place, units);
        }
        if has(BUFFER) {
            text.put(b"|Bf:");
            text.put_number(QUEUE.saturating_sub(self.machine.queued()) as u64);
            text.put(b",");
            text.put_number(self.receiver.room() as u64);
        }
        self.put_motion(&mut text, [has(LINE_NUMBER), has(FEED)]);
        if has(INPUTS) {
            self.pins().put(&mut text);
        }
        self.put_rare(&mut text, is_full, [has(WORK_ZERO), has(OVERRIDES)]);
        text.put(b">");
        for byte in text.bytes().iter().chain(b"\r\n") {
            self.output.push(*byte);
        }
    }

    fn put_motion(&self, text: &mut Text, [has_line, has_feed]: [bool; 2]) {
        let line = self.executing().map(|tag| tag.line);
        if let (true, Some(line)) = (has_line, line.filter(|line| *line > 0)) {
            text.put(b"|Ln:");
            text.put_number(line.into());
        }
        if has_feed {
            let speed = u64::from(self.machine.speed_nm_per_s());
            let speed = if self.moves() {
                speed.wrapping_mul(60)
            } else {
                0
            };
            let unit = match self.units() {
                Units::Millimetres => 1_000_000,
                Units::Inches => 25_400_000,
            };
            text.put(b"|FS:");
            text.put_number(speed / unit);
            text.put(b",");
            text.put_number(self.driven.milli_rpm.saturating_add(500) / 1000);
        }
    }

    /// Appends the fields that are not in every report.
    fn put_rare(&mut self, text: &mut Text, is_full: bool, [has_zero, has_overrides]: [bool; 2]) {
        let units = self.units();
        let every = if self.moves() { EVERY[1] } else { EVERY[0] };
        let (now, frame) = (self.accessories(), self.modal.work_system());
        let must_show_zero = core::mem::replace(&mut self.reports[0], 1) == 0;
        let overrides = self.overrides;
        let shown = &mut self.hal.shown;
        let [zero_left, overrides_left] = &mut shown.left;
        let is_due = *overrides_left == 0 || shown.overrides != overrides;
        let with_overrides = is_full || has_overrides && is_due;
        let is_due = *zero_left == 0 && !with_overrides;
        let with_zero = is_full || has_zero && (is_due || must_show_zero);
        let wait = |left: &mut u8, is_shown: bool| {
            let next = if is_shown { every } else { *left };
            *left = next.saturating_sub(1);
        };
        if has_zero {
            wait(zero_left, with_zero);
        }
        if has_overrides {
            wait(overrides_left, with_overrides);
        }
        let with_accessories = is_full
            || core::mem::take(&mut shown.with_accessories)
            || shown.accessories != now
            || with_overrides && now != Accessories(0);
        let with_frame = is_full || shown.frame != frame;
        let with_home = core::mem::take(&mut shown.with_home) || is_full;
        let with_tool = core::mem::take(&mut shown.with_tool) || is_full;
        let with_reference = core::mem::take(&mut shown.with_reference) || is_full;
        (shown.overrides, shown.accessories, shown.frame) = (overrides, now, frame);
        if with_zero {
            put_place(text, "|WCO:", &self.work_zero_now(), units);
        }
        if with_frame {
            let name = FRAMES.get(usize::from(frame)).copied().unwrap_or_default();
            put(text, &["|WCS:", name]);
        }
        if with_overrides {
            for (name, percent) in ["|Ov:", ",", ","].into_iter().zip(overrides) {
                text.put(name.as_bytes());
                text.put_number(percent.into());
            }
        }
        if with_accessories {
            text.put(b"|A:");
            now.put_letters(text);
        }
        if is_full {
            text.put(b"|Sc:|MPG:0");
        }
        if with_home {
            put(text, &["|H:", bit(self.hal.is_homed)]);
        }
        if with_tool {
            text.put(b"|T:");
            text.put_number(self.hal.change.tool.into());
        }
        if is_full {
            put(text, &["|P:", bit(self.is_probe_closed())]);
        }
        if with_reference {
            put(text, &["|TLR:", bit(self.hal.reference.is_some())]);
        }
        if is_full {
            text.put(b"|FW:grblHAL");
        }
    }

    /// Shows the accessories in the next report.
    pub(in super::super) fn hal_show_accessories(&mut self) {
        self.hal.shown.with_accessories = true;
    }

    /// Returns the times that spindle and coolant need after the door, in microseconds.
    pub(in super::super) fn hal_delays_us(&self) -> [u32; 2] {
        let memory = &self.memory.hal;
        // At most 20 s.
        [SPINDLE_DELAY, COOLANT_DELAY].map(|index| memory.milli(index).wrapping_mul(1000))
    }

    /// Returns the switches of the program that a report shows with the inputs.
    pub(in super::super) fn hal_pins(&self) -> u16 {
        let hal = &self.hal;
        let switches = [
            (hal.deletes_blocks, Pins::BLOCK_DELETE),
            (hal.ignores_optional_stop, Pins::NO_OPTIONAL_STOP),
            (hal.is_single_block, Pins::SINGLE_BLOCK),
        ];
        let on = switches.into_iter().filter(|(is_on, _)| *is_on);
        on.fold(0, |pins, (_, bit)| pins | bit)
    }

    /// Sends the modal state, `$G`.
    pub(in super::super) fn hal_modal(&mut self) {
        let modal = &self.modal;
        let mut text = Text::new();
        text.put(b"[GC:");
        put_code(&mut text, b'G', motion_code(modal));
        let frame = FRAMES.get(usize::from(modal.work_system())).copied();
        put(&mut text, &[" ", frame.unwrap_or_default()]);
        if self.shift().iter().any(|nm| *nm != 0) {
            text.put(b" G92");
        }
        let codes = [
            plane_code(modal),
            units_code(modal),
            distance_code(modal),
            feed_mode_code(modal),
        ];
        for code in codes {
            text.put(b" ");
            put_code(&mut text, b'G', code);
        }
        text.put(b" G40");
        put(&mut text, &[" ", self.hal_length_code()]);
        let is_r = self.hal.returns_to_r;
        text.put(if is_r { b" G99 G50" } else { b" G98 G50" });
        let (direction, milli_rpm) = modal.spindle();
        text.put(match direction {
            SpindleDirection::Clockwise => b" M3",
            SpindleDirection::CounterClockwise => b" M4",
            SpindleDirection::Off => b" M5",
        });
        let (mist, flood) = modal.coolant();
        for (is_on, code) in [(mist, " M7"), (flood, " M8"), (!mist && !flood, " M9")] {
            text.put(if is_on { code.as_bytes() } else { b"" });
        }
        for (is_fixed, code) in self.hal.is_fixed.into_iter().zip([" M50", " M51"]) {
            text.put(if is_fixed { code.as_bytes() } else { b"" });
        }
        text.put(b" T");
        text.put_number(self.hal.change.tool.into());
        text.put(b" F");
        text.put_number(modal.feed_word() / 1_000_000);
        text.put(b" S");
        text.put_number(milli_rpm.saturating_add(500) / 1000);
        text.put(b".]\r\n");
        text.bytes().iter().for_each(|byte| self.output.push(*byte));
        self.hal.shown.with_home = true;
    }

    fn hal_length_code(&self) -> &'static str {
        match (self.hal.change.has_length(), self.hal.change.is_of_table()) {
            (false, _) => "G49",
            (true, false) => "G43.1",
            (true, true) => "G43",
        }
    }

    /// Sends all coordinate data, `$#`.
    pub(super) fn hal_places(&mut self) {
        let units = self.units();
        for (system, name) in (0_u8..).zip(FRAMES) {
            let zero = self.modal.work_zero(system).unwrap_or_default();
            self.hal_place(name, &zero.map(|nm| nm.0));
        }
        let homes = [self.modal.home(), self.modal.second_home()];
        for (name, place) in ["G28", "G30"].into_iter().zip(homes) {
            self.hal_place(name, &place.map(|nm| nm.0));
        }
        let shift = self.shift();
        self.hal_place(Parameter::G92.name(), &shift);
        let has_homing = self.settings().is_set(22);
        if has_homing {
            let mut text = Text::new();
            put_place(&mut text, "[HOME:", &[0; 3], units);
            let axes = if self.hal.is_homed {
                ":7]\r\n"
            } else {
                ":0]\r\n"
            };
            text.put(axes.as_bytes());
            text.bytes().iter().for_each(|byte| self.output.push(*byte));
        }
        for tool in self.memory.hal.tools {
            if tool.number != 0 {
                let [x, y, z, radius] = tool.nm;
                let mut text = Text::new();
                text.put(b"[T:");
                text.put_number(tool.number.into());
                put_place(&mut text, "|", &[x, y, z], units);
                put_place(&mut text, "|", &[radius], units);
                text.put(b"]\r\n");
                text.bytes().iter().for_each(|byte| self.output.push(*byte));
            }
        }
        let length = self.hal.change.shown_length();
        self.hal_place("TLO", &length);
        self.report_probe();
    }

    fn hal_place(&mut self, name: &str, nm: &[i64]) {
        let mut text = Text::new();
        put(&mut text, &["[", name, ":"]);
        Place::new(nm).put(&mut text, self.units());
        text.put(b"]\r\n");
        text.bytes().iter().for_each(|byte| self.output.push(*byte));
    }

    /// Sends version and options, `$I` and `$I+`.
    pub(super) fn hal_version(&mut self) {
        let [_, _, user] = self.memory.lines;
        let version = self.options.version;
        self.send(&Message::Version(version, user.bytes()));
        let (letters, count) = self.options.letters();
        let letters = letters.get(..count).unwrap_or_default();
        let mut text = Text::new();
        text.put(b"[OPT:");
        text.put(letters);
        for number in [QUEUE, 255, 3, super::memory::TOOLS] {
            text.put(b",");
            text.put_number(number as u64);
        }
        text.put(b"]\r\n");
        text.bytes().iter().for_each(|byte| self.output.push(*byte));
        for line in [
            "[AXS:3:XYZ]",
            "[NEWOPT:ENUMS,RT+,TC]",
            "[FIRMWARE:grblHAL]",
            if self.options.has_door {
                "[SIGNALS:HSRDLTQ]"
            } else {
                "[SIGNALS:HSRLTQ]"
            },
            "[NVS STORAGE:*FLASH]",
            "[DRIVER:husillo]",
        ] {
            self.hal_line(&[line]);
        }
        self.hal_line(&["[DRIVER VERSION:", env!("CARGO_PKG_VERSION"), "]"]);
    }
}

const fn bit(is_set: bool) -> &'static str {
    if is_set { "1" } else { "0" }
}
