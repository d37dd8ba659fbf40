//! The reports of a device. They state how its last task ended, its positions, and where its home
//! switches closed.

use super::figure::checked;

/// An event that a device reports.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Report {
    /// All axes are homed. They are at zero, off their switches.
    Homed,
    /// Counted steps, a figure or a back-off from a switch ended.
    Done,
    /// Stopped by command.
    Stopped,
    /// The host was silent, so a jog was not repeated in time, or a lease ended.
    DeadMan,
    /// The tool touches the work piece, and the figure begins.
    Contact,
    /// The approach ended without contact. The figure was not cut.
    NoContact,
    /// There is no figure, because none was stored since another one was deleted.
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
    /// Emergency stop. Nothing moves until a reset.
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

    /// Returns the report with this byte.
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
/// The byte for no report. Nothing has happened since the last command that began a motion, or
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
        with_check([report, flags].into_iter(), &self.position_steps)
    }

    /// Reads the bytes of a device. Returns `None` if the check is wrong.
    pub fn of(bytes: &[u8; STATUS_BYTES]) -> Option<Self> {
        let ([report, flags], places) = content(bytes)?.split_first_chunk::<2>()?;
        let report = match *report {
            NOTHING => None,
            byte => Some(Report::of(byte)?),
        };
        Some(Self {
            report,
            is_moving: flags & 1 != 0,
            is_homed: flags & 2 != 0,
            position_steps: steps_of(places),
        })
    }
}

/// Bytes of [`Switches`] on the line.
pub const SWITCHES_BYTES: usize = 15;

/// Where the home switches closed at the last homing, compared with the homing before. If a switch
/// closes at another step, steps were lost. There is no encoder here that would show this.
#[derive(Copy, Clone, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Switches {
    /// Whether the machine was homed before that homing. Otherwise there is nothing to compare.
    pub are_compared: bool,
    /// **Steps** of the motors of X, Y and Z: the difference between the counted position and the
    /// real one when the switch closed. 0 if no step was lost.
    pub lost_steps: [i32; 3],
}

impl Switches {
    /// Flag, steps with low bytes first, check.
    pub fn bytes(&self) -> [u8; SWITCHES_BYTES] {
        with_check([self.are_compared.into()].into_iter(), &self.lost_steps)
    }

    /// Reads the bytes of a device. Returns `None` if the check is wrong.
    pub fn of(bytes: &[u8; SWITCHES_BYTES]) -> Option<Self> {
        let (flag, steps) = content(bytes)?.split_first()?;
        Some(Self {
            are_compared: flag & 1 != 0,
            lost_steps: steps_of(steps),
        })
    }
}

/// Returns the bytes, the steps with low bytes first, and the check of all of them. `N` is the
/// number of bytes.
fn with_check<const N: usize>(first: impl Iterator<Item = u8>, steps: &[i32]) -> [u8; N] {
    let content = first.chain(steps.iter().flat_map(|steps| steps.to_le_bytes()));
    let mut check = 0;
    let mut bytes = [0; N];
    for (place, byte) in bytes.iter_mut().zip(content) {
        *place = byte;
        check = checked(check, &[byte]);
    }
    if let Some(end) = bytes.last_chunk_mut() {
        *end = check.to_le_bytes();
    }
    bytes
}

/// Returns the bytes before the check. Returns `None` if the check is wrong.
fn content(bytes: &[u8]) -> Option<&[u8]> {
    let (content, check) = bytes.split_last_chunk::<2>()?;
    (checked(0, content) == u16::from_le_bytes(*check)).then_some(content)
}

/// Steps with low bytes first.
fn steps_of<const N: usize>(bytes: &[u8]) -> [i32; N] {
    let mut all = [0; N];
    let steps = bytes.chunks_exact(4).filter_map(<[u8]>::first_chunk);
    for (place, steps) in all.iter_mut().zip(steps) {
        *place = i32::from_le_bytes(*steps);
    }
    all
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

    #[test]
    fn where_switches_closed_comes_back_and_no_flipped_bit_does() {
        for are_compared in [false, true] {
            let switches = Switches {
                are_compared,
                lost_steps: [-40, i32::MAX, i32::MIN],
            };
            let bytes = switches.bytes();
            assert_eq!(Switches::of(&bytes), Some(switches));
            for bit in 0..8 * SWITCHES_BYTES {
                let mut wrong = bytes;
                wrong[bit / 8] ^= 1 << (bit % 8);
                assert_eq!(Switches::of(&wrong), None);
            }
        }
    }
}
