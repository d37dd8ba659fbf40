//! The records of the circuit-board drill: positions to records of three bytes, and back.
//!
//! The drill's controller keeps its program as records of three bytes: an axis, and its position in
//! motor steps from home. X and Y move one after the other. Z is one whole drilling. The original
//! ignores the number of Z. With its flaws corrected, the number is a depth. A file of records
//! contains the bytes that the link takes in download mode: the records, then `f`.
//!
//! ```text
//!   58 lo hi   `X`: to lo + 256 hi steps         59 lo hi   `Y`: likewise
//!   5a lo hi   `Z`: drill here, 0 = in full      66         `f`: the end, where a record begins
//! ```
//!
//! ```
//! use husillo_transports::drill::{Record, Table, record_bytes, records};
//!
//! let hole = Table::DRILL.hole([10_000_000, 5_000_000])?;
//! assert_eq!(hole, [Record::X(1070), Record::Y(535), Record::Drill(0)]);
//! let file: Vec<u8> = record_bytes(hole).collect();
//! assert_eq!(file, [0x58, 0x2e, 0x04, 0x59, 0x17, 0x02, 0x5a, 0, 0, 0x66]);
//! let back: Result<Vec<_>, _> = records(&file).collect();
//! assert_eq!(back, Ok(hole.to_vec()));
//! # Ok::<(), husillo_transports::drill::OffTable>(())
//! ```
//!
//! Limits: a record holds 0 to 65 535 steps, which are 612.477 mm. The table is 23 540 by 4815
//! steps ([`Table::DRILL`]). A position is rounded to the nearest step, so its error is at most
//! half a step, 4.673 um. These errors do not add up. The controller's buffer holds 8192 bytes:
//! 2730 records and two bytes of the next one. A longer file is sent in pieces.

use core::fmt;
use core::iter::FusedIterator;

/// Motor steps per millimetre in X and Y: 200 steps per turn, a screw of 1 mm and a gear of
/// 0.53499. This is the whole number that the controller's own tables use.
pub const STEPS_PER_MM: u16 = 107;

/// The byte after the last record.
pub const END_OF_PROGRAM: u8 = b'f';

/// One record.
#[derive(Copy, Clone, Eq, PartialEq, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Record {
    /// Move X to this position, in steps from home.
    X(u16),
    /// Move Y to this position, in steps from home.
    Y(u16),
    /// Drill: down by this many steps, then up to the upper end switch. With 0 the spindle goes
    /// down to the lower end switch. The original always does, because it ignores the number.
    Drill(u16),
}

impl Record {
    /// Returns its three bytes: letter, low and high byte of the steps.
    pub const fn to_bytes(self) -> [u8; 3] {
        let (letter, [low, high]) = match self {
            Record::X(steps) => (b'X', steps.to_le_bytes()),
            Record::Y(steps) => (b'Y', steps.to_le_bytes()),
            Record::Drill(steps) => (b'Z', steps.to_le_bytes()),
        };
        [letter, low, high]
    }

    /// Reads a record of three bytes. Returns `None` if the first byte is not `X`, `Y` or `Z`. The
    /// controller takes any other byte except `f` for an X. This function refuses it.
    pub const fn from_bytes([letter, low, high]: [u8; 3]) -> Option<Record> {
        let steps = u16::from_le_bytes([low, high]);
        match letter {
            b'X' => Some(Record::X(steps)),
            b'Y' => Some(Record::Y(steps)),
            b'Z' => Some(Record::Drill(steps)),
            _ => None,
        }
    }
}

/// `X 1070`, `Y 535`, `drill`, or `drill 300` to a depth.
impl fmt::Display for Record {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Record::X(steps) => write!(f, "X {steps}"),
            Record::Y(steps) => write!(f, "Y {steps}"),
            Record::Drill(0) => f.write_str("drill"),
            Record::Drill(steps) => write!(f, "drill {steps}"),
        }
    }
}

/// The last positions of the table, in steps from home.
#[derive(Copy, Clone, Eq, PartialEq, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Table {
    /// The last step of X.
    pub x: u16,
    /// The last step of Y.
    pub y: u16,
}

impl Table {
    /// The table of the machine: 220 mm by 45 mm.
    pub const DRILL: Table = Table {
        x: 23_540,
        y: 4_815,
    };

    /// The largest positions of a record, for boards that are larger than the table: 612.477 mm in
    /// both axes.
    pub const UNBOUNDED: Table = Table {
        x: u16::MAX,
        y: u16::MAX,
    };

