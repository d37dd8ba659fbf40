//! Commands: what a block means, in the machine frame, with nothing left to look up.

use crate::arc::{Arc, Direction};
use crate::block::axis_letter;
use crate::decimal::Decimal;
use crate::nm::Nm;
use core::fmt;

/// How fast a move is.
#[derive(Copy, Clone, Eq, PartialEq, Debug)]
pub enum Feed {
    /// G94: nanometres of path a minute, above zero.
    PerMinute(Nm),
    /// G93: so many millionths of this move a minute, above zero (2 000 000: the move takes half a minute).
    InverseTime {
        /// Moves a minute times 10^6.
        micro_per_minute: u64,
    },
}

/// What the spindle does.
#[derive(Copy, Clone, Eq, PartialEq, Debug, Default)]
pub enum SpindleDirection {
    /// M5.
    #[default]
    Off,
    /// M3.
    Clockwise,
    /// M4.
    CounterClockwise,
}

/// How moves may be joined.
#[derive(Copy, Clone, Eq, PartialEq, Debug, Default)]
pub enum PathMode {
    /// G61: on the path, slowing only where it must.
    #[default]
    ExactPath,
    /// G61.1: a stop after each move.
    ExactStop,
    /// G64: corners may be rounded, by at most the tolerance (`P`) if one is given.
    Blend {
        /// Largest distance from the path.
        tolerance: Option<Nm>,
    },
}

/// One command. Positions are machine frame; each prints as one line, lengths in millimetres.
#[derive(Copy, Clone, Eq, PartialEq, Debug)]
#[non_exhaustive]
pub enum Command<const N: usize> {
    /// As fast as the machine goes, in a straight line.
    Rapid {
        /// The end.
        to: [Nm; N],
    },
    /// A straight feed move.
    Linear {
        /// The end.
        to: [Nm; N],
        /// Its speed.
        feed: Feed,
    },
    /// A circular or helical feed move.
    Arc {
        /// Its geometry.
        arc: Arc<N>,
        /// Its speed.
        feed: Feed,
    },
    /// A pause.
    Dwell {
        /// Microseconds.
        micros: u64,
    },
    /// Spindle on, off or at another speed.
    Spindle {
        /// Its sense.
        direction: SpindleDirection,
        /// Thousandths of a revolution a minute; 0 when off.
        milli_rpm: u64,
    },
    /// Coolant: both states after the command.
    Coolant {
        /// M7.
        mist: bool,
        /// M8.
        flood: bool,
    },
    /// M6: change to the tool selected last.
    Tool {
        /// Its number; 0 when none was selected.
        number: u32,
    },
    /// M0, or M1 when optional: wait for the operator.
    Stop {
        /// M1.
        optional: bool,
    },
    /// M2, or M30 when it rewinds. Spindle and coolant go off with it.
    End {
        /// M30.
        rewind: bool,
    },
    /// G61, G61.1, G64, each time one is programmed.
    Path {
        /// The mode from here on.
        mode: PathMode,
    },
}

/// The end of a move as ` X1 Y2 Z3`.
struct Point<'a, const N: usize>(&'a [Nm; N]);

impl<const N: usize> fmt::Display for Point<'_, N> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (axis, at) in (0..N).zip(self.0) {
            write!(f, " {}{at}", char::from(axis_letter(axis)))?;
        }
        Ok(())
    }
}

/// `F120` in mm/min, or `F2/min` for inverse time.
impl fmt::Display for Feed {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Feed::PerMinute(rate) => write!(f, "F{rate}"),
            Feed::InverseTime { micro_per_minute } => {
                write!(f, "F{}/min", Millionths(micro_per_minute))
            }
        }
    }
}

/// A number of millionths (or, shifted, thousandths), printed like a length.
struct Millionths(u64);

impl fmt::Display for Millionths {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        Nm(i64::try_from(self.0).unwrap_or(i64::MAX)).fmt(f)
    }
}

impl<const N: usize> fmt::Display for Command<N> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Command::Rapid { to } => write!(f, "rapid{}", Point(to)),
            Command::Linear { to, feed } => write!(f, "linear{} {feed}", Point(to)),
            Command::Arc { arc, feed } => {
                let direction = match arc.direction {
                    Direction::Clockwise => "cw",
                    Direction::CounterClockwise => "ccw",
                };
                write!(
                    f,
                    "arc {direction} {}{} centre{}",
                    arc.plane.name(),
                    Point(&arc.to),
                    Point(&arc.centre)
                )?;
                if arc.turns != 0 {
                    write!(f, " turns {}", arc.turns)?;
                }
                write!(f, " {feed}")
            }
            Command::Dwell { micros } => write!(f, "dwell {} s", Millionths(*micros)),
            Command::Spindle {
                direction: SpindleDirection::Off,
                ..
            } => f.write_str("spindle off"),
            Command::Spindle {
                direction,
                milli_rpm,
            } => {
                let name = if *direction == SpindleDirection::Clockwise {
                    "cw"
                } else {
                    "ccw"
                };
                write!(
                    f,
                    "spindle {name} {} rpm",
                    Millionths(milli_rpm.saturating_mul(1000))
                )
            }
            Command::Coolant {
                mist: false,
                flood: false,
            } => f.write_str("coolant off"),
            Command::Coolant { mist, flood } => {
                f.write_str("coolant")?;
                f.write_str(if *mist { " mist" } else { "" })?;
                f.write_str(if *flood { " flood" } else { "" })
            }
            Command::Tool { number } => write!(f, "tool {number}"),
            Command::Stop { optional } => {
                f.write_str(if *optional { "stop optional" } else { "stop" })
            }
            Command::End { rewind } => f.write_str(if *rewind { "end rewind" } else { "end" }),
            Command::Path {
                mode: PathMode::ExactPath,
            } => f.write_str("path exact"),
            Command::Path {
                mode: PathMode::ExactStop,
            } => f.write_str("path exact-stop"),
            Command::Path {
                mode: PathMode::Blend { tolerance: None },
            } => f.write_str("path blend"),
            Command::Path {
                mode: PathMode::Blend {
                    tolerance: Some(by),
                },
            } => write!(f, "path blend {by}"),
        }
    }
}

