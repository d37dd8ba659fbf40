//! First pass: determines the format of coordinates before any is read.

use crate::format::{Digits, Format, Units, Zeros};
use crate::hint::Hint;
use crate::number::Number;
use crate::scanner::Scanner;
use crate::statement::Statement;

/// The kind of file. It sets what the file does not declare.
#[derive(Copy, Clone, Eq, PartialEq, Debug, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Profile {
    /// Excellon: inches 2.4 or millimetres 3.3, `TZ`.
    #[default]
    Excellon,
    /// TANGO, reconstructed from its descendants, because no genuine file is available: Excellon
    /// without a header, inches 2.3, `TZ`, tools without diameters. A header takes precedence.
    Tango,
}

/// Settings that the caller gives. They take precedence over the file.
#[derive(Copy, Clone, Eq, PartialEq, Debug, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Overrides {
    /// The unit.
    pub units: Option<Units>,
    /// The zeros.
    pub zeros: Option<Zeros>,
    /// The digits.
    pub digits: Option<Digits>,
    /// Defaults for settings that are not given and not declared.
    pub profile: Profile,
}

/// The reason of a setting. Lines count from 1.
#[derive(Copy, Clone, Eq, PartialEq, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Reason {
    /// Given by the caller.
    Given,
    /// Declared by a command in this line.
    Declared(u32),
    /// Given by a comment in this line.
    Comment(u32),
    /// Inferred from the numbers, first in this line.
    Numbers(u32),
    /// Given by the profile.
    Profile,
    /// The default.
    Default,
}

/// A setting with its reason.
#[derive(Copy, Clone, Eq, PartialEq, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Settled<T> {
    /// The setting.
    pub value: T,
    /// The reason.
    pub reason: Reason,
}

/// A doubt about the settings.
#[derive(Copy, Clone, Eq, PartialEq, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Doubt {
    /// A number without a point has more digits than the format. The fields are its line and its
    /// number of digits.
    LongNumber(u32, u8),
    /// Some coordinates have a point, and the one in this line has none. It may mean whole units.
    MixedPoints(u32),
}

/// The format of the coordinates of a file.
#[derive(Copy, Clone, Eq, PartialEq, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Settings {
    /// The unit at the beginning.
    pub units: Settled<Units>,
    /// The zeros at the beginning.
    pub zeros: Settled<Zeros>,
    /// The digits at the beginning.
    pub digits: Settled<Digits>,
    /// Whether a comment declares incremental coordinates.
    pub incremental: bool,
    /// Whether any coordinate is without a point. If not, zeros and digits have no effect.
    pub point_missing: bool,
    /// The doubt about these settings, if there is one.
    pub doubt: Option<Doubt>,
}

impl Settings {
    /// Returns the settings without their reasons.
    pub const fn format(&self) -> Format {
        Format {
            units: self.units.value,
            zeros: self.zeros.value,
            digits: self.digits.value,
        }
    }
}

/// Observes all lines of a file and infers its format. Errors in lines are ignored here; the reader
/// reports them.
#[derive(Clone, Debug, Default)]
pub struct Inference {
    line: u32,
    units: Option<Found<Units>>,
    zeros: Option<Found<Zeros>>,
    digits: Option<Found<Digits>>,
    comment_units: Option<Found<Units>>,
    comment_zeros: Option<Found<Zeros>>,
    comment_digits: Option<Found<Digits>>,
    incremental: bool,
    /// Line of the first tool wider than half a unit. Its unit is probably not the inch.
    large_tool: Option<u32>,
    /// Line of the first number that begins with a zero and is not zero.
    leading_zero: Option<u32>,
    shortest: Option<u8>,
    longest: Option<Found<u8>>,
    point_missing: bool,
    point_seen: bool,
    /// Line of the first number without a point that is not zero.
    pointless: Option<u32>,
    ended: bool,
}

#[derive(Copy, Clone, Debug)]
struct Found<T> {
    value: T,
    line: u32,
}

impl Inference {
    /// Creates an inference without lines.
    pub fn new() -> Inference {
        Inference::default()
    }

