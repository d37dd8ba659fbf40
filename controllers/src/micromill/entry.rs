//! A line in the queue: 24 bytes, so that sixteen lines fit a small chip.

use husillo_gcode::{Arc, Command, Direction, Feed, Nm, Plane, Units};
use husillo_transports::micromill::{Line, Point};

/// A position in nanometres from machine zero, within 2.1 m.
pub(super) type Place = [i32; 3];

/// The effect of a line.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    Nothing,
    Rapid,
    Linear,
    Clockwise,
    CounterClockwise,
    Dwell,
    SpindleClockwise,
    SpindleCounterClockwise,
    SpindleOff,
    Tool,
    End,
}

/// A line in machine coordinates.
#[derive(Copy, Clone, Debug)]
pub(super) struct Entry {
    pub(super) kind: Kind,
    /// Feed in tenths of mm/min, seconds, turns per minute, or a number.
    pub(super) value: u16,
    pub(super) to: Place,
    /// X and Y of the centre of an arc.
    centre: [i32; 2],
}

impl Entry {
    pub(super) const NOTHING: Entry = Entry {
        kind: Kind::Nothing,
        value: 0,
        to: [0; 3],
        centre: [0; 2],
    };

    /// Converts the line that starts at `from`, with the work zero at `zero`. Returns `None` beyond
    /// 2.1 m.
    pub(super) fn new(line: Line, from: Place, zero: Place) -> Option<Entry> {
        let mut entry = Entry {
            to: from,
            ..Entry::NOTHING
        };
        let [x, y, z] = &mut entry.to;
        let [zero_x, zero_y, zero_z] = zero;
        (entry.kind, entry.value) = match line {
            Line::Rapid(point) | Line::Linear(point, _) => {
                match point {
                    Point::Z(at) => *z = placed(at, zero_z)?,
                    Point::Xy([at_x, at_y]) => {
                        if let Some(at) = at_x {
                            *x = placed(at, zero_x)?;
                        }
                        if let Some(at) = at_y {
                            *y = placed(at, zero_y)?;
                        }
                    }
                }
                match line {
                    Line::Linear(_, feed) => (Kind::Linear, feed),
                    _ => (Kind::Rapid, 0),
                }
            }
            Line::Arc {
                clockwise,
                to: [to_x, to_y],
                centre: [i, j],
                feed,
            } => {
                (*x, *y) = (placed(to_x, zero_x)?, placed(to_y, zero_y)?);
                entry.centre = [placed(i, zero_x)?, placed(j, zero_y)?];
                let kind = if clockwise {
                    Kind::Clockwise
                } else {
                    Kind::CounterClockwise
                };
                (kind, feed)
            }
            Line::MachineZero { z: true } => {
                *z = 0;
                (Kind::Rapid, 0)
            }
            Line::MachineZero { z: false } => {
                (*x, *y) = (0, 0);
                (Kind::Rapid, 0)
            }
            Line::Dwell(seconds) => (Kind::Dwell, seconds),
            Line::Zero | Line::Absolute => (Kind::Nothing, 0),
            Line::Spindle {
                clockwise: true,
                rpm,
            } => (Kind::SpindleClockwise, rpm),
            Line::Spindle { rpm, .. } => (Kind::SpindleCounterClockwise, rpm),
            Line::SpindleOff => (Kind::SpindleOff, 0),
            Line::Tool(number) => (Kind::Tool, number.into()),
            Line::End => (Kind::End, 0),
        };
        Some(entry)
    }

    /// Whether the line moves axes.
    pub(super) const fn moves(&self) -> bool {
        matches!(
            self.kind,
            Kind::Rapid | Kind::Linear | Kind::Clockwise | Kind::CounterClockwise
        )
    }

    /// Returns the motion of the line. Returns `None` if it moves no axes, or if its arc is
    /// invalid.
    pub(super) fn command(&self, from: Place) -> Option<Command<3>> {
        let to = nm(self.to);
        // At most 6.6e9, because 0.1 mm/min are 100 000 nm.
        let feed = Feed::PerMinute(Nm(i64::from(self.value).wrapping_mul(100_000)));
        let direction = match self.kind {
            Kind::Rapid => return Some(Command::Rapid { to }),
            Kind::Linear => return Some(Command::Linear { to, feed }),
            Kind::Clockwise => Direction::Clockwise,
            Kind::CounterClockwise => Direction::CounterClockwise,
            _ => return None,
        };
        let [_, _, z] = from;
        let [i, j] = self.centre;
        let centre = nm([i, j, z]);
        let units = Units::Micrometres;
        let arc = Arc::around(&nm(from), to, centre, Plane::Xy, direction, units)?;
        Some(Command::Arc { arc, feed })
    }
}

/// Converts a coordinate in units of 10 nm to the machine frame.
fn placed(at: i32, zero_nm: i32) -> Option<i32> {
    at.checked_mul(10)?.checked_add(zero_nm)
}

pub(super) fn nm(place: Place) -> [Nm; 3] {
    place.map(|at| Nm(at.into()))
}
