//! Why a line did not come whole.

use core::fmt;

/// Why a line was refused. The answer to the sender is to send again from
/// [`Receiver::expected`](crate::Receiver::expected) on.
#[derive(Copy, Clone, Eq, PartialEq, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum FramingError {
    /// A line without its checksum.
    NoChecksum,
    /// A `*` with anything but a number from 0 to 255 behind it.
    MalformedChecksum,
    /// The checksum of the line, and the one computed.
    Checksum {
        /// As given.
        given: u8,
        /// Of the bytes received.
        computed: u8,
    },
    /// A line without its number, or with one that is no whole number of 32 bits.
    NoNumber,
    /// The number of the line is not the next one.
    Number {
        /// As given.
        given: u32,
        /// The next one.
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
