//! The moves of a run with their times, and the position of the tool over time, for the viewer.

mod samples;

use crate::geometry::path::Path;
use crate::observers::{AXES, Begun, Now, Observer};
use husillo_gcode::{Command, Direction, Feed, Nm};
use husillo_machine::Origin;
use std::io;

pub use samples::{Sample, Samples};

/// Most moves kept.
pub const MOST_MOVES: usize = 1_000_000;
/// Most take-ups and dwells kept, each.
const MOST_STOPS: usize = 20_000;
/// Points of a curve between its ends.
const CURVE_POINTS: u32 = 24;

/// The kind of a move.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Moved by hand.
    Jog,
    /// A rapid.
    Rapid,
    /// A feed.
    Feed,
    /// A feed that follows the spindle.
    Thread,
    /// A feed that ends at a contact.
    Probe,
}

/// The shape of a move between its ends.
#[derive(Clone, Debug, PartialEq)]
pub enum Shape {
    /// Straight.
    Line,
    /// A circle, spiral or helix.
    Arc {
        /// The axes of its plane.
        plane: [usize; 2],
        /// Its centre in the plane, nm.
        centre: [i64; 2],
        /// Number of turns, begun ones included: positive counter-clockwise.
        turns: i32,
    },
    /// A curve through these points in X, Y and Z, nm.
    Curve(Vec<[i64; 3]>),
}

/// A programmed move.
#[derive(Clone, Debug)]
pub struct Recorded {
    /// What kind of move it is.
    pub kind: Kind,
    /// Its start, nm of the machine frame.
    pub from: [i64; AXES],
    /// Its end.
    pub to: [i64; AXES],
    /// Its shape.
    pub shape: Shape,
    /// Ticks of its begin and end, take-ups before its first step included.
    pub ticks: [u64; 2],
    /// Programmed speed, nm/s: 0 for a rapid, and where it depends on the spindle or the length.
    pub feed: u64,
    /// Thousandths of a turn per minute; 0 if the spindle is off.
    pub milli_rpm: u64,
}

/// A time at which the tool stands still.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stand {
    /// Ticks at its begin.
    pub begin: u64,
    /// Number of the move that it is part of, or follows.
    pub after: usize,
    /// Position of the tool, nm.
    pub at: [f64; 3],
    /// The axis that takes up its backlash; `None` for a dwell.
    pub axis: Option<usize>,
}

/// Records a run.
#[derive(Clone, Debug)]
pub struct Recording {
    /// The moves, in the order of their execution.
    pub moves: Vec<Recorded>,
    /// Whether `moves` has all of them.
    pub is_whole: bool,
    /// Take-ups and dwells.
    pub stands: Vec<Stand>,
    /// Position of the tool at equal intervals.
    pub samples: Samples,
    now: u64,
    at: [f64; 3],
}

impl Recording {
    /// Starts at rest. `timer_hz` is the number of ticks per second.
    pub fn new(timer_hz: u32) -> Self {
        Self {
            moves: Vec::new(),
            is_whole: true,
            stands: Vec::new(),
            samples: Samples::new(u64::from(timer_hz / 1000).max(1)),
            now: 0,
            at: [0.0; 3],
        }
    }

    /// Puts the tool at these steps before the run.
    pub const fn start_at(&mut self, tool: [i32; AXES]) {
        self.samples.start_at(tool);
    }

    fn stand(&mut self, axis: Option<usize>, begin: u64) {
        if self.stands.len() < MOST_STOPS {
            self.stands.push(Stand {
                begin,
                after: self.moves.len().saturating_sub(1),
                at: self.at,
                axis,
            });
        }
    }
}

impl Observer for Recording {
    fn begin(&mut self, begun: &Begun<'_>) {
        if self.moves.len() >= MOST_MOVES {
            self.is_whole = false;
            return;
        }
        let command = &begun.segment.command;
        self.moves.push(Recorded {
            kind: kind(command),
            from: begun.segment.from.map(|Nm(nm)| nm),
            to: begun.to.map(|Nm(nm)| nm),
            shape: shape(begun),
            ticks: [self.now; 2],
            feed: feed(command),
            milli_rpm: begun.milli_rpm,
        });
    }