/// The commands of one block, in their order of execution: at most eight. Small, owned, and pulled one by one.
#[derive(Clone, Debug)]
pub struct Commands<const N: usize> {
    /// Bit n: the command of place n is still to come.
    pending: u8,
    tool: u32,
    spindle: (SpindleDirection, u64),
    coolant: (bool, bool),
    dwell_micros: u64,
    path: PathMode,
    /// The point a G28 goes through.
    via: [Nm; N],
    motion: Command<N>,
    last: Command<N>,
}

const TOOL: u8 = 1 << 0;
const SPINDLE: u8 = 1 << 1;
const COOLANT: u8 = 1 << 2;
const DWELL: u8 = 1 << 3;
const PATH: u8 = 1 << 4;
const VIA: u8 = 1 << 5;
const MOTION: u8 = 1 << 6;
const LAST: u8 = 1 << 7;

impl<const N: usize> Commands<N> {
    pub(crate) const fn new() -> Self {
        Commands {
            pending: 0,
            tool: 0,
            spindle: (SpindleDirection::Off, 0),
            coolant: (false, false),
            dwell_micros: 0,
            path: PathMode::ExactPath,
            via: [Nm(0); N],
            motion: Command::Dwell { micros: 0 },
            last: Command::Dwell { micros: 0 },
        }
    }

    pub(crate) fn tool(&mut self, number: u32) {
        (self.tool, self.pending) = (number, self.pending | TOOL);
    }

    pub(crate) fn spindle(&mut self, direction: SpindleDirection, milli_rpm: u64) {
        (self.spindle, self.pending) = ((direction, milli_rpm), self.pending | SPINDLE);
    }

    pub(crate) fn coolant(&mut self, mist: bool, flood: bool) {
        (self.coolant, self.pending) = ((mist, flood), self.pending | COOLANT);
    }

    pub(crate) fn dwell(&mut self, micros: u64) {
        (self.dwell_micros, self.pending) = (micros, self.pending | DWELL);
    }

    pub(crate) fn path(&mut self, mode: PathMode) {
        (self.path, self.pending) = (mode, self.pending | PATH);
    }

    pub(crate) fn via(&mut self, at: [Nm; N]) {
        (self.via, self.pending) = (at, self.pending | VIA);
    }

    pub(crate) fn motion(&mut self, motion: Command<N>) {
        (self.motion, self.pending) = (motion, self.pending | MOTION);
    }

    pub(crate) fn finish(&mut self, last: Command<N>) {
        (self.last, self.pending) = (last, self.pending | LAST);
    }
}

impl<const N: usize> Iterator for Commands<N> {
    type Item = Command<N>;

    fn next(&mut self) -> Option<Command<N>> {
        let lowest = self.pending & self.pending.wrapping_neg();
        self.pending &= !lowest;
        Some(match lowest {
            TOOL => Command::Tool { number: self.tool },
            SPINDLE => Command::Spindle {
                direction: self.spindle.0,
                milli_rpm: self.spindle.1,
            },
            COOLANT => Command::Coolant {
                mist: self.coolant.0,
                flood: self.coolant.1,
            },
            DWELL => Command::Dwell {
                micros: self.dwell_micros,
            },
            PATH => Command::Path { mode: self.path },
            VIA => Command::Rapid { to: self.via },
            MOTION => self.motion,
            LAST => self.last,
            _ => return None,
        })
    }

    fn size_hint(&self) -> (usize, Option<usize>) {
        let count = self.pending.count_ones() as usize;
        (count, Some(count))
    }
}

impl<const N: usize> ExactSizeIterator for Commands<N> {}
impl<const N: usize> core::iter::FusedIterator for Commands<N> {}

/// `value * 10^exponent` as an unsigned number.
pub(crate) fn unsigned(value: Decimal, exponent: u8) -> Option<u64> {
    value
        .scaled(1, exponent)
        .and_then(|scaled| u64::try_from(scaled).ok())
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use std::string::ToString;
    use std::vec::Vec;

    #[test]
    fn commands_come_in_order_of_execution() {
        let mut commands = Commands::<2>::new();
        commands.finish(Command::End { rewind: true });
        commands.motion(Command::Rapid {
            to: [Nm(1_500_000), Nm(-1)],
        });
        commands.dwell(1_500_000);
        commands.spindle(SpindleDirection::CounterClockwise, 1_000_500);
        commands.coolant(true, true);
        commands.path(PathMode::Blend {
            tolerance: Some(Nm(50_000)),
        });
        commands.tool(3);
        assert_eq!(commands.len(), 7);
        let lines: Vec<_> = commands.map(|command| command.to_string()).collect();
        assert_eq!(
            lines,
            [
                "tool 3",
                "spindle ccw 1000.5 rpm",
                "coolant mist flood",
                "dwell 1.5 s",
                "path blend 0.05",
                "rapid X1.5 Y-0.000001",
                "end rewind"
            ]
        );
    }
}
