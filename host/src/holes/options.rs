//! The settings of a drill file from the command line.

use crate::cli::{self, Holes, Layout};
use husillo_excellon::{Digits, Overrides, Profile, Units, Zeros};
use husillo_gcode::Nm;
use husillo_holes::{Placement, PlacementError, Setup, Shift, SlotHandling, Work};
use husillo_metrology::quantity::{self, Quantity};

/// The settings of the file from the command line.
#[derive(Debug, Default)]
pub struct Options {
    pub(super) setup: Setup,
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
        let setup = Setup {
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
        };
        Ok(Self {
            setup,
            only: args.only.clone(),
            placement: placement(args)?,
        })
    }
}

fn placement(args: &Layout) -> Result<Placement, String> {
    if args.stretch && args.reference.is_empty() {
        return Err("--stretch needs --reference".into());
    }
    Ok(Placement {
        mirror: args.mirror.map(Into::into),
        turn_degrees: args.turn,
        references: args
            .reference
            .iter()
            .map(|text| reference(text))
            .collect::<Result<_, _>>()?,
        stretches: args.stretch,
        shift: args.shift.as_deref().map(shift).transpose()?,
    })
}

/// An error with the option that mends it.
pub(super) fn explained(error: &PlacementError) -> String {
    match error {
        PlacementError::OutOfRange => format!("{error}: see --shift, --turn and --reference"),
        PlacementError::OneReference => {
            "one --reference does not determine the turn: give two, or use --shift".into()
        }
        PlacementError::MirrorImage => format!("--reference: {error}: see --mirror"),
        _ => format!("--reference: {error}"),
    }
}

/// Reads heights, feeds and cycles.
///
/// # Errors
///
/// A sentence about the option that is missing or wrong.
pub fn work(args: &Holes) -> Result<Work, String> {
    let read = |name: &str, text: &str| {
        length(text)
            .filter(|nm| nm.0 > 0)
            .ok_or_else(|| format!("--{name} {text}: a length above zero, as in 1.8 or 0.07in"))
    };
    let depth = args
        .depth
        .as_deref()
        .ok_or("--as gcode needs --depth, the depth of the holes below the board's surface")?;
    let feed = read("feed", &args.feed)?;
    let (clearance, safe) = (
        read("clearance", &args.clearance)?,
        read("safe", &args.safe)?,
    );
    if safe < clearance {
        return Err(format!("--safe {safe} is below --clearance {clearance}"));
    }
    Ok(Work {
        bottom: Nm(-read("depth", depth)?.0),
        clearance,
        safe,
        peck: read("peck", &args.peck)?,
        feed,
        rout_feed: match &args.rout_feed {
            Some(text) => read("rout-feed", text)?,
            None => feed,
        },
        speed: args.speed,
        cycle: args.cycle.into(),
        slots: args.layout.slots.map_or(SlotHandling::Rout, Into::into),
    })
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

/// `X,Y=X,Y`: in the file, and measured.
fn reference(text: &str) -> Result<[[f64; 2]; 2], String> {
    let point = |text: &str| {
        let (x, y) = text.split_once(',')?;
        Some([length(x)?, length(y)?].map(|nm| nm.0 as f64))
    };
    let pair = text
        .split_once('=')
        .and_then(|(file, measured)| Some([point(file)?, point(measured)?]));
    pair.ok_or_else(|| {
        format!(
            "--reference {text}: a position in the file and its measured position, as in \
             5,5=5.02,4.97"
        )
    })
}

fn shift(text: &str) -> Result<Shift, String> {
    if text == "corner" {
        return Ok(Shift::Corner);
    }
    let by = text
        .split_once(',')
        .and_then(|(x, y)| Some([length(x)?, length(y)?]));
    by.map(Shift::By)
        .ok_or_else(|| format!("--shift {text}: two lengths as in 5,-2.5 or 0.1in,0, or corner"))
}
