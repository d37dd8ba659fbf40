//! Errors by number.

/// Why a line was refused. The number is that of the reply `error:N`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[repr(u8)]
pub enum ErrorCode {
    /// A word does not start with a letter.
    ExpectedLetter = 1,
    /// A number is missing or wrong.
    BadNumber = 2,
    /// Unknown `$` command.
    InvalidStatement = 3,
    /// A value is negative.
    Negative = 4,
    /// Homing is not enabled.
    HomingDisabled = 5,
    /// The step pulse is below 3 us.
    StepPulse = 6,
    /// The stored data cannot be read.
    StoreRead = 7,
    /// The command is permitted only in Idle or Alarm.
    NotIdle = 8,
    /// Lines are refused in Alarm and while jogging.
    Locked = 9,
    /// Soft limits need homing.
    SoftLimitsNeedHoming = 10,
    /// The line is too long.
    LineTooLong = 11,
    /// The step rate is too high.
    StepRate = 12,
    /// The safety door is open.
    DoorOpen = 13,
    /// The stored line is too long.
    StartupTooLong = 14,
    /// The jog leaves the travel.
    Travel = 15,
    /// A jog has a word or a code that is not permitted in a jog.
    Jog = 16,
    /// Laser mode needs a variable spindle.
    LaserNeedsPwm = 17,
    /// Unsupported code or word.
    Unsupported = 20,
    /// Two codes of one modal group.
    ModalGroup = 21,
    /// No feed rate.
    NoFeed = 22,
    /// The code takes no decimals.
    NotWhole = 23,
    /// Two codes use the axis words.
    AxisConflict = 24,
    /// A word is repeated.
    Repeated = 25,
    /// Axis words are missing.
    NoAxisWords = 26,
    /// The line number is out of range.
    LineNumber = 27,
    /// A word of the code is missing.
    MissingValue = 28,
    /// No such work coordinate system.
    WorkFrame = 29,
    /// G53 needs G0 or G1.
    MachineFrame = 30,
    /// Axis words that no code uses.
    AxisWords = 31,
    /// The arc has no axis word of its plane.
    NoPlaneWords = 32,
    /// The target cannot be reached.
    BadTarget = 33,
    /// The radius is wrong.
    BadRadius = 34,
    /// The arc has no centre in its plane.
    NoCentre = 35,
    /// Words that no code uses.
    Unused = 36,
    /// The tool length needs a Z word.
    ToolLengthAxis = 37,
    /// The tool number is too large.
    ToolNumber = 38,
    /// A value is out of its range.
    OutOfRange = 39,
    /// Motion is refused while a tool is changed.
    ToolChange = 40,
    /// The axes must be homed first.
    HomingRequired = 46,
    /// The value of a setting is out of its range.
    SettingRange = 52,
    /// There is no such setting.
    SettingUnknown = 53,
}

impl ErrorCode {
    /// All errors by number. Those above 38 are sent by grblHAL only.
    pub const ALL: [ErrorCode; 41] = [
        ErrorCode::ExpectedLetter,
        ErrorCode::BadNumber,
        ErrorCode::InvalidStatement,
        ErrorCode::Negative,
        ErrorCode::HomingDisabled,
        ErrorCode::StepPulse,
        ErrorCode::StoreRead,
        ErrorCode::NotIdle,
        ErrorCode::Locked,
        ErrorCode::SoftLimitsNeedHoming,
        ErrorCode::LineTooLong,
        ErrorCode::StepRate,
        ErrorCode::DoorOpen,
        ErrorCode::StartupTooLong,
        ErrorCode::Travel,
        ErrorCode::Jog,
        ErrorCode::LaserNeedsPwm,
        ErrorCode::Unsupported,
        ErrorCode::ModalGroup,
        ErrorCode::NoFeed,
        ErrorCode::NotWhole,
        ErrorCode::AxisConflict,
        ErrorCode::Repeated,
        ErrorCode::NoAxisWords,
        ErrorCode::LineNumber,
        ErrorCode::MissingValue,
        ErrorCode::WorkFrame,
        ErrorCode::MachineFrame,
        ErrorCode::AxisWords,
        ErrorCode::NoPlaneWords,
        ErrorCode::BadTarget,
        ErrorCode::BadRadius,
        ErrorCode::NoCentre,
        ErrorCode::Unused,
        ErrorCode::ToolLengthAxis,
        ErrorCode::ToolNumber,
        ErrorCode::OutOfRange,
        ErrorCode::ToolChange,
        ErrorCode::HomingRequired,
        ErrorCode::SettingRange,
        ErrorCode::SettingUnknown,
    ];

    /// Returns its number.
    pub const fn number(self) -> u8 {
        self as u8
    }

    /// Returns the error with this number.
    pub fn of(number: u8) -> Option<ErrorCode> {
        ErrorCode::ALL
            .into_iter()
            .find(|error| error.number() == number)
    }

    /// Returns a description.
    pub const fn text(self) -> &'static str {
        match self {
            ErrorCode::ExpectedLetter => "a word does not start with a letter",
            ErrorCode::BadNumber => "a number is missing or wrong",
            ErrorCode::InvalidStatement => "unknown `$` command",
            ErrorCode::Negative => "a value is negative",
            ErrorCode::HomingDisabled => "homing is not enabled",
            ErrorCode::StepPulse => "the step pulse is below 3 us",
            ErrorCode::StoreRead => "the stored data cannot be read",
            ErrorCode::NotIdle => "only in Idle or Alarm",
            ErrorCode::Locked => "locked in Alarm and while jogging",
            ErrorCode::SoftLimitsNeedHoming => "soft limits need homing",
            ErrorCode::LineTooLong => "the line is too long",
            ErrorCode::StepRate => "the step rate is too high",
            ErrorCode::DoorOpen => "the safety door is open",
            ErrorCode::StartupTooLong => "the stored line is too long",
            ErrorCode::Travel => "the jog leaves the travel",
            ErrorCode::Jog => "not in a jog",
            ErrorCode::LaserNeedsPwm => "laser mode needs a variable spindle",
            ErrorCode::Unsupported => "unsupported code or word",
            ErrorCode::ModalGroup => "two codes of one modal group",
            ErrorCode::NoFeed => "no feed rate",
            ErrorCode::NotWhole => "the code takes no decimals",
            ErrorCode::AxisConflict => "two codes use the axis words",
            ErrorCode::Repeated => "a word is repeated",
            ErrorCode::NoAxisWords => "axis words are missing",
            ErrorCode::LineNumber => "the line number is out of range",
            ErrorCode::MissingValue => "a word of the code is missing",
            ErrorCode::WorkFrame => "no such work coordinate system",
            ErrorCode::MachineFrame => "G53 needs G0 or G1",
            ErrorCode::AxisWords => "axis words without use",
            ErrorCode::NoPlaneWords => "the arc has no axis word of its plane",
            ErrorCode::BadTarget => "the target cannot be reached",
            ErrorCode::BadRadius => "the radius is wrong",
            ErrorCode::NoCentre => "the arc has no centre in its plane",
            ErrorCode::Unused => "words without use",
            ErrorCode::ToolLengthAxis => "the tool length needs a Z word",
            ErrorCode::ToolNumber => "the tool number is too large",
            ErrorCode::OutOfRange => "a value is out of its range",
            ErrorCode::ToolChange => "not while a tool is changed",
            ErrorCode::HomingRequired => "the axes must be homed first",
            ErrorCode::SettingRange => "the value of the setting is out of its range",
            ErrorCode::SettingUnknown => "no such setting",
        }
    }
}
