//! What a device tells: how its last task ended, and where it is.

use super::figure::checked;

/// What has happened.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Report {
    /// All axes stand off their switches, at zero.
    Homed,
    /// Counted steps, a figure or going back off a switch ended.
    Done,
    /// Stopped by command.
    Stopped,
    /// A jog was not said again in time.
    DeadMan,
    /// The tool touches the work piece: the figure begins.
    Contact,
    /// The approach ended without contact; the figure was not cut.
    NoContact,
    /// There is no figure: none was kept since another one was cleared.
    NoFigure,
    /// A home switch closed where none was looked for: the axis goes back off it.
    Switch {
        /// 0 to 2.
        axis: u8,
    },
    /// No home switch closed on the longest way.
    NoSwitch {
        /// 0 to 2.
        axis: u8,
    },
    /// A home switch is closed still after the way back off it.
    StillClosed {
        /// 0 to 2.
        axis: u8,
    },
    /// Emergency stop: until a reset nothing moves.
    Emergency,
}

impl Report {
    /// Its byte: a letter.
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
            // Axes are below 3: no byte comes twice.
            Self::Switch { axis } => b'x'.wrapping_add(axis),
            Self::NoSwitch { axis } => b'X'.wrapping_add(axis),
            Self::StillClosed { axis } => b'1'.wrapping_add(axis),
        }
    }

    /// The report of a byte.
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
/// Stands in place of a report: nothing has happened since the last command that began a motion, or
/// since the reset.
const NOTHING: u8 = b'-';

/// Where a device is.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Status {
    /// How the last task ended, or what has happened in the present one.
    pub report: Option<Report>,
    /// A task is under way.
    pub is_moving: bool,
    /// Positions count from the home switches.
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

    /// What a device told; `None` where the check is wrong.
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
