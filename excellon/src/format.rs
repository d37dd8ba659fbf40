//! Format of coordinates: unit, zeros, digits.

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
    /// Returns the default digits of this unit: 2.4 for inches and 3.3 for millimetres.
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

/// Which zeros of a number without a point are written. The other zeros are omitted.
#[derive(Copy, Clone, Eq, PartialEq, Hash, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Zeros {
    /// `LZ`: leading zeros are written, trailing ones omitted. Digits count from the left.
    Leading,
    /// `TZ`: trailing zeros are written, leading ones omitted. Digits count from the right.
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

/// Number of digits before and after the omitted decimal point, as `2.4`.
#[derive(Copy, Clone, Eq, PartialEq, Hash, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Digits {
    whole: u8,
    places: u8,
}

impl Digits {
    /// Creates a number of digits. Returns `None` for more than 9 digits on a side, and for no
    /// digits at all.
    pub const fn new(whole: u8, places: u8) -> Option<Digits> {
        if whole > 9 || places > 9 || (whole == 0 && places == 0) {
            None
        } else {
            Some(Digits { whole, places })
        }
    }

    /// Returns the number of digits before the point, 0 to 9.
    pub const fn whole(self) -> u8 {
        self.whole
    }

    /// Returns the number of digits after the point, 0 to 9.
    pub const fn places(self) -> u8 {
        self.places
    }

    /// Returns the number of all digits, 1 to 18.
    pub const fn all(self) -> u8 {
        self.whole.wrapping_add(self.places)
    }
}

impl fmt::Display for Digits {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}.{}", self.whole, self.places)
    }
}

/// Format that converts the digits of a number to a length.
#[derive(Copy, Clone, Eq, PartialEq, Hash, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Format {
    /// Unit of all numbers.
    pub units: Units,
    /// The written zeros of numbers without a point.
    pub zeros: Zeros,
    /// The position of the point in numbers without one.
    pub digits: Digits,
}
