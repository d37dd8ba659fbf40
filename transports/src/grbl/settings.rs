//! Values of the settings.

use crate::grbl::error::ErrorCode;
use crate::grbl::setting::{SETTINGS, Setting, SettingKind};
use crate::grbl::text::{Text, decimal, rounded};

/// The values of all settings, in thousandths, in the order of [`SETTINGS`].
///
/// # Examples
///
/// ```
/// use husillo_transports::grbl::{ErrorCode, Settings};
///
/// let mut settings = Settings::DEFAULT;
/// assert_eq!(settings.write(110, b"1234.5"), Ok(()));
/// assert_eq!(settings.milli(110), 1_234_500);
/// assert_eq!(settings.write(0, b"2"), Err(ErrorCode::StepPulse));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Settings([u32; SETTINGS.len()]);

impl Default for Settings {
    fn default() -> Self {
        Settings::DEFAULT
    }
}

impl Settings {
    /// Length of the stored form.
    pub const BYTES: usize = 4 * SETTINGS.len();

    /// The default values.
    pub const DEFAULT: Settings = {
        let mut values = [0; SETTINGS.len()];
        let mut index = 0;
        while index < SETTINGS.len() {
            values[index] = SETTINGS[index].default_milli;
            index += 1;
        }
        Settings(values)
    };

    /// Returns a value in thousandths, or 0 for a setting that does not exist.
    pub fn milli(&self, number: u8) -> u32 {
        let mut all = self.0.iter().zip(&SETTINGS);
        let found = all.find(|(_, setting)| setting.number == number);
        found.map_or(0, |(value, _)| *value)
    }

    /// Returns a value as a whole number.
    pub fn whole(&self, number: u8) -> u32 {
        self.milli(number) / 1000
    }

    /// Whether a flag is set.
    pub fn is_set(&self, number: u8) -> bool {
        self.milli(number) != 0
    }

    /// Returns the setting at this index of [`SETTINGS`], and its value as `$$` prints it.
    pub fn text(&self, index: usize) -> Option<(&'static Setting, Text)> {
        let (setting, value) = (SETTINGS.get(index)?, self.0.get(index)?);
        let (value, mut text) = (i64::from(*value), Text::new());
        match setting.kind {
            SettingKind::Decimal => text.put_decimal(value, 3),
            SettingKind::Rounded => text.put_decimal(rounded(value, 1000), 0),
            _ => text.put_decimal(value / 1000, 0),
        }
        Some((setting, text))
    }

    /// Sets a value from the text after `=`.
    ///
    /// # Errors
    /// - [`ErrorCode::InvalidStatement`]: no such setting, something after the number, or a number
    ///   beyond its range.
    /// - [`ErrorCode::BadNumber`], [`ErrorCode::Negative`], [`ErrorCode::StepPulse`],
    ///   [`ErrorCode::SoftLimitsNeedHoming`].
    ///
    /// In case of an error the values are unchanged.
    pub fn write(&mut self, number: u8, text: &[u8]) -> Result<(), ErrorCode> {
        let (milli, rest) = decimal(text, 3).ok_or(ErrorCode::BadNumber)?;
        if !rest.is_empty() {
            return Err(ErrorCode::InvalidStatement);
        }
        let index = SETTINGS
            .iter()
            .position(|setting| setting.number == number)
            .ok_or(ErrorCode::InvalidStatement)?;
        let milli = u64::try_from(milli).map_err(|_| ErrorCode::Negative)?;
        let kind = SETTINGS.get(index).map(|setting| setting.kind);
        let cut = milli / 1000;
        let (value, largest) = match kind {
            Some(SettingKind::Flag) => (u64::from(cut != 0), 1),
            Some(SettingKind::Byte | SettingKind::Mask) => (cut, 255),
            Some(SettingKind::Word) => (cut, 65_535),
            _ => (milli, u64::from(u32::MAX)),
        };
        let is_whole = !matches!(kind, Some(SettingKind::Decimal | SettingKind::Rounded));
        if number == 0 && value < 3 {
            return Err(ErrorCode::StepPulse);
        }
        if number == 20 && value == 1 && !self.is_set(22) {
            return Err(ErrorCode::SoftLimitsNeedHoming);
        }
        if value > largest {
            return Err(ErrorCode::InvalidStatement);
        }
        // At most 65 535 000, or 2^32 - 1.
        let value = if is_whole {
            value.wrapping_mul(1000)
        } else {
            value
        } as u32;
        if let Some(slot) = self.0.get_mut(index) {
            *slot = value;
        }
        if number == 22 && value == 0 {
            // Soft limits need homing, so they are switched off together with it.
            let _ = self.write(20, b"0");
        }
        Ok(())
    }

    /// Converts the values to their stored form, low byte first.
    pub fn to_bytes(&self) -> [u8; Settings::BYTES] {
        let mut bytes = [0; Settings::BYTES];
        for (slot, value) in bytes.chunks_exact_mut(4).zip(self.0) {
            slot.copy_from_slice(&value.to_le_bytes());
        }
        bytes
    }

    /// Reads the stored form.
    pub fn from_bytes(bytes: &[u8; Settings::BYTES]) -> Settings {
        let mut settings = Settings::DEFAULT;
        for (slot, chunk) in settings.0.iter_mut().zip(bytes.chunks_exact(4)) {
            let value = chunk.first_chunk().copied().unwrap_or_default();
            *slot = u32::from_le_bytes(value);
        }
        settings
    }
}

/// Splits the text after `$` of a line that sets something: the number before `=`, and the text
/// after it.
///
/// # Errors
/// - [`ErrorCode::BadNumber`] without a number.
/// - [`ErrorCode::InvalidStatement`] without `=` after it, or with a number beyond 255.
pub fn key_and_value(text: &[u8]) -> Result<(u8, &[u8]), ErrorCode> {
    // Decimals are dropped.
    let (tenths, rest) = decimal(text, 1).ok_or(ErrorCode::BadNumber)?;
    let key = tenths / 10;
    let value = rest.strip_prefix(b"=").ok_or(ErrorCode::InvalidStatement)?;
    let key = u8::try_from(key).map_err(|_| ErrorCode::InvalidStatement)?;
    Ok((key, value))
}