    /// Observes the next line, without its line end.
    ///
    /// # Cost
    /// A few instructions per byte.
    pub fn observe(&mut self, line: &[u8]) {
        self.line = self.line.saturating_add(1);
        if self.ended {
            return;
        }
        match Statement::parse(line) {
            Ok(Statement::Comment(text)) => self.comment(text),
            Ok(Statement::Units {
                units,
                zeros,
                digits,
                ..
            }) => {
                self.first_units(units);
                self.zeros = self.zeros.or(self.found(zeros));
                self.digits = self.digits.or(self.found(digits));
            }
            Ok(Statement::Words(scanner)) => self.words(scanner),
            Ok(
                Statement::Nothing
                | Statement::Percent
                | Statement::Incremental(_)
                | Statement::Name(_),
            )
            | Err(_) => {}
        }
    }

    /// Returns the settings. The sources in order of precedence: the caller, the first command, a
    /// comment (the last well-formed `FILE_FORMAT`), the profile, the numbers, the default.
    ///
    /// The numbers imply `LZ` if one of them begins with a zero and their lengths differ. A tool
    /// wider than half a unit implies millimetres.
    pub fn settle(&self, overrides: &Overrides) -> Settings {
        let tango = overrides.profile == Profile::Tango;
        let units = said(overrides.units, self.units, self.comment_units).unwrap_or_else(|| {
            match self.large_tool {
                _ if tango => settled(Units::Inches, Reason::Profile),
                Some(line) => settled(Units::Millimetres, Reason::Numbers(line)),
                None => settled(Units::Inches, Reason::Default),
            }
        });
        let lengths_differ = self.longest.map(|longest| longest.value) != self.shortest;
        let zeros = said(overrides.zeros, self.zeros, self.comment_zeros).unwrap_or_else(|| {
            match self.leading_zero {
                _ if tango => settled(Zeros::Trailing, Reason::Profile),
                Some(line) if lengths_differ => settled(Zeros::Leading, Reason::Numbers(line)),
                _ => settled(Zeros::Trailing, Reason::Default),
            }
        });
        let digits =
            said(overrides.digits, self.digits, self.comment_digits).unwrap_or_else(|| {
                match (Digits::new(2, 3), units.reason) {
                    (Some(tango), Reason::Profile) => settled(tango, Reason::Profile),
                    _ => settled(units.value.digits(), Reason::Default),
                }
            });
        let long = self
            .longest
            .filter(|longest| longest.value > digits.value.all() && digits.reason != Reason::Given);
        Settings {
            units,
            zeros,
            digits,
            incremental: self.incremental,
            point_missing: self.point_missing,
            doubt: match (long, self.pointless) {
                (Some(found), _) => Some(Doubt::LongNumber(found.line, found.value)),
                (None, Some(line)) if self.point_seen => Some(Doubt::MixedPoints(line)),
                _ => None,
            },
        }
    }

    fn found<T>(&self, value: Option<T>) -> Option<Found<T>> {
        value.map(|value| Found {
            value,
            line: self.line,
        })
    }

    fn first_units(&mut self, units: Units) {
        self.units = self.units.or(self.found(Some(units)));
    }

    fn comment(&mut self, text: Scanner<'_>) {
        match Hint::parse(text) {
            Some(Hint::Format {
                units,
                zeros,
                digits,
                incremental,
            }) => {
                self.comment_units = self.comment_units.or(self.found(units));
                self.comment_zeros = self.comment_zeros.or(self.found(zeros));
                self.comment_digits = self.found(digits).or(self.comment_digits);
                self.incremental |= incremental;
            }
            Some(Hint::Size { units, .. }) => {
                self.comment_units = self.comment_units.or(self.found(Some(units)));
            }
            Some(Hint::Plated(_)) | None => {}
        }
    }

    fn words(&mut self, mut scanner: Scanner<'_>) {
        let mut is_tool = false;
        while let Some(Ok(word)) = scanner.word() {
            match (word.letter, word.number.whole()) {
                (b'T', _) => is_tool = true,
                (b'C', _) if is_tool => self.tool(&word.number),
                (b'X' | b'Y', _) => self.coordinate(&word.number),
                // The steps of a repeat are shorter than coordinates, so they are not used.
                (b'R', _) | (b'G', Some(4)) | (b'M', Some(47 | 97 | 98)) => return,
                (b'M', Some(71)) => self.first_units(Units::Millimetres),
                (b'M', Some(72)) => self.first_units(Units::Inches),
                (b'M', Some(0 | 30)) => self.ended = true,
                _ => {}
            }
        }
    }

