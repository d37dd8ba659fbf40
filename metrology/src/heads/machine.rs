//! What has to be known of a measuring machine.

use super::view::Errors;
use crate::scale::Scale;
use husillo_probe::{PreTravel, Tip, UnitVector};
use husillo_transports::nmc::{Baud, Gains};

/// Most entries of a table of pre-travel.
pub const PLACES: usize = 64;

/// Radius and pre-travel of a probe, amounts of the scale.
pub type Stylus = Tip<PLACES>;

/// A measuring machine: its axes, its probe and its line.
#[derive(Clone, Debug, PartialEq)]
pub struct Machine {
    /// One line for people.
    pub title: String,
    /// What a count is worth, on every axis.
    pub scale: Scale,
    /// X, then Y and Z where it has them.
    pub axes: Vec<AxisSettings>,
    /// The probe.
    pub probe: ProbeSettings,
    /// Rate of the line after start-up.
    pub baud: Baud,
    /// What is known of the errors of its axes.
    pub errors: Errors,
}

/// An axis: a servo module and what it drives.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct AxisSettings {
    /// `X`, `Y` or `Z`.
    pub letter: char,
    /// Address of its module, 1 to 32.
    pub module: u8,
    /// Least and largest position in counts from where it is at reset.
    pub travel: [i32; 2],
    /// How far from its goal a move may end, counts.
    pub in_position: u32,
    /// Speed of moves, counts/s.
    pub rate: u32,
    /// Acceleration of all moves, counts/s^2.
    pub acceleration: u32,
    /// Gains and limits of the servo.
    pub gains: Gains,
}

/// The probe.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ProbeSettings {
    /// Speed of the search, counts/s.
    pub rate: u32,
    /// Speed of the touches that count, counts/s.
    pub slow_rate: u32,
    /// Distance backed off before the next touch, counts.
    pub back_off: u32,
    /// Longest distance beyond a contact, counts.
    pub over_travel: u32,
    /// Radius of the ball (0 measures its centre) and distance from touch to signal.
    pub stylus: Stylus,
}

impl AxisSettings {
    /// 0 for X, 1 for Y, 2 for Z.
    #[must_use]
    pub fn coordinate(&self) -> usize {
        "XYZ".find(self.letter).unwrap_or_default()
    }
}

impl Machine {
    /// The axis of a letter, in either case.
    ///
    /// # Errors
    ///
    /// A sentence with the letters that there are.
    pub fn axis(&self, letter: char) -> Result<AxisSettings, String> {
        let letter = letter.to_ascii_uppercase();
        let found = self.axes.iter().find(|axis| axis.letter == letter);
        found.copied().ok_or_else(|| {
            let letters = self.axes.iter().map(|axis| axis.letter.to_string());
            let letters: Vec<_> = letters.collect();
            format!(
                "{} has no axis {letter}: there is {}",
                self.title,
                letters.join(", ")
            )
        })
    }

    /// The highest address of a module.
    #[must_use]
    pub fn modules(&self) -> u8 {
        let modules = self.axes.iter().map(|axis| axis.module);
        modules.max().unwrap_or_default()
    }
}

/// Pre-travel of the positive and the negative direction of all axes, amounts of the scale.
#[must_use]
pub fn both_ways([positive, negative]: [i32; 2]) -> PreTravel<PLACES> {
    let axes = [UnitVector::X, UnitVector::Y, UnitVector::Z];
    let entries = axes.map(|axis| [(axis, positive), (axis.reversed(), negative)]);
    // Six of the places.
    PreTravel::of(entries.as_flattened())
        .unwrap_or_else(|| PreTravel::new([(UnitVector::X, 0); PLACES]))
}
