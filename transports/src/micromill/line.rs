//! Lines of a program: words in a fixed order.

use super::{Text, reader::Reader};

/// Coordinates in the frame of the part, in units of 10 nm, below 10^7 each. An axis without a word
/// keeps its position.
pub type XyPoint = [Option<i32>; 2];

/// The end of a straight move: X and Y (at least one of them), or Z alone.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Point {
    /// X and Y.
    Xy(XyPoint),
    /// Z.
    Z(i32),
}

/// One line.
///
/// Words are `X` `Y` `Z` `I` `J`, an optional sign, one to five digits of micrometres and up to two
/// decimals. Feeds are in tenths of mm/min.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Line {
    /// `G00X01000Y00500;`, `G00Z00100.50;`: a rapid move.
    Rapid(Point),
    /// `G01X01000F08;`, `G01Z-00100F08;`: at a feed of two to four digits, not 0.
    Linear(Point, u16),
    /// `G02X02969.00Y03400.00I03012.00J03040.00F08;`, `G03..`: an arc. An arc that ends where it
    /// begins is a full turn.
    Arc {
        /// G02.
        clockwise: bool,
        /// Its end.
        to: [i32; 2],
        /// Its centre, in the part's frame, as for the end.
        centre: [i32; 2],
        /// Tenths of mm/min, not 0.
        feed: u16,
    },
    /// `G04P03;`: seconds, one to four digits.
    Dwell(u16),
    /// `G28X0Y0;`, `G28Z0;`: a rapid move to machine zero.
    MachineZero {
        /// Whether Z moves. Otherwise X and Y move.
        z: bool,
    },
    /// `G54;`: the present position becomes the part's zero.
    Zero,
    /// `G90;`: coordinates are absolute, as always.
    Absolute,
    /// `M03S1000;`, `M04..`: the spindle, turns per minute in one to four digits.
    Spindle {
        /// M03.
        clockwise: bool,
        /// Turns per minute.
        rpm: u16,
    },
    /// `M05;`: the spindle stops.
    SpindleOff,
    /// `M06T02;`: a tool, one or two digits. The host waits for the operator.
    Tool(u8),
    /// `M30;`: the program has ended; the spindle stops.
    End,
}

impl Line {
    /// Reads a string without its `;`, blanks or line ends. Returns `None` if no such line exists.
    pub fn read(string: &[u8]) -> Option<Line> {
        let (code, words) = string.split_first_chunk::<3>()?;
        let mut reader = Reader(words);
        let line = match code {
            b"G00" => Line::Rapid(point(&mut reader)?),
            b"G01" => {
                let point = point(&mut reader)?;
                Line::Linear(point, feed(&mut reader)?)
            }
            b"G02" | b"G03" => {
                let mut word = |letter| reader.coordinate(letter).flatten();
                let to = [word(b'X')?, word(b'Y')?];
                let centre = [word(b'I')?, word(b'J')?];
                Line::Arc {
                    clockwise: code == b"G02",
                    to,
                    centre,
                    feed: feed(&mut reader)?,
                }
            }
            b"G04" => Line::Dwell(reader.word(b'P', 1, 4)?),
            b"G28" => match point(&mut reader)? {
                Point::Xy([Some(0), Some(0)]) => Line::MachineZero { z: false },
                Point::Z(0) => Line::MachineZero { z: true },
                _ => return None,
            },
            b"G54" => Line::Zero,
            b"G90" => Line::Absolute,
            b"M03" | b"M04" => Line::Spindle {
                clockwise: code == b"M03",
                rpm: reader.word(b'S', 1, 4)?,
            },
            b"M05" => Line::SpindleOff,
            b"M06" => Line::Tool(reader.word(b'T', 1, 2)? as u8),
            b"M30" => Line::End,
            _ => return None,
        };
        reader.is_empty().then_some(line)
    }

    pub(super) fn write(&self, text: &mut Text) {
        let code = match self {
            Line::Rapid(_) => b"G00",
            Line::Linear(..) => b"G01",
            Line::Arc {
                clockwise: true, ..
            } => b"G02",
            Line::Arc { .. } => b"G03",
            Line::Dwell(_) => b"G04",
            Line::MachineZero { .. } => b"G28",
            Line::Zero => b"G54",
            Line::Absolute => b"G90",
            Line::Spindle {
                clockwise: true, ..
            } => b"M03",
            Line::Spindle { .. } => b"M04",
            Line::SpindleOff => b"M05",
            Line::Tool(_) => b"M06",
            Line::End => b"M30",
        };
        code.iter().for_each(|byte| text.push(*byte));
        match *self {
            Line::Rapid(point) => write_point(text, point),
            Line::Linear(point, feed) => {
                write_point(text, point);
                write_feed(text, feed);
            }
            Line::Arc {
                to: [x, y],
                centre: [i, j],
                feed,
                ..
            } => {
                for (letter, value) in [(b'X', x), (b'Y', y), (b'I', i), (b'J', j)] {
                    text.coordinate(letter, Some(value));
                }
                write_feed(text, feed);
            }
            Line::Dwell(seconds) => write_word(text, b'P', seconds, 4),
            Line::MachineZero { z: true } => write_word(text, b'Z', 0, 1),
            Line::MachineZero { z: false } => {
                write_word(text, b'X', 0, 1);
                write_word(text, b'Y', 0, 1);
            }
            Line::Spindle { rpm, .. } => write_word(text, b'S', rpm, 4),
            Line::Tool(number) => write_word(text, b'T', number.into(), 2),
            Line::Zero | Line::Absolute | Line::SpindleOff | Line::End => {}
        }
    }
}

fn point(reader: &mut Reader<'_>) -> Option<Point> {
    if let Some(z) = reader.coordinate(b'Z')? {
        return Some(Point::Z(z));
    }
    let point = [reader.coordinate(b'X')?, reader.coordinate(b'Y')?];
    (point != [None, None]).then_some(Point::Xy(point))
}

fn feed(reader: &mut Reader<'_>) -> Option<u16> {
    reader.word(b'F', 2, 4).filter(|feed| *feed != 0)
}

fn write_point(text: &mut Text, point: Point) {
    match point {
        Point::Xy([x, y]) => {
            text.coordinate(b'X', x);
            text.coordinate(b'Y', y);
        }
        Point::Z(z) => text.coordinate(b'Z', Some(z)),
    }
}

fn write_feed(text: &mut Text, feed: u16) {
    write_word(text, b'F', feed, if feed < 100 { 2 } else { 4 });
}

fn write_word(text: &mut Text, letter: u8, value: u16, digits: u8) {
    text.push(letter);
    text.digits(value.into(), digits);
}
