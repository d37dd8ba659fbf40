//! The settings of a drill file from the command line.

use crate::cli::{self, Layout};
use crate::holes::placement::Placement;
use husillo_excellon::{Digits, Overrides, Profile, Units, Zeros};
use husillo_gcode::Nm;
use husillo_metrology::quantity::{self, Quantity};

/// The settings of the file from the command line.
#[derive(Debug, Default)]
pub struct Options {
    pub(super) overrides: Overrides,
    pub(super) tools: Vec<(u16, Nm)>,
    pub(super) only: Vec<u16>,
    pub(super) placement: Placement,
}

impl Options {
    /// Reads the options.
    ///
    /// # Errors
    ///
    /// A sentence about the option that is wrong.
    pub fn new(args: &Layout) -> Result<Self, String> {
        let digits = args.format_digits.as_deref().map(|text| {
            digits(text).ok_or_else(|| {
                format!("--format-digits {text}: two digits with a point between, as in 2.4")
            })
        });
        Ok(Self {
            overrides: Overrides {
                units: args.units.map(|units| match units {
                    cli::DrillUnits::Inch => Units::Inches,
                    cli::DrillUnits::Mm => Units::Millimetres,
                }),
                zeros: args.zeros.map(|zeros| match zeros {
                    cli::DrillZeros::Leading => Zeros::Leading,
                    cli::DrillZeros::Trailing => Zeros::Trailing,
                }),
                digits: digits.transpose()?,
                profile: match args.profile {
                    cli::DrillProfile::Excellon => Profile::Excellon,
                    cli::DrillProfile::Tango => Profile::Tango,
                },
            },
            tools: args
                .tool
                .iter()
                .map(|text| tool(text))
                .collect::<Result<_, _>>()?,
            only: args.only.clone(),
            placement: Placement::new(args)?,
        })
    }
}

fn digits(text: &str) -> Option<Digits> {
    let (whole, places) = text.split_once(['.', ':'])?;
    Digits::new(whole.parse().ok()?, places.parse().ok()?)
}

fn tool(text: &str) -> Result<(u16, Nm), String> {
    let refused = || format!("--tool {text}: a number and a diameter, as in 1=0.8 or 1=0.031in");
    let (number, diameter) = text.split_once('=').ok_or_else(refused)?;
    let number = number.trim_start_matches(['T', 't']);
    let number = number.parse().map_err(|_| refused())?;
    match length(diameter) {
        Some(diameter) if diameter.0 > 0 => Ok((number, diameter)),
        _ => Err(refused()),
    }
}

/// A length of the command line: millimetres, unless it has a unit.
pub fn length(text: &str) -> Option<Nm> {
    let with_unit = quantity::parse(text).or_else(|_| quantity::parse(&format!("{text} mm")));
    match with_unit {
        Ok(Quantity::Length(value)) => Some(Nm(value.rounded())),
        _ => None,
    }
    .filter(|nm| nm.0.abs() <= Nm::LIMIT.0)
}
