//! Reasons for refusing a received line.

use core::fmt;

/// Reason why a line was refused. The sender has to repeat from
/// [`Receiver::expected`](crate::Receiver::expected) on.
#[derive(Copy, Clone, Eq, PartialEq, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum FramingError {
    /// A line without its checksum.
    NoChecksum,
    /// A `*` that is not followed by a number from 0 to 255.
    MalformedChecksum,
    /// The checksum of the line differs from the computed one.
    Checksum {
        /// The checksum in the line.
        given: u8,
        /// The checksum of the received bytes.
        computed: u8,
    },
    /// A line without a number, or with one that is not a whole number of 32 bits.
    NoNumber,
    /// The line number is not the expected one.
    Number {
        /// The number in the line.
        given: u32,
        /// The expected number.
        expected: u32,
    },
}

impl fmt::Display for FramingError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            FramingError::NoChecksum => f.write_str("line without a checksum"),
            FramingError::MalformedChecksum => {
                f.write_str("checksum is not a number from 0 to 255")
            }
            FramingError::Checksum { given, computed } => {
                write!(f, "checksum is {given}, the line has {computed}")
            }
            FramingError::NoNumber => f.write_str("line without a number"),
            FramingError::Number { given, expected } => {
                write!(f, "line number is {given}, expected {expected}")
            }
        }
    }
}

impl core::error::Error for FramingError {}