    /// Returns the record that moves X to a position in nanometres from home.
    ///
    /// # Errors
    /// The position is not on the table.
    pub const fn move_x(&self, to_nm: i64) -> Result<Record, OffTable> {
        match steps(to_nm, self.x) {
            Some(steps) => Ok(Record::X(steps)),
            None => Err(OffTable {
                letter: b'X',
                at_nm: to_nm,
                last: self.x,
            }),
        }
    }

    /// Returns the record that moves Y to a position in nanometres from home.
    ///
    /// # Errors
    /// The position is not on the table.
    pub const fn move_y(&self, to_nm: i64) -> Result<Record, OffTable> {
        match steps(to_nm, self.y) {
            Some(steps) => Ok(Record::Y(steps)),
            None => Err(OffTable {
                letter: b'Y',
                at_nm: to_nm,
                last: self.y,
            }),
        }
    }

    /// Converts a position in nanometres from home to steps of X and Y.
    ///
    /// # Errors
    /// The position is not on the table. If both coordinates are off the table, the error is that
    /// of X.
    pub const fn steps(&self, [x, y]: [i64; 2]) -> Result<[u16; 2], OffTable> {
        match (self.move_x(x), self.move_y(y)) {
            (Ok(Record::X(x)), Ok(Record::Y(y))) => Ok([x, y]),
            (Err(error), _) | (_, Err(error)) => Err(error),
            // The first two results are always moves of X and Y.
            _ => Ok([0; 2]),
        }
    }

    /// Returns the records of a hole at a position in nanometres from home: X, Y, drill.
    ///
    /// # Errors
    /// The position is not on the table. If both coordinates are off the table, the error is that
    /// of X.
    pub const fn hole(&self, [x, y]: [i64; 2]) -> Result<[Record; 3], OffTable> {
        match (self.move_x(x), self.move_y(y)) {
            (Ok(x), Ok(y)) => Ok([x, y, Record::Drill(0)]),
            (Err(error), _) | (_, Err(error)) => Err(error),
        }
    }
}

/// Returns the nearest step if it is on the table. Halves round away from zero.
const fn steps(at_nm: i64, last: u16) -> Option<u16> {
    const NM_PER_MM: i64 = 1_000_000;
    let Some(scaled) = at_nm.checked_mul(STEPS_PER_MM as i64) else {
        return None;
    };
    if scaled <= -NM_PER_MM / 2 {
        return None;
    }
    // The position is above minus half a step, so the sum is above zero, and rounding the quotient
    // towards zero gives the nearest step. The quotients are below 2^44.
    let (whole, rest) = (scaled / NM_PER_MM, scaled % NM_PER_MM);
    let steps = whole.wrapping_add(rest.wrapping_add(NM_PER_MM / 2) / NM_PER_MM);
    if steps <= last as i64 {
        Some(steps as u16)
    } else {
        None
    }
}

/// Nanometres that are printed as millimetres, without trailing zeros.
struct Millimetres(i64);

impl fmt::Display for Millimetres {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (sign, nm) = (if self.0 < 0 { "-" } else { "" }, self.0.unsigned_abs());
        write!(f, "{sign}{}", nm / 1_000_000)?;
        let (mut rest, mut place) = (nm % 1_000_000, 100_000);
        if rest > 0 {
            f.write_str(".")?;
        }
        while rest > 0 {
            write!(f, "{}", rest / place)?;
            (rest, place) = (rest % place, place / 10);
        }
        Ok(())
    }
}

/// A position that is not on the table.
#[derive(Copy, Clone, Eq, PartialEq, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct OffTable {
    /// `X` or `Y`.
    pub letter: u8,
    /// The position, nanometres from home.
    pub at_nm: i64,
    /// The last step of that axis.
    pub last: u16,
}

impl fmt::Display for OffTable {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        // Rounded down to whole micrometres. 65 535 steps are 612 476 635 nm, so the product is
        // below 2^37.
        let micrometres = u64::from(self.last)
            .saturating_mul(1000)
            .checked_div(u64::from(STEPS_PER_MM))
            .unwrap_or(0);
        write!(
            f,
            "{}{} is off the table, 0 to {} mm",
            char::from(self.letter),
            Millimetres(self.at_nm),
            Millimetres((micrometres as i64).saturating_mul(1000))
        )
    }
}

impl core::error::Error for OffTable {}

/// Returns the bytes of a program: its records, then [`END_OF_PROGRAM`]. The controller cannot take
/// a program without records, because a download does not end before the first record.
pub fn record_bytes<R: IntoIterator<Item = Record>>(records: R) -> RecordBytes<R::IntoIter> {
    RecordBytes {
        records: records.into_iter(),
        rest: [0; 2],
        left: 0,
        ended: false,
    }
}

