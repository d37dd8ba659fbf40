//! The report of a device: how its last task ended, and its positions.

use super::figure::checked;

/// An event that a device reports.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Report {
    /// All axes are homed and stand at zero, off their switches.
    Homed,
    /// Counted steps, a figure or a back-off from a switch ended.
    Done,
    /// Stopped by command.
    Stopped,
    /// The host was silent: a jog was not repeated in time, or a lease ended.
    DeadMan,
    /// The tool touches the work piece: the figure begins.
    Contact,
    /// The approach ended without contact. The figure was not cut.
    NoContact,
    /// There is no figure: none was stored since another one was deleted.
    NoFigure,
    /// A home switch closed unexpectedly. The axis backs off it.
    Switch {
        /// 0 to 2.
        axis: u8,
    },
    /// No home switch closed within the longest distance.
    NoSwitch {
        /// 0 to 2.
        axis: u8,
    },
    /// A home switch is still closed after the back-off.
    StillClosed {
        /// 0 to 2.
        axis: u8,
    },
    /// Emergency stop: nothing moves until a reset.
    Emergency,
}

impl Report {
    /// Returns its byte, a letter.
    pub const fn byte(self) -> u8 {
        match self {
            Self::Homed => b'h',
            Self::Done => b'd',
            Self::Stopped => b's',
            Self::DeadMan => b'j',
            Self::Contact => b'c',
            Self::NoContact => b'n',
            Self::NoFigure => b'f',
            Self::Emergency => b'!',
            // Axes are below 3, so no byte occurs twice.
            Self::Switch { axis } => b'x'.wrapping_add(axis),
            Self::NoSwitch { axis } => b'X'.wrapping_add(axis),
            Self::StillClosed { axis } => b'1'.wrapping_add(axis),
        }
    }

    /// Returns the report of a byte.
    pub const fn of(byte: u8) -> Option<Self> {
        Some(match byte {
            b'h' => Self::Homed,
            b'd' => Self::Done,
            b's' => Self::Stopped,
            b'j' => Self::DeadMan,
            b'c' => Self::Contact,
            b'n' => Self::NoContact,
            b'f' => Self::NoFigure,
            b'!' => Self::Emergency,
            b'x'..=b'z' => Self::Switch {
                axis: byte.wrapping_sub(b'x'),
            },
            b'X'..=b'Z' => Self::NoSwitch {
                axis: byte.wrapping_sub(b'X'),
            },
            b'1'..=b'3' => Self::StillClosed {
                axis: byte.wrapping_sub(b'1'),
            },
            _ => return None,
        })
    }
}

/// Bytes of a [`Status`] on the line.
pub const STATUS_BYTES: usize = 20;
/// The byte without a report: nothing has happened since the last command that began a motion, or
/// since the reset.
const NOTHING: u8 = b'-';

/// The state of a device.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Status {
    /// How the last task ended, or the last event of the present one.
    pub report: Option<Report>,
    /// Whether a task is in progress.
    pub is_moving: bool,
    /// Whether positions count from the home switches.
    pub is_homed: bool,
    /// **Steps** of the load in X, Y and Z, and of the spindle.
    pub position_steps: [i32; 4],
}

impl Status {
    /// Report, flags, positions with low bytes first, check.
    pub fn bytes(&self) -> [u8; STATUS_BYTES] {
        let report = self.report.map_or(NOTHING, Report::byte);
        let flags = u8::from(self.is_moving) | u8::from(self.is_homed) << 1;
        let places = self.position_steps.map(i32::to_le_bytes);
        let content = [report, flags]
            .into_iter()
            .chain(places.into_iter().flatten());
        let mut check = 0;
        let mut bytes = [0; STATUS_BYTES];
        for (place, byte) in bytes.iter_mut().zip(content) {
            *place = byte;
            check = checked(check, &[byte]);
        }
        if let Some(end) = bytes.last_chunk_mut() {
            *end = check.to_le_bytes();
        }
        bytes
    }

    /// Reads the bytes of a device. `None` if the check is wrong.
    pub fn of(bytes: &[u8; STATUS_BYTES]) -> Option<Self> {
        let (content, check) = bytes.split_last_chunk::<2>()?;
        if checked(0, content) != u16::from_le_bytes(*check) {
            return None;
        }
        let ([report, flags], places) = content.split_first_chunk::<2>()?;
        let report = match *report {
            NOTHING => None,
            byte => Some(Report::of(byte)?),
        };
        let mut position_steps = [0; 4];
        for (steps, bytes) in position_steps.iter_mut().zip(places.chunks_exact(4)) {
            *steps = i32::from_le_bytes(*bytes.first_chunk()?);
        }
        Some(Self {
            report,
            is_moving: flags & 1 != 0,
            is_homed: flags & 2 != 0,
            position_steps,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_reported_comes_back_and_no_flipped_bit_does() {
        for byte in 0..=255 {
            let report = Report::of(byte);
            assert!(report.is_none_or(|report| report.byte() == byte));
            let status = Status {
                report,
                is_moving: byte & 1 != 0,
                is_homed: byte & 2 != 0,
                position_steps: [1, -2, i32::MIN, i32::MAX],
            };
            let bytes = status.bytes();
            assert_eq!(Status::of(&bytes), Some(status));
            for bit in 0..8 * STATUS_BYTES {
                let mut wrong = bytes;
                wrong[bit / 8] ^= 1 << (bit % 8);
                assert_eq!(Status::of(&wrong), None);
            }
        }
    }
}
