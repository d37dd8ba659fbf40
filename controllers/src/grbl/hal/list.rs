//! Lists, sent one line at a time as there is room.

use husillo_transports::grbl::{Alarm, ErrorCode, Text};

use super::super::Grbl;
use super::super::lines::{Outcome, Task};
use super::row::{GROUPS, LAST_GROUP, row, row_of};
use super::setting::{Kind, Row};

/// A list.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in super::super) enum Listing {
    /// `$$`: all settings.
    Values,
    /// `$EG`: groups of settings.
    Groups,
    /// `$EA` and `$EAG`: alarms, the second form as comma-separated values.
    Alarms(bool),
    /// `$EE` and `$EEG`: errors.
    Errors(bool),
    /// `$ES`, `$ESG` and `$ESH`: settings with what a sender needs to show them.
    Settings(Form),
    /// `$HELP`: topics.
    Topics,
    /// `$HELP Commands`.
    Commands,
    /// `$HELP Settings`, or of one group.
    Described(Option<u8>),
}

/// Form of the list of settings.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in super::super) enum Form {
    Fields,
    /// Comma-separated values.
    Commas,
    /// Values separated by tabulators.
    Tabs,
}

/// Commands with their meaning.
const COMMANDS: [(&str, &str); 27] = [
    ("$G", "send the modal state"),
    ("$J=<block>", "jog"),
    ("$#", "send coordinate data, tools and the last contact"),
    ("$$", "send all settings"),
    ("$<n>", "send setting n"),
    ("$<n>=<value>", "write setting n"),
    ("$N", "send the stored lines"),
    ("$N<n>=<line>", "store line n, 0 or 1"),
    ("$C", "switch check mode on or off"),
    ("$X", "unlock"),
    ("$H", "home all axes"),
    ("$H<axis>", "home one axis"),
    ("$SLP", "sleep until a reset"),
    ("$B", "switch block delete on or off"),
    ("$O", "switch the optional stop on or off"),
    ("$S", "switch single blocks on or off"),
    (
        "$TLR",
        "take the last contact as that of the reference tool, or forget it",
    ),
    ("$TPW", "measure the tool by the probe below it"),
    ("$I", "send version and options"),
    ("$I=<text>", "store a text that $I sends"),
    (
        "$RST=$ # *",
        "restore settings, coordinate data, or everything",
    ),
    ("$SPINDLES", "send the spindles"),
    ("$EA $EE", "send alarms and errors with their meaning"),
    (
        "$EG $ES $ESH",
        "send groups and settings with their types and ranges",
    ),
    ("$LIM", "send the closed limit switches"),
    ("$LEV", "send the inputs that have acted last"),
    ("$HELP <topic>", "send help"),
];

/// Returns the group at an index.
pub(super) fn group(index: usize) -> Option<(u8, u8, &'static str)> {
    match GROUPS.get(index) {
        Some(group) => Some(*group),
        None => (index == GROUPS.len()).then_some(LAST_GROUP),
    }
}

fn number(value: u64) -> Text {
    let mut text = Text::new();
    text.put_number(value);
    text
}

impl<const QUEUE: usize> Grbl<QUEUE> {
    /// Sends a line that consists of parts.
    pub(super) fn hal_line(&mut self, parts: &[&str]) {
        let bytes = parts.iter().flat_map(|part| part.bytes());
        for byte in bytes.chain(*b"\r\n") {
            self.output.push(byte);
        }
    }

    /// Begins a list.
    pub(super) fn hal_begin_list(&mut self, listing: Listing) -> Outcome {
        self.task = Task::List(listing, 0);
        Outcome::Waits
    }

    /// Sends the next line of a list. There is room for it.
    pub(in super::super) fn hal_list(&mut self, listing: Listing, index: u16) -> bool {
        let at = usize::from(index);
        let is_sent = match listing {
            Listing::Values => row(at).map(|row| self.hal_send_value(&row)),
            Listing::Groups => group(at).map(|(id, parent, name)| {
                let (id, parent) = (number(id.into()), number(parent.into()));
                self.hal_line(&[
                    "[SETTINGGROUP:",
                    ascii(&id),
                    "|",
                    ascii(&parent),
                    "|",
                    name,
                    "]",
                ]);
            }),
            Listing::Alarms(commas) => Alarm::ALL.get(at).map(|alarm| {
                let head = if commas {
                    HEAD_OF_ALARMS
                } else {
                    "[ALARMCODE:"
                };
                self.hal_code(head, commas, at, (alarm.number(), alarm.text()));
            }),
            Listing::Errors(commas) => ErrorCode::ALL.get(at).map(|error| {
                let head = if commas {
                    HEAD_OF_ERRORS
                } else {
                    "[ERRORCODE:"
                };
                self.hal_code(head, commas, at, (error.number(), error.text()));
            }),
            Listing::Settings(form) => row(at).map(|row| self.hal_setting(form, at, &row)),
            Listing::Topics => self.hal_topic(at),
            Listing::Commands => COMMANDS
                .get(at)
                .map(|(command, text)| self.hal_line(&[command, " - ", text, "."])),
            Listing::Described(group) => self.hal_described(group, at),
        };
        match is_sent {
            // The longest list has fewer than 100 lines.
            Some(()) => self.task = Task::List(listing, index.wrapping_add(1)),
            None => self.end_line(Ok(Outcome::Done)),
        }
        true
    }

    /// Sends `$110=500.000`.
    pub(super) fn hal_send_value(&mut self, row: &Row) {
        let (id, value) = (number(row.number.into()), self.hal_value(row));
        self.hal_line(&["$", ascii(&id), "=", ascii(&value)]);
    }