/// Iterator over the bytes of a program; see [`record_bytes`].
#[derive(Clone, Debug)]
pub struct RecordBytes<R> {
    records: R,
    /// The second and the third byte of the present record.
    rest: [u8; 2],
    /// The number of them that are left.
    left: u8,
    ended: bool,
}

impl<R: Iterator<Item = Record>> Iterator for RecordBytes<R> {
    type Item = u8;

    fn next(&mut self) -> Option<u8> {
        let [low, high] = self.rest;
        match self.left {
            2 => {
                self.left = 1;
                return Some(low);
            }
            1 => {
                self.left = 0;
                return Some(high);
            }
            _ if self.ended => return None,
            _ => {}
        }
        match self.records.next() {
            Some(record) => {
                let [letter, low, high] = record.to_bytes();
                (self.rest, self.left) = ([low, high], 2);
                Some(letter)
            }
            None => {
                self.ended = true;
                Some(END_OF_PROGRAM)
            }
        }
    }
}

impl<R: Iterator<Item = Record>> FusedIterator for RecordBytes<R> {}

/// The kind of an error in the bytes of a program.
#[derive(Copy, Clone, Eq, PartialEq, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum RecordErrorKind {
    /// A record begins with this byte, which is not `X`, `Y`, `Z` or `f`.
    UnknownAxis(u8),
    /// The last record has one or two bytes only.
    CutOff,
    /// There is no `f` after the last record.
    NoEnd,
    /// `f` is before the first record. The controller would take it for the first byte of a record.
    Empty,
    /// There are bytes after the `f`.
    AfterEnd,
}

/// The first error in the bytes of a program, and its position.
#[derive(Copy, Clone, Eq, PartialEq, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct RecordError {
    /// The error.
    pub kind: RecordErrorKind,
    /// Offset of the first wrong byte.
    pub at: usize,
    /// Offset after the last wrong byte. It equals `at` if something is missing at the end.
    pub end: usize,
}

impl fmt::Display for RecordError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.kind {
            RecordErrorKind::UnknownAxis(byte) => write!(f, "record of unknown axis {byte:#04x}"),
            RecordErrorKind::CutOff => f.write_str("record cut off"),
            RecordErrorKind::NoEnd => f.write_str("program without an end"),
            RecordErrorKind::Empty => f.write_str("program without a record"),
            RecordErrorKind::AfterEnd => f.write_str("bytes after the end"),
        }
    }
}

impl core::error::Error for RecordError {}

/// Returns the records of a program. The first error is the last item.
pub fn records(bytes: &[u8]) -> Records<'_> {
    Records {
        rest: bytes,
        at: 0,
        done: false,
    }
}

/// Iterator over the records of a program; see [`records`].
#[derive(Clone, Debug)]
pub struct Records<'a> {
    rest: &'a [u8],
    at: usize,
    done: bool,
}

impl Iterator for Records<'_> {
    type Item = Result<Record, RecordError>;

    fn next(&mut self) -> Option<Self::Item> {
        if self.done {
            return None;
        }
        let at = self.at;
        // All offsets are at most the length of the bytes.
        let behind = |count: usize| at.saturating_add(count);
        let (kind, start, end) = match *self.rest {
            [letter, low, high, ref rest @ ..] if letter != END_OF_PROGRAM => {
                match Record::from_bytes([letter, low, high]) {
                    Some(record) => {
                        (self.rest, self.at) = (rest, behind(3));
                        return Some(Ok(record));
                    }
                    None => (RecordErrorKind::UnknownAxis(letter), at, behind(1)),
                }
            }
            [] => (RecordErrorKind::NoEnd, at, at),
            [END_OF_PROGRAM, ..] if at == 0 => (RecordErrorKind::Empty, at, behind(1)),
            [END_OF_PROGRAM] => {
                self.done = true;
                return None;
            }
            [END_OF_PROGRAM, ref rest @ ..] => (
                RecordErrorKind::AfterEnd,
                behind(1),
                behind(1).saturating_add(rest.len()),
            ),
            [letter, ..] if Record::from_bytes([letter, 0, 0]).is_none() => {
                (RecordErrorKind::UnknownAxis(letter), at, behind(1))
            }
            [..] => (RecordErrorKind::CutOff, at, behind(self.rest.len())),
        };
        self.done = true;
        Some(Err(RecordError {
            kind,
            at: start,
            end,
        }))
    }
}

impl FusedIterator for Records<'_> {}
