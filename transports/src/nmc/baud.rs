//! The rates of the line.

/// Rate of the line in bits per second.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Baud {
    /// 9600.
    B9600,
    /// 19200, the rate after power-up and reset.
    #[default]
    B19200,
    /// 57600.
    B57600,
    /// 115200. The original's chip divides its clock to 113636.
    B115200,
    /// 230400, for modules of version 10 and later.
    B230400,
}

impl Baud {
    /// All rates, the slowest first.
    pub const ALL: [Baud; 5] = [
        Baud::B9600,
        Baud::B19200,
        Baud::B57600,
        Baud::B115200,
        Baud::B230400,
    ];

    /// Returns the divisor of Set Baud, from the original's table.
    pub const fn divisor(self) -> u8 {
        match self {
            Baud::B9600 => 129,
            Baud::B19200 => 63,
            Baud::B57600 => 20,
            Baud::B115200 => 10,
            Baud::B230400 => 5,
        }
    }

    /// Returns the rate of a divisor on a module of this version. Returns `None` if the module
    /// keeps its rate.
    ///
    /// This is a table instead of a formula, because the divisors of clients differ by one: 129 and
    /// 127, 63 and 64, 20 and 21 are all in use.
    pub const fn from_divisor(divisor: u8, version: u8) -> Option<Baud> {
        match divisor {
            127 | 129 => Some(Baud::B9600),
            63 | 64 => Some(Baud::B19200),
            20 | 21 => Some(Baud::B57600),
            10 => Some(Baud::B115200),
            5 if version >= 10 => Some(Baud::B230400),
            _ => None,
        }
    }

    /// Returns the bits per second.
    pub const fn bits_per_s(self) -> u32 {
        match self {
            Baud::B9600 => 9600,
            Baud::B19200 => 19200,
            Baud::B57600 => 57600,
            Baud::B115200 => 115_200,
            Baud::B230400 => 230_400,
        }
    }

    /// Returns the time of `characters` of 10 bits (start, 8 data, stop) in microseconds, rounded
    /// up, at most 4.29e6.
    pub const fn characters_us(self, characters: u16) -> u32 {
        // 65535 * 10^7 < 2^40, so the product fits 64 bits; the quotient is below 6.9e7.
        (characters as u64 * 10_000_000).div_ceil(self.bits_per_s() as u64) as u32
    }
}