    fn hal_code(&mut self, head: &str, commas: bool, at: usize, (id, text): (u8, &str)) {
        let id = number(id.into());
        if !commas {
            self.hal_line(&[head, ascii(&id), "||", text, ".]"]);
            return;
        }
        if at == 0 {
            self.hal_line(&[head]);
        }
        self.hal_line(&["\"", ascii(&id), "\",\"N/A\",\"", text, ".\""]);
    }

    fn hal_setting(&mut self, form: Form, at: usize, row: &Row) {
        let id = number(row.number.into());
        let zero = if row.takes_zero() { "1" } else { "0" };
        match form {
            Form::Fields => {
                let (group, kind) = (number(row.group.into()), number(row.kind as u64));
                let (group, kind) = (ascii(&group), ascii(&kind));
                let head = [
                    "[SETTING:",
                    ascii(&id),
                    "|",
                    group,
                    "|",
                    row.name,
                    "|",
                    row.unit,
                ];
                let tail = [
                    "|", kind, "|", row.format, "|", row.least, "|", row.most, "|0|",
                ];
                for byte in head.iter().chain(&tail).flat_map(|part| part.bytes()) {
                    self.output.push(byte);
                }
                self.hal_line(&[zero, "]"]);
            }
            Form::Commas => {
                if at == 0 {
                    self.hal_line(&["\"$-Code\",\" Setting\",\" Units\",\" Setting Description\""]);
                }
                let (name, unit) = (row.name, row.unit);
                self.hal_line(&["\"", ascii(&id), "\",\"", name, "\",\"", unit, "\",\"\","]);
            }
            Form::Tabs => {
                if at == 0 {
                    self.hal_line(&[HEAD_OF_TABS]);
                }
                let (unit, kind, format) = match row.kind {
                    Kind::Flag => ("boolean", "bool", ""),
                    Kind::Bits => ("mask", "bitfield", row.format),
                    Kind::SwitchedBits => ("mask", "xbitfield", row.format),
                    Kind::Choice => ("integer", "radiobuttons", row.format),
                    Kind::Axes => ("mask", "bitfield", "axes"),
                    Kind::Whole => (row.unit, "integer", row.format),
                    Kind::Decimal => (row.unit, "float", row.format),
                };
                let head = [
                    ascii(&id),
                    "\t",
                    row.name,
                    "\t",
                    unit,
                    "\t",
                    kind,
                    "\t",
                    format,
                ];
                for byte in head.iter().flat_map(|part| part.bytes()) {
                    self.output.push(byte);
                }
                self.hal_line(&["\t\t", row.least, "\t", row.most, "\t0\t", zero]);
            }
        }
    }

    fn hal_topic(&mut self, at: usize) -> Option<()> {
        let name = match at {
            0 => {
                self.hal_line(&["Help topics:"]);
                return Some(());
            }
            1 => "Commands",
            2 => "Settings",
            // Without the root.
            at => group(at.checked_sub(2)?)?.2,
        };
        self.hal_line(&[" ", name]);
        Some(())
    }

    fn hal_described(&mut self, wanted: Option<u8>, at: usize) -> Option<()> {
        let row = row(at)?;
        if at == 0 {
            let name = (0..=GROUPS.len())
                .filter_map(group)
                .find(|(id, _, _)| Some(*id) == wanted);
            if let Some((_, _, name)) = name {
                self.hal_line(&[]);
                self.hal_line(&["---- ", name, ":"]);
            }
        }
        if wanted.is_none_or(|group| group == row.group) {
            let id = number(row.number.into());
            let unit = if row.unit.is_empty() { "" } else { " in " };
            self.hal_line(&[]);
            self.hal_line(&["$", ascii(&id), ": ", row.name, unit, row.unit]);
        }
        Some(())
    }

    /// Begins `$HELP topic`.
    pub(super) fn hal_help(&mut self, topic: &[u8]) -> Outcome {
        let topic = topic.trim_ascii();
        let is = |name: &str| topic.eq_ignore_ascii_case(name.as_bytes());
        if topic.is_empty() {
            return self.hal_begin_list(Listing::Topics);
        }
        if is("Commands") {
            return self.hal_begin_list(Listing::Commands);
        }
        if is("Settings") {
            return self.hal_begin_list(Listing::Described(None));
        }
        let found = (1..=GROUPS.len())
            .filter_map(group)
            .find(|(_, _, name)| is(name));
        match found {
            Some((id, _, _)) => self.hal_begin_list(Listing::Described(Some(id))),
            None => {
                self.hal_line(&[]);
                self.hal_line(&["N/A"]);
                Outcome::Done
            }
        }
    }

    /// Sends one setting, `$110` or `$ES=110`.
    ///
    /// # Errors
    /// There is no such setting.
    pub(super) fn hal_one(&mut self, id: u16, form: Option<Form>) -> Result<Outcome, ErrorCode> {
        let row = row_of(id).ok_or(ErrorCode::SettingUnknown)?;
        match form {
            None => self.hal_send_value(&row),
            // Not the first line, so it has no heading.
            Some(form) => self.hal_setting(form, 1, &row),
        }
        Ok(Outcome::Done)
    }
}

const HEAD_OF_ALARMS: &str =
    "\"Alarm Code in v1.1+\",\" Alarm Message in v1.0-\",\" Alarm Description\"";
const HEAD_OF_ERRORS: &str =
    "\"Error Code in v1.1+\",\"Error Message in v1.0-\",\"Error Description\"";
const HEAD_OF_TABS: &str =
    "$-Code\tSetting\tUnits\tDatatype\tData format\tSetting Description\tMin\tMax";

/// Returns a text of digits as a string.
pub(super) fn ascii(text: &Text) -> &str {
    core::str::from_utf8(text.bytes()).unwrap_or_default()
}
