//! The moves of a roughing cycle: straight cuts to the contour, one below the other, and then one
//! pass along it.

use super::shape::{Shape, Ways};
use crate::compensation::offset::{Vector, minus, plus};

/// Largest number of cuts of one cycle.
pub(super) const MOST_PASSES: i64 = 1 << 16;

/// A move of a cycle: X as a radius, and Z, in the machine frame.
#[derive(Copy, Clone, Eq, PartialEq, Debug)]
pub(super) enum Move {
    Rapid(Vector),
    Feed(Vector),
    /// G33, called G32 in code system A.
    Thread {
        to: Vector,
        lead: i64,
    },
    Arc {
        to: Vector,
        centre: Vector,
        clockwise: bool,
    },
}

/// State of a cycle; [`Passes::next`] has its actions.
#[derive(Copy, Clone, Eq, PartialEq, Debug)]
enum State {
    Shift,
    Sink,
    Cut,
    Lift,
    Back,
    Last,
    Entry,
    Along(usize),
    Leave,
    Home,
    Down,
    Done,
}

/// Roughing: all lengths in deep and far, see [`Ways`].
///
/// ```text
///        far ──►          start
///  deep   ┌──────────────────────────────────────── first cut ──────┐  45 degrees back
///   │     │◄── rapid ───────────────────────────────────────────────┘  by the retract
///   ▼     └─────────────── second cut ─────┐ ...        contour with its allowance
/// ```
#[derive(Clone, Debug)]
pub(super) struct Passes<const CAPACITY: usize> {
    pub(super) ways: Ways,
    pub(super) shape: Shape<CAPACITY>,
    /// Start and end of the cycle.
    pub(super) start: Vector,
    /// The allowance that shifts the contour away from the material: deep and far are zero or
    /// negative.
    pub(super) shift: Vector,
    /// Depth of a cut, above zero.
    pub(super) depth: i64,
    /// Retract, zero or above.
    pub(super) retract: i64,
    /// Whether the tool goes down to a cut at the feed: the contour begins with G1.
    pub(super) feeds_in: bool,
    cut: i64,
    at: Vector,
    state: State,
}

impl<const CAPACITY: usize> Passes<CAPACITY> {
    pub(super) fn new(ways: Ways, shape: Shape<CAPACITY>, start: Vector) -> Self {
        let start = ways.course(start);
        Passes {
            ways,
            shape,
            start,
            shift: [0, 0],
            depth: 1,
            retract: 0,
            feeds_in: false,
            cut: 1,
            at: start,
            state: State::Shift,
        }
    }

    /// Whether the start is outside the contour with its allowance, so that the tool can leave and
    /// return.
    pub(super) fn starts_free(&self) -> bool {
        let [deep, far] = self.start;
        let end = plus(self.ways.course(self.shape.end()), self.shift);
        self.whole() > 0 && (deep <= end[0] || far <= self.reach(deep))
    }

    /// Total depth of all cuts; not positive where the start is below the bottom of the contour.
    pub(super) fn whole(&self) -> i64 {
        let bottom = self.ways.course(self.shape.from)[0].saturating_add(self.shift[0]);
        bottom.saturating_sub(self.start[0])
    }

    /// Largest possible number of cuts.
    pub(super) fn count(&self) -> i64 {
        let whole = self.whole().max(0);
        let most = whole.saturating_add(self.depth.saturating_sub(1).max(0));
        most.checked_div(self.depth).unwrap_or(i64::MAX)
    }

    /// Returns the next move. Lengths are differences of coordinates, below 2^53.
    pub(super) fn next(&mut self) -> Option<Move> {
        let begin = self.start[1].saturating_add(self.shift[1]);
        let entry = plus(self.ways.course(self.shape.from), self.shift);
        loop {
            // Each state either makes a move or continues to another.
            let made = match self.state {
                State::Shift | State::Sink | State::Cut | State::Lift | State::Back => {
                    self.cut_next(begin)
                }
                State::Done => return None,
                _ => self.finish(begin, entry),
            };
            if made.is_some() {
                return made;
            }
        }
    }

