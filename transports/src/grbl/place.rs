//! Positions and coordinate data.

use crate::grbl::MOST_AXES;
use crate::grbl::text::{Text, decimal, rounded};

/// Unit of lengths in reports.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Units {
    /// Millimetres with three places.
    #[default]
    Millimetres,
    /// Inches with four places.
    Inches,
}

impl Units {
    /// Returns the number of decimals of a length.
    pub(crate) const fn places(self) -> u8 {
        match self {
            Units::Millimetres => 3,
            Units::Inches => 4,
        }
    }

    /// Returns the value of the last decimal, in nanometres.
    pub(crate) const fn last_place_nm(self) -> u64 {
        match self {
            Units::Millimetres => 1000,
            Units::Inches => 2540,
        }
    }
}

impl Text {
    /// Appends a length in nanometres.
    pub fn put_length(&mut self, nm: i64, units: Units) {
        self.put_decimal(rounded(nm, units.last_place_nm()), units.places());
    }

    /// Appends a feed: mm/min without decimals, or inches per minute with one decimal.
    pub(crate) fn put_feed(&mut self, nm_per_min: u64, units: Units) {
        let nm = i64::try_from(nm_per_min).unwrap_or(i64::MAX);
        match units {
            Units::Millimetres => self.put_decimal(rounded(nm, 1_000_000), 0),
            Units::Inches => self.put_decimal(rounded(nm, 2_540_000), 1),
        }
    }
}

/// A position of up to [`MOST_AXES`] axes, in nanometres.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Place {
    nm: [i64; MOST_AXES],
    axes: usize,
}

impl Place {
    /// Creates a position. Axes beyond [`MOST_AXES`] are dropped.
    pub fn new(nm: &[i64]) -> Self {
        let mut place = Place::default();
        for (slot, nm) in place.nm.iter_mut().zip(nm) {
            *slot = *nm;
        }
        place.axes = nm.len().min(MOST_AXES);
        place
    }

    /// Returns the position of each axis, in nanometres.
    pub fn nm(&self) -> &[i64] {
        self.nm.get(..self.axes).unwrap_or_default()
    }

    /// Appends the lengths, separated by commas.
    pub fn put(&self, text: &mut Text, units: Units) {
        for (axis, nm) in (0_usize..).zip(self.nm()) {
            if axis > 0 {
                text.put(b",");
            }
            text.put_length(*nm, units);
        }
    }

    /// Reads lengths that are separated by commas.
    pub(crate) fn parse(text: &[u8]) -> Option<(Place, Units)> {
        let mut place = Place::default();
        let mut units = Units::Millimetres;
        for field in text.split(|byte| *byte == b',') {
            let (nm, found) = length(field)?;
            *place.nm.get_mut(place.axes)? = nm;
            place.axes = place.axes.wrapping_add(1); // there was a slot
            units = found;
        }
        Some((place, units))
    }
}

/// Reads a length. With four decimals it is in inches.
pub(crate) fn length(text: &[u8]) -> Option<(i64, Units)> {
    let places = match text.iter().position(|byte| *byte == b'.') {
        // The point is one of the bytes.
        Some(at) => text.len().saturating_sub(at).saturating_sub(1),
        None => 0,
    };
    let units = if places == 4 {
        Units::Inches
    } else {
        Units::Millimetres
    };
    let (value, rest) = decimal(text, units.places())?;
    let nm = value.checked_mul(units.last_place_nm() as i64)?;
    rest.is_empty().then_some((nm, units))
}

/// A coordinate datum of `$#`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Parameter {
    /// The zero of a work coordinate system, 0 (G54) to 5 (G59).
    Frame(u8),
    /// The position of G28.
    G28,
    /// The position of G30.
    G30,
    /// The shift of G92.
    G92,
}

impl Parameter {
    /// All parameters, in the order of `$#`.
    pub const ALL: [Parameter; 9] = [
        Parameter::Frame(0),
        Parameter::Frame(1),
        Parameter::Frame(2),
        Parameter::Frame(3),
        Parameter::Frame(4),
        Parameter::Frame(5),
        Parameter::G28,
        Parameter::G30,
        Parameter::G92,
    ];

    /// Returns its name.
    pub const fn name(self) -> &'static str {
        match self {
            Parameter::Frame(0) => "G54",
            Parameter::Frame(1) => "G55",
            Parameter::Frame(2) => "G56",
            Parameter::Frame(3) => "G57",
            Parameter::Frame(4) => "G58",
            Parameter::Frame(_) => "G59",
            Parameter::G28 => "G28",
            Parameter::G30 => "G30",
            Parameter::G92 => "G92",
        }
    }
}
