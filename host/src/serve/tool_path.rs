//! The path of the tool of a machine whose controller reports each step.

use serde::Serialize;
use std::collections::VecDeque;
use std::sync::{Mutex, MutexGuard, PoisonError};

/// Points that are kept: 100 mm at least.
const KEPT: usize = 50_000;
/// Points in one frame.
const IN_A_FRAME: usize = 2000;
/// A point is kept when the tool is this far from the last one, nm.
const APART_NM: i64 = 2000;

/// Why the tool moves. Each has its colour in the picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Motion {
    /// Nothing is drawn: the path begins here.
    Begin = -1,
    /// A jog, or steps by hand.
    Jog = 0,
    /// A rapid, or homing.
    Rapid = 1,
    /// A line or an arc at a feed.
    Feed = 2,
}

/// A point of the path: the motion that has led there, and its place in nm from machine zero, or
/// from where the controller was switched on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct Point(i64, i64, i64, i64);

/// The path of a tool.
#[derive(Debug, Default)]
pub struct ToolPath(Mutex<Kept>);

#[derive(Debug, Default)]
struct Kept {
    /// Grows when all points get other places.
    generation: u64,
    /// Number of the first kept point.
    first: u64,
    points: VecDeque<Point>,
}

/// What a client has of a path.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct PathSeen {
    generation: u64,
    /// Number of the next point.
    next: u64,
}

/// Points for a client.
#[derive(Debug)]
pub struct Part {
    /// Number of the first one. 0: the path begins again.
    pub from: u64,
    /// The points.
    pub points: Vec<Point>,
}

impl ToolPath {
    /// The tool is here, nm. Returns whether a point was added.
    pub fn to(&self, motion: Motion, at: [i64; 3]) -> bool {
        let mut kept = self.kept();
        let [x, y, z] = at;
        let point = Point(motion as i64, x, y, z);
        let is_near = kept.points.back().is_some_and(|last| {
            let apart = [last.1 - x, last.2 - y, last.3 - z];
            last.0 == point.0 && apart.iter().all(|nm| nm.abs() < APART_NM)
        });
        if is_near {
            return false;
        }
        if kept.points.len() == KEPT {
            kept.points.pop_front();
            kept.first += 1;
        }
        kept.points.push_back(point);
        true
    }

    /// Moves all points by a distance, nm: the place of machine zero has become known.
    pub fn shift(&self, by: [i64; 3]) {
        let mut kept = self.kept();
        for point in &mut kept.points {
            *point = Point(point.0, point.1 + by[0], point.2 + by[1], point.3 + by[2]);
        }
        kept.generation += 1;
    }

    /// The points that a client has not seen, as many as a frame has.
    pub fn after(&self, seen: &mut PathSeen) -> Option<Part> {
        let kept = self.kept();
        if !kept.is_news(*seen) {
            return None;
        }
        let is_other = seen.generation != kept.generation || seen.next < kept.first;
        let from = if is_other { kept.first } else { seen.next };
        let skipped = usize::try_from(from - kept.first).unwrap_or(usize::MAX);
        let points = kept.points.iter().skip(skipped).take(IN_A_FRAME);
        let points: Vec<_> = points.copied().collect();
        *seen = PathSeen {
            generation: kept.generation,
            next: from + points.len() as u64,
        };
        Some(Part {
            from: if is_other { 0 } else { from },
            points,
        })
    }

    /// Whether there are points that a client has not seen.
    pub fn has_more(&self, seen: PathSeen) -> bool {
        self.kept().is_news(seen)
    }

    fn kept(&self) -> MutexGuard<'_, Kept> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Kept {
    fn is_news(&self, seen: PathSeen) -> bool {
        let end = self.first + self.points.len() as u64;
        seen.generation != self.generation || seen.next < end
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_client_gets_the_points_that_it_has_not_seen() {
        let path = ToolPath::default();
        let mut seen = PathSeen::default();
        assert!(path.after(&mut seen).is_none());
        assert!(path.to(Motion::Begin, [0; 3]) && path.to(Motion::Jog, [140, 0, 0]));
        assert!(!path.to(Motion::Jog, [1400, 0, 0]), "too near");
        assert!(path.to(Motion::Feed, [1400, 0, 0]), "another colour");
        let part = path.after(&mut seen).unwrap();
        assert_eq!((part.from, part.points.len()), (0, 3));
        assert!(!path.has_more(seen));
        path.to(Motion::Feed, [1400, -9000, 0]);
        let part = path.after(&mut seen).unwrap();
        assert_eq!(
            (part.from, part.points),
            (3, vec![Point(2, 1400, -9000, 0)])
        );
    }

    #[test]
    fn after_homing_all_points_come_again() {
        let path = ToolPath::default();
        let mut seen = PathSeen::default();
        for step in 0..3000 {
            path.to(Motion::Rapid, [0, 0, step * APART_NM]);
        }
        assert_eq!(path.after(&mut seen).unwrap().points.len(), 2000);
        path.shift([5, 6, 7]);
        let part = path.after(&mut seen).unwrap();
        assert_eq!((part.from, part.points[0]), (0, Point(1, 5, 6, 7)));
        assert_eq!(path.after(&mut seen).unwrap().points.len(), 1000);
    }

    #[test]
    fn the_oldest_points_are_dropped() {
        let path = ToolPath::default();
        let mut seen = PathSeen::default();
        for step in 0..=KEPT as i64 {
            path.to(Motion::Feed, [step * APART_NM, 0, 0]);
        }
        let part = path.after(&mut seen).unwrap();
        assert_eq!((part.from, part.points[0].1), (0, APART_NM));
        assert_eq!(seen.next, 2001);
    }
}