    /// A state of the cuts from the start on, which is shifted by the allowance to `begin`.
    fn cut_next(&mut self, begin: i64) -> Option<Move> {
        match self.state {
            State::Sink => {
                let whole = self.whole();
                let down = self.depth.saturating_mul(self.cut).min(whole);
                let deep = self.start[0].saturating_add(down);
                // Deeper cuts are shorter: after the first one without length there are no others.
                let is_over = whole <= 0 || self.cut > self.count();
                if is_over || self.reach(deep) <= begin {
                    self.state = State::Last;
                    return None;
                }
                self.state = State::Cut;
                Some(self.sink([deep, begin]))
            }
            State::Cut => {
                self.state = State::Lift;
                let far = self.reach(self.at[0]);
                Some(self.feed([self.at[0], far]))
            }
            State::Lift => {
                self.state = State::Back;
                // Not beyond the start of the cut.
                let by = self.retract.min(self.at[1].saturating_sub(begin));
                (by > 0).then(|| self.rapid(minus(self.at, [by, by])))
            }
            State::Back => {
                self.state = State::Sink;
                // At most 2^16.
                self.cut = self.cut.wrapping_add(1);
                self.rapid_if_elsewhere([self.at[0], begin])
            }
            _ => {
                self.state = State::Sink;
                let is_shifted = begin != self.start[1];
                is_shifted.then(|| self.rapid([self.start[0], begin]))
            }
        }
    }

    /// A state of the last cut, along the contour, and of the path back to the start.
    fn finish(&mut self, begin: i64, entry: Vector) -> Option<Move> {
        match self.state {
            State::Last => {
                self.state = State::Entry;
                Some(self.sink([entry[0], begin]))
            }
            State::Entry => {
                self.state = State::Along(0);
                (self.at != entry).then(|| self.feed(entry))
            }
            State::Along(index) => {
                let made = self.along(index);
                if made.is_none() {
                    self.state = State::Leave;
                }
                made
            }
            // Out of the material, back, and to the start.
            State::Leave => {
                self.state = State::Home;
                let is_below = self.at[0] > self.start[0];
                is_below.then(|| self.rapid([self.start[0], self.at[1]]))
            }
            State::Home => {
                self.state = State::Down;
                self.rapid_if_elsewhere([self.at[0], self.start[1]])
            }
            _ => {
                self.state = State::Done;
                self.rapid_if_elsewhere(self.start)
            }
        }
    }

    /// A rapid move, unless the tool is at its end.
    fn rapid_if_elsewhere(&mut self, to: Vector) -> Option<Move> {
        (self.at != to).then(|| self.rapid(to))
    }

    /// The segment of the contour with this index; `None` after the last one.
    fn along(&mut self, index: usize) -> Option<Move> {
        let segment = self.shape.get(index)?;
        // At most CAPACITY.
        self.state = State::Along(index.wrapping_add(1));
        let shift = self.ways.point(self.shift);
        let to = plus(segment.to, shift);
        self.at = self.ways.course(to);
        Some(match segment.arc {
            None => Move::Feed(to),
            Some((centre, clockwise)) => Move::Arc {
                to,
                centre: plus(centre, shift),
                clockwise,
            },
        })
    }

    /// The extent of a cut at this depth.
    fn reach(&self, deep: i64) -> i64 {
        let far = self
            .shape
            .reach(self.ways, deep.saturating_sub(self.shift[0]));
        far.saturating_add(self.shift[1])
    }

    fn rapid(&mut self, to: Vector) -> Move {
        self.at = to;
        Move::Rapid(self.ways.point(to))
    }

    fn feed(&mut self, to: Vector) -> Move {
        self.at = to;
        Move::Feed(self.ways.point(to))
    }

    fn sink(&mut self, to: Vector) -> Move {
        if self.feeds_in {
            self.feed(to)
        } else {
            self.rapid(to)
        }
    }
}

/// The return moves from the end of a finished contour: out of the material first, if the contour
/// determines that direction.
#[derive(Copy, Clone, Debug)]
pub(super) struct Return {
    pub(super) ways: Option<Ways>,
    pub(super) start: Vector,
    pub(super) at: Vector,
}

impl Return {
    /// Returns the next move, always towards the start.
    pub(super) fn next(&mut self) -> Option<Move> {
        if self.at == self.start {
            return None;
        }
        self.at = match self.ways {
            None => self.start,
            Some(ways) => {
                let (at, start) = (ways.course(self.at), ways.course(self.start));
                ways.point(if at[0] > start[0] && at[1] != start[1] {
                    [start[0], at[1]]
                } else if at[1] != start[1] {
                    [at[0], start[1]]
                } else {
                    start
                })
            }
        };
        Some(Move::Rapid(self.at))
    }
}
