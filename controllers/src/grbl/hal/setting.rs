//! Settings by number: those of Grbl, and further ones.

use husillo_transports::grbl::{ErrorCode, Settings, Text, decimal};

use super::super::Grbl;
use super::row::row_of;

/// Number of settings beyond those of Grbl, or with another range.
pub(super) const EXTRA_COUNT: usize = CONTROLLER.len() + DRIVERS.len();

/// Their numbers and defaults in thousandths. A setting keeps its index.
pub(super) const EXTRAS: [(u16, u32); EXTRA_COUNT] = {
    let mut all = [(0, 0); EXTRA_COUNT];
    let mut index = 0;
    while index < EXTRA_COUNT {
        all[index] = match index.checked_sub(CONTROLLER.len()) {
            Some(index) => DRIVERS[index],
            None => CONTROLLER[index],
        };
        index += 1;
    }
    all
};

const CONTROLLER: [(u16, u32); 18] = [
    (0, 5000),
    (10, 511_000),
    (22, 0),
    (40, 0),
    (60, 0),
    (62, 0),
    (64, 0),
    (341, 0),
    (342, 30_000),
    (343, 25_000),
    (344, 200_000),
    (345, 200_000),
    (346, 1000),
    (384, 0),
    (392, 4000),
    (393, 1000),
    (481, 0),
    (485, 0),
];

/// Those of drivers with a serial line, with the numbers of grblHAL where it has them.
#[cfg(feature = "drivers")]
const DRIVERS: [(u16, u32); 11] = [
    (140, 500_000),
    (141, 500_000),
    (142, 500_000),
    (150, 16_000),
    (151, 16_000),
    (152, 16_000),
    (200, 0),
    (201, 0),
    (202, 0),
    (339, 0),
    (450, 7000),
];
#[cfg(not(feature = "drivers"))]
const DRIVERS: [(u16, u32); 0] = [];

// Indices in the list.
const PULSE: usize = 0;
pub(super) const REPORT_FIELDS: usize = 1;
const HOMING: usize = 2;
pub(super) const LIMITS_JOGS: usize = 3;
pub(super) const RESTORES_OVERRIDES: usize = 4;
pub(super) const SLEEPS: usize = 5;
pub(super) const BEGINS_IN_ALARM: usize = 6;
pub(super) const CHANGE_MODE: usize = 7;
pub(super) const PROBE_DISTANCE: usize = 8;
pub(super) const LOCATE_RATE: usize = 9;
pub(super) const SEEK_RATE: usize = 10;
pub(super) const PULL_OFF_RATE: usize = 11;
pub(super) const CHANGE_OPTIONS: usize = 12;
pub(super) const FORGETS_SHIFT: usize = 13;
pub(super) const SPINDLE_DELAY: usize = 14;
pub(super) const COOLANT_DELAY: usize = 15;
pub(super) const REPORT_EVERY: usize = 16;
pub(super) const KEEPS_TOOL: usize = 17;

/// Type of a value, by its number in the list of settings.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    Flag = 0,
    Bits = 1,
    /// Bit 0 enables the others.
    SwitchedBits = 2,
    Choice = 3,
    Axes = 4,
    Whole = 5,
    Decimal = 6,
}

/// What a sender needs to show a setting.
#[derive(Clone, Copy, Debug)]
pub(super) struct Row {
    pub(super) number: u16,
    pub(super) group: u8,
    pub(super) kind: Kind,
    pub(super) name: &'static str,
    pub(super) unit: &'static str,
    /// Form of a number, or the names of bits or choices.
    pub(super) format: &'static str,
    pub(super) least: &'static str,
    pub(super) most: &'static str,
    pub(super) place: Place,
}

/// Where the value is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Place {
    /// In the settings of Grbl.
    Grbl(u8),
    /// At an index of the extra settings.
    Extra(usize),
}

impl Row {
    /// Whether 0 is permitted although it is below the range.
    pub(super) const fn takes_zero(&self) -> bool {
        self.number == 481
    }

    /// Returns the number of decimals that are printed.
    fn places(&self) -> u8 {
        let decimals = self.format.bytes().skip_while(|byte| *byte != b'.');
        let decimals = decimals.skip(1).count();
        // At most 5.
        if self.kind == Kind::Decimal {
            decimals as u8
        } else {
            0
        }
    }

