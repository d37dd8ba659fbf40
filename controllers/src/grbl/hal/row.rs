//! The list of settings, with what a sender needs to show them.

use husillo_transports::grbl::{SETTINGS, Setting, SettingKind};

use super::setting::{EXTRAS, Kind, Place, Row};

/// Groups with their parents.
pub(super) const GROUPS: [(u8, u8, &str); 13] = [
    (0, 0, "Root"),
    (1, 0, "General"),
    (3, 0, "Limits"),
    (6, 0, "Spindle"),
    (9, 0, "Tool change"),
    (11, 0, "Homing"),
    (12, 0, "Probing"),
    (13, 0, "Parking/Safety door"),
    (14, 0, "Jogging"),
    (35, 0, "Stepper"),
    (42, 0, "Axis"),
    (43, 42, "X-axis"),
    (44, 42, "Y-axis"),
];
/// The group of the last axis, which follows the others.
pub(super) const LAST_GROUP: (u8, u8, &str) = (45, 42, "Z-axis");

const REPORT_BITS: &str =
    "Machine position,Buffer,Line number,Feed and speed,Inputs,Work zero,Overrides";
const HOMING_BITS: &str = "Homing,Single axes,Required at the start";
const CHANGE_CHOICES: &str =
    "By hand,By hand and $TPW,By hand and $TPW at G59.3,Length measured at G59.3,Ignored";
const CHANGE_BITS: &str = "Return to the position before M6,Change at G30";

/// Returns a setting by its index, in the order of their numbers.
pub(super) fn row(index: usize) -> Option<Row> {
    // `$0`, `$10` and `$22` are in both lists. There are fewer than 60 settings.
    let mut numbers = 0_usize;
    let mut least = 0_u16;
    loop {
        let next_grbl = SETTINGS
            .iter()
            .map(|setting| u16::from(setting.number))
            .find(|number| *number >= least);
        let next_extra = EXTRAS
            .iter()
            .map(|(number, _)| *number)
            .filter(|number| *number >= least)
            .min();
        let number = next_grbl.into_iter().chain(next_extra).min()?;
        if numbers == index {
            return row_of(number);
        }
        numbers = numbers.wrapping_add(1); // at most the number of settings
        least = number.saturating_add(1);
    }
}

/// Returns the setting with a number.
pub(super) fn row_of(number: u16) -> Option<Row> {
    let extra = EXTRAS.iter().position(|(known, _)| *known == number);
    let grbl = SETTINGS
        .iter()
        .find(|setting| u16::from(setting.number) == number);
    match (extra, grbl) {
        (Some(index), _) => Some(extra_row(number, index)),
        (None, Some(setting)) => Some(grbl_row(setting)),
        (None, None) => None,
    }
}

fn grbl_row(setting: &'static Setting) -> Row {
    let number = setting.number;
    let (kind, format) = match setting.kind {
        SettingKind::Flag if number == 32 => (Kind::Choice, "Normal,Laser"),
        SettingKind::Flag => (Kind::Flag, ""),
        SettingKind::Byte | SettingKind::Word => (Kind::Whole, "####0"),
        SettingKind::Mask => (Kind::Axes, ""),
        SettingKind::Decimal if matches!(number, 24 | 25) => (Kind::Decimal, "#####0.0"),
        SettingKind::Decimal if matches!(number, 100..=102) => (Kind::Decimal, "#####0.000##"),
        SettingKind::Decimal | SettingKind::Rounded => (Kind::Decimal, "#####0.000"),
    };
    let group = match number {
        1..=4 => 35,
        5 | 20 | 21 => 3,
        6 => 12,
        23..=27 => 11,
        30 | 31 => 6,
        100 | 110 | 120 | 130 => 43,
        101 | 111 | 121 | 131 => 44,
        102 | 112 | 122 | 132 => 45,
        _ => 1,
    };
    let most = match setting.kind {
        SettingKind::Byte => "255",
        SettingKind::Word => "65535",
        _ => "",
    };
    Row {
        number: number.into(),
        group,
        kind,
        name: setting.name,
        unit: setting.unit,
        format,
        least: "",
        most,
        place: Place::Grbl(number),
    }
}

fn extra_row(number: u16, index: usize) -> Row {
    let flag = (Kind::Flag, "", "", ["", ""]);
    let mm = |format| (Kind::Decimal, "mm", format, ["", ""]);
    let rate = (Kind::Decimal, "mm/min", "#####0.0", ["", ""]);
    // A group of an axis: 43 to 45.
    let axis = |first: u16| number.saturating_sub(first) as u8 + 43;
    let delay = (Kind::Decimal, "s", "#0.0", ["0.5", "20"]);
    let (group, name, (kind, unit, format, [least, most])) = match number {
        0 => (
            35,
            "Step pulse",
            (Kind::Decimal, "us", "##0.0", ["2.0", "255"]),
        ),
        10 => (
            1,
            "Fields of the status report",
            (Kind::Bits, "", REPORT_BITS, ["", ""]),
        ),
        22 => (
            11,
            "Homing",
            (Kind::SwitchedBits, "", HOMING_BITS, ["", ""]),
        ),
        40 => (14, "Jogs end at the limits of the travel", flag),
        60 => (1, "The end of a program resets the overrides", flag),
        62 => (1, "Sleep is permitted", flag),
        64 => (1, "Locked at the start", flag),
        341 => (
            9,
            "Change of a tool",
            (Kind::Choice, "", CHANGE_CHOICES, ["", ""]),
        ),
        342 => (9, "Longest probe move", mm("#####0.0")),
        343 => (9, "Feed of the second contact", rate),
        344 => (9, "Feed of the first contact", rate),
        345 => (9, "Feed away from the contact", rate),
        346 => (
            9,
            "Moves after the change",
            (Kind::Bits, "", CHANGE_BITS, ["", ""]),
        ),
        140..=142 => (
            axis(140),
            "Current of the motor",
            (Kind::Whole, "mA", "###0", ["50", "1750"]),
        ),
        150..=152 => (
            axis(150),
            "Microsteps of the driver",
            (Kind::Whole, "", "##0", ["1", "256"]),
        ),
        200..=202 => (
            axis(200),
            "Threshold of StallGuard",
            (Kind::Whole, "", "##0", ["0", "255"]),
        ),
        339 => (
            35,
            "Axes homed without a switch",
            (Kind::Axes, "", "", ["", "7"]),
        ),
        450 => (35, "Axes with StealthChop", (Kind::Axes, "", "", ["", "7"])),
        384 => (1, "The shift of G92 ends with the power", flag),
        392 => (13, "Delay of the spindle after the door", delay),
        393 => (13, "Delay of the coolant after the door", delay),
        481 => (
            1,
            "Time between reports",
            (Kind::Whole, "ms", "###0", ["100", "1000"]),
        ),
        _ => (9, "The tool is known at the next start", flag),
    };
    Row {
        number,
        group,
        kind,
        name,
        unit,
        format,
        least,
        most,
        place: Place::Extra(index),
    }
}
