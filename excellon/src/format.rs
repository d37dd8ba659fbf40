//! How a coordinate is to be read: unit, zeros, digits.

use core::fmt;

/// The unit of a drill file.
#[derive(Copy, Clone, Eq, PartialEq, Hash, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Units {
    /// `INCH`, M72; exactly 25.4 mm.
    Inches,
    /// `METRIC`, M71.
    Millimetres,
}

impl Units {
    /// The digits that a file of this unit has when nothing else is said: 2.4 and 3.3.
    pub const fn digits(self) -> Digits {
        match self {
            Units::Inches => Digits {
                whole: 2,
                places: 4,
            },
            Units::Millimetres => Digits {
                whole: 3,
                places: 3,
            },
        }
    }
}

impl fmt::Display for Units {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Units::Inches => "inch",
            Units::Millimetres => "mm",
        })
    }
}

/// Which zeros of a number without a point are written; the others are left out.
#[derive(Copy, Clone, Eq, PartialEq, Hash, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Zeros {
    /// `LZ`: leading zeros are kept, trailing ones left out. Digits count from the left.
    Leading,
    /// `TZ`: trailing zeros are kept, leading ones left out. Digits count from the right.
    Trailing,
}

impl fmt::Display for Zeros {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Zeros::Leading => "leading zeros kept (LZ)",
            Zeros::Trailing => "trailing zeros kept (TZ)",
        })
    }
}

/// Digits before and behind the point that is not written, as `2.4`.
#[derive(Copy, Clone, Eq, PartialEq, Hash, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Digits {
    whole: u8,
    places: u8,
}

impl Digits {
    /// `None` for more than 9 digits on a side, and for none at all.
    pub const fn new(whole: u8, places: u8) -> Option<Digits> {
        if whole > 9 || places > 9 || (whole == 0 && places == 0) {
            None
        } else {
            Some(Digits { whole, places })
        }
    }

    /// Digits before the point, 0 to 9.
    pub const fn whole(self) -> u8 {
        self.whole
    }

    /// Digits behind the point, 0 to 9.
    pub const fn places(self) -> u8 {
        self.places
    }

    /// Both together, 1 to 18.
    pub const fn all(self) -> u8 {
        self.whole.wrapping_add(self.places)
    }
}

impl fmt::Display for Digits {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}.{}", self.whole, self.places)
    }
}

/// All that a number needs besides its digits to be a length.
#[derive(Copy, Clone, Eq, PartialEq, Hash, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Format {
    /// Unit of all numbers.
    pub units: Units,
    /// Zeros that are written, of numbers without a point.
    pub zeros: Zeros,
    /// Where the point is, of numbers without one.
    pub digits: Digits,
}
