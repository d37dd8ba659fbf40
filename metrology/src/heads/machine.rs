//! The settings of a measuring machine.

use super::switches::Switches;
use super::view::Errors;
use super::wiring::Wiring;
use crate::scale::Scale;
use husillo_probe::{PreTravel, Tip, UnitVector};
use husillo_sim::DcMotorModel;
use husillo_transports::nmc::{Baud, Gains};

/// Largest number of entries of a table of pre-travel.
pub const PRE_TRAVEL_ENTRIES: usize = 64;

/// Radius and pre-travel of a probe, in amounts of the scale.
pub type Stylus = Tip<PRE_TRAVEL_ENTRIES>;

/// A measuring machine: its axes, its probe and its line.
#[derive(Clone, Debug, PartialEq)]
pub struct Machine {
    /// Title of the machine, one line.
    pub title: String,
    /// Length of a count, on every axis.
    pub scale: Scale,
    /// X, then Y and Z if the machine has them.
    pub axes: Vec<AxisSettings>,
    /// The probe.
    pub probe: ProbeSettings,
    /// Baud rate of the line after start-up.
    pub baud: Baud,
    /// The known errors of its axes.
    pub errors: Errors,
}

/// An axis: a servo module and what it drives.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AxisSettings {
    /// `X`, `Y` or `Z`.
    pub letter: char,
    /// Address of its module, 1 to 32.
    pub module: u8,
    /// Least and largest position, counts from home. Before homing they count from the position at
    /// reset.
    pub travel: [i32; 2],
    /// Largest distance from its goal at which a move may end, counts.
    pub in_position: u32,
    /// Speed of moves, counts/s.
    pub rate: u32,
    /// Acceleration of all moves, counts/s^2.
    pub acceleration: u32,
    /// Connections of limits 1 and 2 of its module.
    pub limits: [Wiring; 2],
    /// Gains and limits of the servo.
    pub gains: Gains,
    /// Its motor, in simulations.
    pub motor: DcMotorModel,
}

/// The probe.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ProbeSettings {
    /// Speed of the search, counts/s.
    pub rate: u32,
    /// Speed of the slow touches, whose positions are measured, counts/s.
    pub slow_rate: u32,
    /// Distance that the probe backs off before the next touch, counts.
    pub back_off: u32,
    /// Longest distance beyond a contact, counts.
    pub over_travel: u32,
    /// Its contacts.
    pub switches: Switches,
    /// Radius of the ball, and the pre-travel from touch to signal. With radius 0, results are
    /// positions of the centre of the ball.
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
    /// The axis of a letter, upper or lower case.
    ///
    /// # Errors
    ///
    /// There is no such axis: a sentence with the letters of the axes.
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

    /// Returns the motor of the module with this address, for simulations. Modules without an axis
    /// have the motor of the prototype.
    #[must_use]
    pub fn motor(&self, module: u8) -> DcMotorModel {
        let mut axes = self.axes.iter();
        let axis = axes.find(|axis| axis.module == module);
        axis.map_or(DcMotorModel::PROTOTYPE, |axis| axis.motor)
    }

    /// The highest address of a module.
    #[must_use]
    pub fn modules(&self) -> u8 {
        let modules = self.axes.iter().map(|axis| axis.module);
        modules.max().unwrap_or_default()
    }
}

/// The same pre-travel on all axes: in positive direction, and in negative direction. In amounts of
/// the scale.
#[must_use]
pub fn pre_travel_by_sign([positive, negative]: [i32; 2]) -> PreTravel<PRE_TRAVEL_ENTRIES> {
    let axes = [UnitVector::X, UnitVector::Y, UnitVector::Z];
    let entries = axes.map(|axis| [(axis, positive), (axis.reversed(), negative)]);
    // Six entries of 64.
    PreTravel::of(entries.as_flattened())
        .unwrap_or_else(|| PreTravel::new([(UnitVector::X, 0); PRE_TRAVEL_ENTRIES]))
}
