//! The path of the tool and the programmed moves, for the pictures of the report.

use crate::geometry::path::Path;
use crate::observers::drawing::{Class, Drawing, Point};
use crate::observers::{AXES, Begun, Now, Observer};
use husillo_gcode::{Command, Direction, Nm};
use husillo_machine::Origin;
use std::io;

/// A programmed move in the axes of the picture, nm.
#[derive(Clone, Copy, Debug)]
pub enum Ideal {
    /// Start and end of a straight move.
    Line([f64; 2], [f64; 2]),
    /// Start, end and centre of an arc, and whether it is counter-clockwise. It is a full turn if
    /// both ends are equal.
    Arc([f64; 2], [f64; 2], [f64; 2], bool),
}

/// Most programmed moves kept.
const MOST_IDEAL: usize = 20_000;

/// The picture of a run.
#[derive(Clone, Debug)]
pub struct Picture {
    /// The axes to the right and up.
    view: [usize; 2],
    path: Path,
    /// The path of the tool.
    pub drawing: Drawing,
    /// The programmed moves.
    pub ideal: Vec<Ideal>,
    /// Whether `ideal` has all programmed moves.
    pub ideal_is_whole: bool,
}

impl Picture {
    /// An empty picture with these axes to the right and up. The programmed path is known only in
    /// X, Y and Z. With other axes the picture shows only the path of the tool.
    pub fn new(view: [usize; 2]) -> Self {
        Self {
            view,
            path: Path::line([0.0; 3], [0.0; 3]),
            drawing: Drawing::default(),
            ideal: Vec::new(),
            ideal_is_whole: true,
        }
    }

    /// The point in the axes of the picture.
    #[inline]
    const fn flat(&self, at: [f64; AXES]) -> [f64; 2] {
        let [right, up] = self.view;
        [at[right], at[up]]
    }

    fn point(&self, now: &Now<'_>) -> Point {
        let mut ideal = now.tool_nm;
        for (ideal, nearest) in ideal.iter_mut().zip(self.path.nearest(now.place())) {
            *ideal = nearest;
        }
        Point {
            tool: self.flat(now.tool_nm),
            ideal: self.flat(ideal),
        }
    }

    /// Adds the point of a step. A new kind of move begins a new stroke.
    #[inline(never)]
    fn draw(&mut self, now: &Now<'_>) {
        let at = self.point(now);
        let class = if now.origin == Origin::Feed {
            Class::Feed
        } else {
            Class::Rapid
        };
        let last = self.drawing.strokes.last();
        if now.is_turn && last.is_none_or(|stroke| stroke.class != class) {
            self.drawing.begin(class, at);
        } else if self.drawing.wants(at.tool) {
            self.drawing.add(at);
        }
    }

    fn keep_ideal(&mut self, begun: &Begun<'_>) {
        if self.ideal.len() >= MOST_IDEAL {
            self.ideal_is_whole = false;
            return;
        }
        let flat = |p: [Nm; AXES]| self.flat(p.map(|Nm(nm)| nm as f64));
        let (from, to) = (flat(begun.segment.from), flat(begun.to));
        let [right, up] = self.view;
        let is_seen_flat = |axes: [usize; 2]| axes == [right, up] || axes == [up, right];
        match &begun.segment.command {
            Command::Linear { .. } | Command::Thread { .. } => {
                self.ideal.push(Ideal::Line(from, to));
            }
            Command::Arc { arc, .. } if is_seen_flat(arc.plane.axes()) => {
                let is_whole = arc.turns > 0 || from == to;
                let end = if is_whole { from } else { to };
                let is_counter_clockwise = arc.direction == Direction::CounterClockwise;
                // A view from behind reverses the direction.
                let is_from_behind = arc.plane.axes() != self.view;
                let seen = is_counter_clockwise != is_from_behind;
                self.ideal
                    .push(Ideal::Arc(from, end, flat(arc.centre), seen));
            }
            // An arc seen from the side: only the points of the drawing show it.
            Command::Arc { .. } => self.ideal_is_whole = false,
            _ => {}
        }
    }
}

impl Observer for Picture {
    fn begin(&mut self, begun: &Begun<'_>) {
        self.path = begun.path.clone();
        self.keep_ideal(begun);
    }

    #[inline]
    fn step(&mut self, now: &Now<'_>) -> io::Result<()> {
        if now.origin == Origin::TakeUp {
            if now.begins_take_up {
                self.drawing.take_up(self.flat(now.tool_nm));
            }
        } else if now.is_turn || self.drawing.wants(self.flat(now.tool_nm)) {
            self.draw(now);
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::observers::tests::{begun, line, now};

    #[test]
    fn strokes_take_ups_and_the_programmed_line_are_kept() {
        let mut picture = Picture::new([0, 1]);
        let (segment, path) = (line(Nm(9000)), Path::line([0.0; 3], [9000.0, 0.0, 0.0]));
        picture.begin(&begun(&segment, &path));
        for event in 1..=9 {
            let seen = Now {
                tool_nm: [1000.0 * event as f64, 70.0, 0.0, 0.0, 0.0, 0.0],
                ..now(event)
            };
            picture.step(&seen).unwrap();
        }
        let take_up = Now {
            origin: Origin::TakeUp,
            begins_take_up: true,
            ..now(9)
        };
        picture.step(&take_up).unwrap();
        let rapid = Now {
            origin: Origin::Rapid,
            is_turn: true,
            ..now(10)
        };
        picture.step(&rapid).unwrap();
        let [feed, rapid] = &picture.drawing.strokes[..] else {
            panic!("two strokes")
        };
        assert_eq!((feed.class, feed.points.len()), (Class::Feed, 9));
        let second = feed.points[1];
        assert_eq!((second.tool, second.ideal), ([2000.0, 70.0], [2000.0, 0.0]));
        assert_eq!((rapid.class, rapid.points.len()), (Class::Rapid, 1));
        assert_eq!(picture.drawing.take_ups, [[9000.0, 0.0]]);
        assert!(picture.ideal_is_whole);
        let [Ideal::Line([0.0, 0.0], [9000.0, 0.0])] = picture.ideal[..] else {
            panic!("one line")
        };
    }
}