    /// Returns a value in thousandths as it is printed.
    fn text(&self, milli: u32) -> Text {
        let mut text = Text::new();
        let milli = i64::from(milli);
        match self.places() {
            0 => text.put_decimal(milli / 1000, 0),
            1 => text.put_decimal(milli.saturating_add(50) / 100, 1),
            3 => text.put_decimal(milli, 3),
            // Five places.
            _ => text.put_decimal(milli.saturating_mul(100), 5),
        }
        text
    }

    /// Returns the largest value in thousandths.
    fn largest_milli(&self) -> i64 {
        match (self.kind, self.number) {
            (Kind::Bits, 10) => 511_000,
            (Kind::SwitchedBits, _) => 7000,
            (Kind::Bits, _) => 3000,
            (Kind::Choice, _) => 4000,
            (Kind::Flag, _) => i64::from(u32::MAX),
            _ => decimal(self.most.as_bytes(), 3).map_or(i64::from(u32::MAX), |(most, _)| most),
        }
    }

    /// Reads a value in thousandths.
    ///
    /// # Errors
    /// Fails with the error that answers the line.
    fn parse(&self, text: &[u8]) -> Result<u32, ErrorCode> {
        let (milli, rest) = decimal(text, 3).ok_or(ErrorCode::BadNumber)?;
        if !rest.is_empty() {
            return Err(ErrorCode::InvalidStatement);
        }
        if milli < 0 {
            return Err(ErrorCode::Negative);
        }
        let least = decimal(self.least.as_bytes(), 3).map_or(0, |(least, _)| least);
        let is_off = milli == 0 && self.takes_zero();
        if !is_off && !(least..=self.largest_milli()).contains(&milli) {
            return Err(ErrorCode::SettingRange);
        }
        let milli = match self.kind {
            Kind::Flag => i64::from(milli != 0).wrapping_mul(1000),
            Kind::Decimal => milli,
            // Decimals are dropped.
            _ => (milli / 1000).wrapping_mul(1000),
        };
        u32::try_from(milli).map_err(|_| ErrorCode::SettingRange)
    }
}

impl<const QUEUE: usize> Grbl<QUEUE> {
    /// Returns the value of a setting as it is printed.
    pub(super) fn hal_value(&self, row: &Row) -> Text {
        row.text(match row.place {
            Place::Grbl(number) => self.settings().milli(number),
            Place::Extra(index) => self.memory.hal.milli(index),
        })
    }

    /// Writes a setting.
    ///
    /// # Errors
    /// Fails with the error that answers the line. Nothing has changed in this case.
    pub(super) fn hal_write(&mut self, number: u16, text: &[u8]) -> Result<(), ErrorCode> {
        let row = row_of(number).ok_or(ErrorCode::SettingUnknown)?;
        let mut settings = *self.settings();
        match row.place {
            Place::Grbl(number) => {
                let is_limits = number == 20;
                row.parse(text)?;
                settings.write(number, text).map_err(|error| match error {
                    ErrorCode::InvalidStatement if !is_limits => ErrorCode::SettingRange,
                    other => other,
                })?;
            }
            Place::Extra(index) => {
                let milli = row.parse(text)?;
                mirror(&mut settings, index, milli)?;
                if let Some(slot) = self.memory.hal.extras.get_mut(index) {
                    if core::mem::replace(slot, milli) != milli {
                        self.store();
                    }
                }
            }
        }
        self.take_settings(settings, number);
        Ok(())
    }
}

/// Copies an extra setting to the setting of Grbl with the same number.
fn mirror(settings: &mut Settings, index: usize, milli: u32) -> Result<(), ErrorCode> {
    match index {
        // The step pulse of Grbl is in whole microseconds, at least 3.
        PULSE => {
            let mut text = Text::new();
            text.put_number(u64::from(milli.saturating_add(999) / 1000).max(3));
            settings.write(0, text.bytes())
        }
        HOMING if (milli / 1000) & 1 == 1 => settings.write(22, b"1"),
        HOMING => settings.write(22, b"0"),
        _ => Ok(()),
    }
}

impl<const QUEUE: usize> Grbl<QUEUE> {
    /// Whether a bit of `$22` is set: 1 for single axes, 2 for homing at the start.
    pub(in super::super) fn hal_homing_has(&self, bit: u32) -> bool {
        let bits = self.memory.hal.milli(HOMING) / 1000;
        bits & 1 == 1 && bits.wrapping_shr(bit) & 1 == 1
    }

    /// Whether a flag of the extra settings is set.
    pub(super) fn hal_is_set(&self, index: usize) -> bool {
        self.memory.hal.milli(index) != 0
    }
}
