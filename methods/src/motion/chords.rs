//! Geometry of moves in floating point, and arcs as chords.

use husillo_gcode::{Command, Direction};
use husillo_machine::Segment;
use std::f64::consts::{PI, TAU};

/// The shape of a move: its directions at both ends, and its radius.
#[derive(Clone, Copy, Debug)]
pub struct Turn<const N: usize> {
    /// Direction at the start, a unit vector.
    pub first: [f64; N],
    /// Direction at the end.
    pub last: [f64; N],
    /// Radius in mm, infinite for a line.
    pub radius: f64,
}

/// A move as chords of equal length.
#[derive(Clone, Debug)]
pub struct Chords<const N: usize> {
    /// The directions of the chords.
    pub directions: Vec<[f64; N]>,
    /// Length of a chord in mm.
    pub length: f64,
    /// Radius of the move in mm, infinite for a line.
    pub radius: f64,
}

/// Millimetres of a nanometre.
pub(crate) const MM: f64 = 1e-6;

/// An arc in its plane.
struct Circle<const N: usize> {
    plane: [usize; 2],
    radius: f64,
    /// Angle of the start, and the signed angle to the end.
    start: f64,
    sweep: f64,
    /// Motion across the plane, in mm.
    across: [f64; N],
}

impl<const N: usize> Circle<N> {
    fn of(segment: &Segment<N>) -> Option<Circle<N>> {
        let Command::Arc { arc, .. } = &segment.command else {
            return None;
        };
        let plane = arc.plane.axes();
        let spoke = |point: &[husillo_gcode::Nm; N]| {
            plane.map(|axis| (point[axis].0 - arc.centre[axis].0) as f64 * MM)
        };
        let [from, to] = [spoke(&segment.from), spoke(&arc.to)];
        let [start, end] = [from, to].map(|spoke| spoke[1].atan2(spoke[0]));
        let mut sweep = match arc.direction {
            Direction::CounterClockwise => (end - start).rem_euclid(TAU),
            Direction::Clockwise => -(start - end).rem_euclid(TAU),
        };
        if sweep.abs() < 1e-9 {
            sweep = TAU.copysign(match arc.direction {
                Direction::CounterClockwise => 1.0,
                Direction::Clockwise => -1.0,
            });
        }
        sweep += TAU.copysign(sweep) * f64::from(arc.turns);
        let across = std::array::from_fn(|axis| {
            if plane.contains(&axis) {
                0.0
            } else {
                (arc.to[axis].0 - segment.from[axis].0) as f64 * MM
            }
        });
        Some(Circle {
            plane,
            radius: (from[0].hypot(from[1]) + to[0].hypot(to[1])) / 2.0,
            start,
            sweep,
            across,
        })
    }

    /// The direction at a part of the arc, 0 to 1.
    fn direction(&self, part: f64) -> [f64; N] {
        let angle = self.start + self.sweep * part + PI / 2.0_f64.copysign(self.sweep);
        let around = self.radius * self.sweep.abs();
        let mut way = self.across;
        way[self.plane[0]] = around * angle.cos();
        way[self.plane[1]] = around * angle.sin();
        unit(way)
    }

    fn length(&self) -> f64 {
        let across: f64 = self.across.iter().map(|way| way * way).sum();
        (self.radius * self.sweep).hypot(across.sqrt())
    }

    /// Radius of a helix: that of its curvature.
    fn bend(&self) -> f64 {
        let slope = self.length() / (self.radius * self.sweep.abs());
        self.radius * slope * slope
    }
}

impl<const N: usize> Turn<N> {
    pub(crate) fn of(segment: &Segment<N>) -> Turn<N> {
        match Circle::of(segment) {
            Some(circle) => Turn {
                first: circle.direction(0.0),
                last: circle.direction(1.0),
                radius: circle.bend(),
            },
            None => {
                let (way, _) = straight(segment);
                Turn {
                    first: way,
                    last: way,
                    radius: f64::INFINITY,
                }
            }
        }
    }
}

impl<const N: usize> Chords<N> {
    /// The chords of a move; `count` gives their number from the length in the plane and the radius
    /// of an arc.
    pub(crate) fn of(segment: &Segment<N>, count: impl Fn(f64, f64) -> f64) -> Chords<N> {
        let Some(circle) = Circle::of(segment) else {
            let (way, length) = straight(segment);
            return Chords {
                directions: vec![way],
                length,
                radius: f64::INFINITY,
            };
        };
        let number = count(circle.radius * circle.sweep.abs(), circle.radius).max(1.0);
        let half = circle.sweep.abs() / number / 2.0;
        // A chord is shorter than its arc.
        let shorter = if half > 0.0 { half.sin() / half } else { 1.0 };
        Chords {
            directions: (0..number as usize)
                .map(|chord| circle.direction((chord as f64 + 0.5) / number))
                .collect(),
            length: circle.length() / number * shorter.abs(),
            radius: circle.bend(),
        }
    }
}

/// Direction of a line, and its length.
fn straight<const N: usize>(segment: &Segment<N>) -> ([f64; N], f64) {
    let to = segment.command.end().unwrap_or(segment.from);
    let way: [f64; N] = std::array::from_fn(|axis| (to[axis].0 - segment.from[axis].0) as f64 * MM);
    (unit(way), size(&way))
}

fn size(way: &[f64]) -> f64 {
    way.iter().map(|part| part * part).sum::<f64>().sqrt()
}

fn unit<const N: usize>(way: [f64; N]) -> [f64; N] {
    let size = size(&way);
    if size > 0.0 {
        way.map(|part| part / size)
    } else {
        way
    }
}

/// Length of the change from one direction to another.
pub(crate) fn change(before: &[f64], after: &[f64]) -> f64 {
    let parts = before.iter().zip(after);
    parts.map(|(a, b)| (b - a).powi(2)).sum::<f64>().sqrt()
}

/// Cosine between two directions.
pub(crate) fn cosine(before: &[f64], after: &[f64]) -> f64 {
    before.iter().zip(after).map(|(a, b)| a * b).sum()
}
