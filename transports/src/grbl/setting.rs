//! The list of settings.

/// One setting.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Setting {
    /// Number, as in `$110`.
    pub number: u8,
    /// Type of its value.
    pub kind: SettingKind,
    /// What it sets.
    pub name: &'static str,
    /// Its unit; empty for none.
    pub unit: &'static str,
    /// The default value, in thousandths.
    pub default_milli: u32,
}

/// Type of a setting. Decimals of a whole number are dropped.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum SettingKind {
    /// 0 or 1; another number counts as 1.
    Flag,
    /// Whole number up to 255.
    Byte,
    /// Bits, up to 255.
    Mask,
    /// Whole number up to 65 535.
    Word,
    /// Number with three places, up to 4 294 967.
    Decimal,
    /// The same, but printed as a whole number.
    Rounded,
}

/// All settings in the order of their numbers.
pub const SETTINGS: [Setting; 34] = [
    setting(0, SettingKind::Byte, "Step pulse", "us", 10000),
    setting(
        1,
        SettingKind::Byte,
        "Idle delay of the motors, 255 for always on",
        "ms",
        25000,
    ),
    setting(2, SettingKind::Mask, "Step signals inverted", "axes", 0),
    setting(
        3,
        SettingKind::Mask,
        "Direction signals inverted",
        "axes",
        0,
    ),
    setting(4, SettingKind::Flag, "Enable signal inverted", "", 0),
    setting(5, SettingKind::Flag, "Limit switches inverted", "", 0),
    setting(6, SettingKind::Flag, "Probe inverted", "", 0),
    setting(
        10,
        SettingKind::Mask,
        "Fields of the status report",
        "",
        1000,
    ),
    setting(11, SettingKind::Decimal, "Junction deviation", "mm", 10),
    setting(12, SettingKind::Decimal, "Arc tolerance", "mm", 2),
    setting(13, SettingKind::Flag, "Reports in inches", "", 0),
    setting(20, SettingKind::Flag, "Soft limits", "", 0),
    setting(21, SettingKind::Flag, "Hard limits", "", 0),
    setting(22, SettingKind::Flag, "Homing", "", 0),
    setting(
        23,
        SettingKind::Mask,
        "Homing direction inverted",
        "axes",
        0,
    ),
    setting(24, SettingKind::Decimal, "Homing feed", "mm/min", 25000),
    setting(
        25,
        SettingKind::Decimal,
        "Homing seek rate",
        "mm/min",
        500000,
    ),
    setting(26, SettingKind::Word, "Homing debounce", "ms", 250000),
    setting(27, SettingKind::Decimal, "Homing pull-off", "mm", 1000),
    setting(
        30,
        SettingKind::Rounded,
        "Highest spindle speed",
        "rpm",
        1000000,
    ),
    setting(31, SettingKind::Rounded, "Lowest spindle speed", "rpm", 0),
    setting(32, SettingKind::Flag, "Laser mode", "", 0),
    setting(
        100,
        SettingKind::Decimal,
        "X steps per length",
        "1/mm",
        250000,
    ),
    setting(
        101,
        SettingKind::Decimal,
        "Y steps per length",
        "1/mm",
        250000,
    ),
    setting(
        102,
        SettingKind::Decimal,
        "Z steps per length",
        "1/mm",
        250000,
    ),
    setting(
        110,
        SettingKind::Decimal,
        "X highest rate",
        "mm/min",
        500000,
    ),
    setting(
        111,
        SettingKind::Decimal,
        "Y highest rate",
        "mm/min",
        500000,
    ),
    setting(
        112,
        SettingKind::Decimal,
        "Z highest rate",
        "mm/min",
        500000,
    ),
    setting(120, SettingKind::Decimal, "X acceleration", "mm/s^2", 10000),
    setting(121, SettingKind::Decimal, "Y acceleration", "mm/s^2", 10000),
    setting(122, SettingKind::Decimal, "Z acceleration", "mm/s^2", 10000),
    setting(130, SettingKind::Decimal, "X travel", "mm", 200000),
    setting(131, SettingKind::Decimal, "Y travel", "mm", 200000),
    setting(132, SettingKind::Decimal, "Z travel", "mm", 200000),
];

const fn setting(
    number: u8,
    kind: SettingKind,
    name: &'static str,
    unit: &'static str,
    default_milli: u32,
) -> Setting {
    Setting {
        number,
        kind,
        name,
        unit,
        default_milli,
    }
}
