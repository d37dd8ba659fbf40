//! Two levels a quarter of a period apart, and the counts between two samples of them.

use core::fmt;

/// The counts per line of the disc or scale.
///
/// ```text
///             00  01  11  10  00      forward: A comes first
///     A  _____|‾‾‾‾‾‾‾‾|_______|
///     B  _________|‾‾‾‾‾‾‾‾|____
///     X4      +1  +1  +1  +1          every edge
///     X2      +1      +1              both edges of A
///     X1      +1                      the edge of A where B is low
/// ```
///
/// In reverse the same edges count down, so that a disc that vibrates about an edge never
/// accumulates counts. With `X2` and `X1` the position is that of `X4` divided by 2 and 4 and
/// rounded down, whatever motion led to it.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Scale {
    /// One count per line.
    X1,
    /// Two counts per line.
    X2,
    /// Four counts per line.
    X4,
}

/// The entry of a sample for which two edges have passed since the previous one.
const SKIPPED: i32 = -2;

impl Scale {
    /// Sixteen numbers of two bits, -1, 0, 1 and [`SKIPPED`], the first one (from `00` to `00`) on
    /// top.
    const fn table(self) -> u32 {
        let mut table = 0;
        let mut change = 0_u32;
        while change < 16 {
            let [before, now] = [change >> 2, change & 3];
            // Gray code to the quarter of the line.
            let quarters = (now ^ now >> 1).wrapping_sub(before ^ before >> 1) & 3;
            let counts = quarters == 2
                || match self {
                    Scale::X4 => true,
                    Scale::X2 => (before ^ now) & 1 == 1,
                    Scale::X1 => (before ^ now) & 1 == 1 && now & 2 == 0,
                };
            table = table << 2 | if counts { quarters } else { 0 };
            change += 1;
        }
        table
    }
}

const X1: u32 = Scale::X1.table();
const X2: u32 = Scale::X2.table();
const X4: u32 = Scale::X4.table();

/// Both levels changed between two samples: two edges passed in an unknown direction.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Skipped;

impl fmt::Display for Skipped {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str("a state of the encoder was skipped")
    }
}

impl core::error::Error for Skipped {}

/// The direction of counting.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum CountDirection {
    /// Counts rise: A changes before B.
    Forward,
    /// Counts fall.
    Backward,
}

/// A decoder of quadrature signals: one sample of both levels in, its counts out.
///
/// Take at least one sample between any two edges. Two edges are reported ([`Skipped`]). Three look
/// like one in the opposite direction and four like none. No decoder can detect that; only the
/// index does.
///
/// The table has 16 states as in the usual hardware decoders (for instance Avago HCTL-2016, data
/// sheet, "4x decode logic"). It is 32 bits long and stays in a register.
///
/// # Cost
/// 16 instructions per sample on a Cortex-M4F, with the loop. 20 bytes.
///
/// # Examples
/// ```
/// use husillo_encoder::{Quadrature, Scale, Skipped};
///
/// let mut encoder = Quadrature::new(Scale::X4, 0b00);
/// let counts = [0b01, 0b11, 0b11, 0b10, 0b11].map(|levels| encoder.sample(levels));
/// assert_eq!(counts, [Ok(1), Ok(1), Ok(0), Ok(1), Ok(-1)]);
/// assert_eq!(encoder.sample(0b00), Err(Skipped));
/// assert_eq!((encoder.position(), encoder.skipped()), (2, 1));
/// ```
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Quadrature {
    table: u32,
    /// The last levels times 8: they choose the row of the table.
    row: u32,
    position: i32,
    heading: i32,
    skipped: u32,
}

impl Quadrature {
    /// Creates a decoder at position 0 with the present levels: bit 0 is A, bit 1 is B. Other bits
    /// are ignored.
    pub const fn new(scale: Scale, levels: u8) -> Self {
        Self {
            table: match scale {
                Scale::X1 => X1,
                Scale::X2 => X2,
                Scale::X4 => X4,
            },
            row: (levels as u32 & 3) << 3,
            position: 0,
            heading: 0,
            skipped: 0,
        }
    }

    /// Takes the present levels (bit 0 is A, bit 1 is B) and returns the counts since the last
    /// sample: -1, 0 or 1.
    ///
    /// # Errors
    ///
    /// [`Skipped`] if two edges passed. The position stays, so it is off by two edges in an unknown
    /// direction. The next sample is compared with this one.
    #[inline]
    pub fn sample(&mut self, levels: u8) -> Result<i32, Skipped> {
        let levels = u32::from(levels) & 3;
        // row is at most 24, levels 3: the shift is at most 30.
        let shift = self.row | levels << 1;
        self.row = levels << 3;
        let counts = self.table.wrapping_shl(shift) as i32 >> 30;
        if counts == SKIPPED {
            self.skipped = self.skipped.saturating_add(1);
            return Err(Skipped);
        }
        self.position = self.position.wrapping_add(counts);
        if counts != 0 {
            self.heading = counts;
        }
        Ok(counts)
    }

    /// Returns the counts from the last set position. Wraps at 32 bits;
    /// [`Extended`](crate::Extended) has 64.
    pub const fn position(&self) -> i32 {
        self.position
    }

    /// Sets the present position.
    pub const fn set_position(&mut self, position: i32) {
        self.position = position;
    }

    /// Returns the direction of the last count. `None` before the first one.
    pub const fn direction(&self) -> Option<CountDirection> {
        match self.heading {
            0 => None,
            1 => Some(CountDirection::Forward),
            _ => Some(CountDirection::Backward),
        }
    }

    /// Returns the levels of the last sample: bit 0 is A, bit 1 is B.
    pub const fn levels(&self) -> u8 {
        // At most 24.
        (self.row >> 3) as u8
    }

    /// Returns the number of [`Skipped`] samples. It stays at the largest number.
    pub const fn skipped(&self) -> u32 {
        self.skipped
    }
}

/// The levels of two pins as [`Quadrature::sample`] takes them.
pub const fn levels(a: bool, b: bool) -> u8 {
    a as u8 | (b as u8) << 1
}
