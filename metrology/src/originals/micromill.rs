//! The micro mill: lines, squares, circles and parts that are cut with the backlash of the original
//! screws.

mod choices;
mod circle;
mod circles;
mod cutting;
mod frame;
mod lines;
mod measured;
mod part_tables;
mod parts;
mod screws;
mod squares;
mod supply;
#[cfg(test)]
mod trials;

pub use choices::{interpolators, marks, power_chips, sequences};
pub use circle::Circle;
pub use circles::circles;
pub use lines::lines;
pub use parts::part;
pub use screws::{Screw, Screws};
pub use squares::squares;
pub use supply::supply;

use super::Parameter;
use crate::calibration::backlash::{BacklashTable, Bench, RUN_UP_MM, backlash_table, cut_all};
use crate::quantity::Fraction;
use std::fmt;

/// Middle of the work area, mm.
pub const MIDDLE_MM: [f64; 2] = [5.0, 3.5];
/// The work area, mm.
const TRAVEL_MM: [[f64; 2]; 2] = [[0.0, 10.0], [0.0, 7.0]];
/// The length of a step with which the original calculates.
pub const NOMINAL_STEP: Fraction = Fraction { num: 140, den: 1 };
/// The step of a screw of 0.5 mm per turn behind 28 steps and a gear of 1:128: 139.51 nm.
pub const TRUE_STEP: Fraction = Fraction {
    num: 500_000 / 32,
    den: 28 * 128 / 32,
};
/// Take-up of the original when it cut the squares of table 14, um.
const FIRST_TAKE_UP_UM: [f64; 2] = [192.5, 168.5];
/// Take-up of the original when it cut the circles of table 15, and later, um.
const LAST_TAKE_UP_UM: [f64; 2] = [204.0, 178.0];
/// Backlash that remained in the work according to the original, um. It is used as the spread of
/// every backlash value.
const LEFT_UM: [f64; 2] = [33.0, 27.0];
/// Largest error of the reading of a mark, um. It is used as the spread of every length.
const READING_UM: f64 = 10.0;
/// Largest distance between two positions of the map of today, mm.
const EVERY_MM: f64 = 1.0;

/// Settings of the controller of a mill.
#[derive(Clone, Debug)]
pub struct Settings {
    /// Step of the axes in nm.
    pub step: Fraction,
    /// Backlash that it takes up on X and Y.
    pub take_up: [BacklashTable; 2],
}

impl Settings {
    /// The original: steps of 140 nm, and one value per axis in um.
    #[must_use]
    pub fn original(take_up_um: [f64; 2]) -> Self {
        Self {
            step: NOMINAL_STEP,
            take_up: take_up_um.map(everywhere),
        }
    }
}

/// The same backlash at every position.
fn everywhere(um: f64) -> BacklashTable {
    BacklashTable {
        axes: [0, 1],
        positions_mm: [vec![0.0], vec![0.0]],
        backlash_um: vec![um],
    }
}

/// Builds a homed mill with these settings on these screws. Its [`Bench`] reports the true position
/// of the tool, in steps of [`TRUE_STEP`].
pub type Build<'a> = dyn Fn(&Settings, &Screws) -> Result<Box<dyn Bench>, String> + 'a;

/// Mills on the fitted screws, with the settings of the original and with those of today.
pub struct Shop<'a> {
    build: &'a Build<'a>,
    screws: Screws,
    today: Settings,
}

impl fmt::Debug for Shop<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Shop")
            .field("screws", &self.screws)
            .field("today", &self.today)
            .finish_non_exhaustive()
    }
}

impl<'a> Shop<'a> {
    /// Fits the screws and maps their backlash.
    ///
    /// # Errors
    ///
    /// The machine refuses a move, or cannot be built.
    pub fn new(build: &'a Build<'a>) -> Result<Self, String> {
        let screws = Screws::fitted();
        Ok(Self {
            build,
            screws,
            today: mapped(&screws, build)?,
        })
    }

    /// A mill on the fitted screws.
    fn mill(&self, settings: &Settings) -> Result<Box<dyn Bench>, String> {
        (self.build)(settings, &self.screws)
    }
}

/// True length divided by the length with which the original calculates.
fn scale() -> f64 {
    nm(TRUE_STEP) / nm(NOMINAL_STEP)
}

fn nm(step: Fraction) -> f64 {
    step.num as f64 / step.den as f64
}

/// The settings of today: the true step, and a backlash map from two-line tests over the whole work
/// area.
fn mapped(screws: &Screws, build: &Build<'_>) -> Result<Settings, String> {
    let mut settings = Settings {
        step: TRUE_STEP,
        take_up: LAST_TAKE_UP_UM.map(everywhere),
    };
    let pairs = cut_all(
        &mut *build(&settings, screws)?,
        EVERY_MM,
        TRAVEL_MM,
        RUN_UP_MM,
    )?;
    let step_nm = [nm(TRUE_STEP); 3];
    for axis in 0..2 {
        let map = settings.take_up[axis].map(TRUE_STEP, [TRUE_STEP; 3]);
        let map = map.map_err(|why| why.to_string())?;
        let backlash: Vec<_> = pairs
            .iter()
            .map(|pair| {
                let taken_up_nm = pair.taken_up_nm(&map, step_nm, TRAVEL_MM);
                (*pair, pair.backlash_nm(taken_up_nm))
            })
            .collect();
        settings.take_up[axis] =
            backlash_table(axis, &backlash)?.ok_or("no position was measured")?;
    }
    Ok(settings)
}

/// The parameters of all tables of the mill that are cut on these screws.
fn parameters(screws: &Screws) -> Vec<Parameter> {
    let mut parameters = vec![Parameter::new(
        "true step",
        format!("{:.2} nm", nm(TRUE_STEP)),
        "a screw of 0.5 mm per turn, 28 steps, gear 1:128; the original rounds it to 140 nm",
    )];
    for (name, screw) in ["X", "Y"].iter().zip(screws.axes()) {
        parameters.push(Parameter::new(
            format!("backlash of {name}"),
            screw.to_string(),
            "fitted to the plays of tables 13, 14 and 15: um, with u and v in mm from the middle \
             along the own and the other axis",
        ));
    }
    parameters
}