    fn tool(&mut self, diameter: &Number) {
        // A nanometre is a millionth of a millimetre, so the result is in millionths of any unit.
        let millionths = diameter.plain_nm(Units::Millimetres, 0);
        if millionths.is_none_or(|millionths| millionths > 500_000) {
            self.large_tool = self.large_tool.or(Some(self.line));
        }
    }

    fn coordinate(&mut self, number: &Number) {
        if number.has_point() {
            self.point_seen = true;
            return;
        }
        self.point_missing = true;
        // The notation of zero has no information.
        if number.is_zero() {
            return;
        }
        self.pointless = self.pointless.or(Some(self.line));
        let written = number.written();
        if number.has_leading_zero() {
            self.leading_zero = self.leading_zero.or(Some(self.line));
        }
        if self.shortest.is_none_or(|shortest| written < shortest) {
            self.shortest = Some(written);
        }
        if self.longest.is_none_or(|longest| written > longest.value) {
            self.longest = self.found(Some(written));
        }
    }
}

const fn settled<T>(value: T, reason: Reason) -> Settled<T> {
    Settled { value, reason }
}

fn said<T>(
    given: Option<T>,
    declared: Option<Found<T>>,
    comment: Option<Found<T>>,
) -> Option<Settled<T>> {
    given
        .map(|value| settled(value, Reason::Given))
        .or(declared.map(|found| settled(found.value, Reason::Declared(found.line))))
        .or(comment.map(|found| settled(found.value, Reason::Comment(found.line))))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lines::lines;

    fn settings(text: &str, overrides: &Overrides) -> Settings {
        let mut inference = Inference::new();
        for (_, line) in lines(text.as_bytes()) {
            inference.observe(line);
        }
        inference.settle(overrides)
    }

    #[test]
    fn declared_and_hinted() {
        let found = settings(
            "M48\n;FILE_FORMAT=4:4\nMETRIC,LZ\n;FILE_FORMAT = 4 : f\n%\nX002365",
            &Overrides::default(),
        );
        assert_eq!(
            found.units,
            settled(Units::Millimetres, Reason::Declared(3))
        );
        assert_eq!(found.zeros, settled(Zeros::Leading, Reason::Declared(3)));
        let digits = Digits::new(4, 4).unwrap();
        assert_eq!(found.digits, settled(digits, Reason::Comment(2)));
    }

    #[test]
    fn nothing_said() {
        let pads = settings(
            "%\nT1C.015F095S3\nX01095Y0127\nM30\nX1",
            &Overrides::default(),
        );
        assert_eq!(pads.units, settled(Units::Inches, Reason::Default));
        assert_eq!(pads.zeros, settled(Zeros::Leading, Reason::Numbers(3)));
        let equal = settings("T1C0.8\nX010Y020\nX0\n", &Overrides::default());
        assert_eq!(equal.zeros, settled(Zeros::Trailing, Reason::Default));
        assert_eq!(equal.units, settled(Units::Millimetres, Reason::Numbers(1)));
    }

    #[test]
    fn profile_and_caller() {
        let tango = Overrides {
            profile: Profile::Tango,
            ..Overrides::default()
        };
        let found = settings("%\nT1\nX01Y200\n", &tango);
        assert_eq!(found.units, settled(Units::Inches, Reason::Profile));
        assert_eq!(found.zeros, settled(Zeros::Trailing, Reason::Profile));
        assert_eq!(
            found.digits,
            settled(Digits::new(2, 3).unwrap(), Reason::Profile)
        );
        let headed = settings("METRIC,LZ\n%\nT1\nX01Y200\n", &tango);
        assert_eq!(
            headed.digits,
            settled(Units::Millimetres.digits(), Reason::Default)
        );
        let given = Overrides {
            units: Some(Units::Inches),
            ..tango
        };
        assert_eq!(
            settings("METRIC", &given).units,
            settled(Units::Inches, Reason::Given)
        );
    }

    #[test]
    fn numbers_that_are_too_long() {
        let found = settings("METRIC\nX12345678", &Overrides::default());
        assert_eq!(found.doubt, Some(Doubt::LongNumber(2, 8)));
        let given = Overrides {
            digits: Digits::new(4, 4),
            ..Overrides::default()
        };
        assert_eq!(settings("METRIC\nX12345678", &given).doubt, None);
        let mixed = settings("METRIC\nX0Y1.5\nX2", &Overrides::default());
        assert_eq!(mixed.doubt, Some(Doubt::MixedPoints(3)));
    }
}