    #[inline]
    fn step(&mut self, now: &Now<'_>) -> io::Result<()> {
        if now.begins_take_up {
            let axis = now.step.delta.iter().position(|delta| *delta != 0);
            self.stand(axis, self.now);
        }
        self.samples.take(now.ticks, now.tool, now.sent);
        (self.now, self.at) = (now.ticks, now.place());
        if now.origin != Origin::Rest {
            if let Some(last) = self.moves.last_mut().filter(|_| self.is_whole) {
                last.ticks[1] = now.ticks;
            }
        }
        Ok(())
    }

    fn dwell(&mut self, ticks: u64) {
        self.stand(None, self.now);
        self.samples.stay(ticks);
        self.now = ticks;
    }

    fn finish(&mut self) -> io::Result<()> {
        self.samples.stay(self.now);
        Ok(())
    }
}

const fn kind(command: &Command<AXES>) -> Kind {
    match command {
        Command::Rapid { .. } => Kind::Rapid,
        Command::Thread { .. } | Command::Tap { .. } => Kind::Thread,
        Command::Probe { .. } => Kind::Probe,
        _ => Kind::Feed,
    }
}

fn feed(command: &Command<AXES>) -> u64 {
    let (Command::Linear { feed, .. }
    | Command::Arc { feed, .. }
    | Command::Spline { feed, .. }
    | Command::Probe { feed, .. }) = command
    else {
        return 0;
    };
    match feed {
        Feed::PerMinute(Nm(nm)) => u64::try_from(nm / 60).unwrap_or(0),
        Feed::InverseTime { .. } | Feed::PerRevolution(_) => 0,
    }
}

fn shape(begun: &Begun<'_>) -> Shape {
    match (&begun.segment.command, begun.path) {
        (Command::Arc { arc, .. }, _) => {
            let plane = arc.plane.axes();
            let turns = i32::try_from(arc.turns).unwrap_or(i32::MAX - 1) + 1;
            Shape::Arc {
                plane,
                centre: plane.map(|axis| arc.centre[axis].0),
                turns: match arc.direction {
                    Direction::CounterClockwise => turns,
                    Direction::Clockwise => -turns,
                },
            }
        }
        (_, Path::Curve(curve)) => Shape::Curve(between(|part| curve.place(part))),
        (_, Path::Nurbs(curve)) => Shape::Curve(between(|part| curve.place(part))),
        _ => Shape::Line,
    }
}

/// Points between the ends of a curve, whose points are given for the range 0 to 1.
fn between(at: impl Fn(f64) -> [f64; 3]) -> Vec<[i64; 3]> {
    (1..CURVE_POINTS)
        .map(|part| at(f64::from(part) / f64::from(CURVE_POINTS)).map(|nm| nm.round() as i64))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::observers::tests::{begun, line, now};

    #[test]
    fn a_move_has_its_times_and_a_take_up_belongs_to_it() {
        let mut recording = Recording::new(1_000_000);
        let (segment, path) = (line(Nm(9000)), Path::line([0.0; 3], [9000.0, 0.0, 0.0]));
        recording.begin(&begun(&segment, &path));
        let take_up = Now {
            origin: Origin::TakeUp,
            begins_take_up: true,
            ..now(1)
        };
        recording.step(&take_up).unwrap();
        for event in 2..=9 {
            recording.step(&now(event)).unwrap();
        }
        recording.dwell(12_000);
        recording.begin(&begun(&segment, &path));
        recording.step(&now(13)).unwrap();
        recording.finish().unwrap();
        let [first, second] = &recording.moves[..] else {
            panic!("two moves")
        };
        assert_eq!((first.ticks, second.ticks), ([0, 9000], [12_000, 13_000]));
        assert_eq!(
            (first.kind, first.to[0], first.feed),
            (Kind::Feed, 9000, 1_000_000)
        );
        let [take_up, dwell] = recording.stands[..] else {
            panic!("a take-up and a dwell")
        };
        assert_eq!(
            (take_up.axis, take_up.begin, take_up.after),
            (Some(0), 0, 0)
        );
        assert_eq!((dwell.axis, dwell.begin, dwell.after), (None, 9000, 0));
    }
}
