//! One move on the bare integer grid, with all its steps and its error.

use crate::curve::Curve;
use crate::method::{AXES, Method, Shape};
use husillo_interp::{ArcMove, Rim};
use serde::Serialize;

/// The steps and the error of a move.
#[derive(Clone, Debug, Serialize)]
pub struct Walk {
    /// Passes of the loop of the method.
    pub iterations: usize,
    /// Passes with a step.
    pub moving: usize,
    /// Largest distance from the exact curve after a pass, steps.
    pub max_error_blu: f64,
    /// Root mean square of the distance, steps.
    pub rms_error_blu: f64,
    /// The end, steps.
    pub end: Vec<i64>,
    /// All steps.
    pub steps: Steps,
}

/// The steps: one character per iteration for two axes, one string per iteration for more.
#[derive(Clone, Debug, Serialize)]
#[serde(untagged)]
pub enum Steps {
    /// `3 (dx + 1) + dy + 1`: `0` is (-1, -1), `4` is (0, 0), `8` is (+1, +1).
    Code(String),
    /// `-`, `0` or `+` for each axis.
    Signs(Vec<String>),
}

impl Walk {
    /// Makes a line of this number of axes.
    ///
    /// # Errors
    ///
    /// Why the method cannot make it.
    pub fn line(method: &Method, delta: [i32; AXES], axes: usize) -> Result<Self, String> {
        let axes = axes.min(AXES);
        let curve = Curve::line([0.0; AXES], delta.map(f64::from));
        let mut at = [0; AXES];
        let mut record = Record::default();
        let (events, _) = method.events(&Shape::Line(delta))?;
        for step in events {
            let delta = step.deltas::<AXES>();
            for (at, delta) in at.iter_mut().zip(delta) {
                *at += i64::from(delta);
            }
            record.add(&delta[..axes], curve.distance(&at.map(|at| at as f64)));
        }
        Ok(record.finish(at[..axes].to_vec()))
    }

    /// Makes an arc. `radius` is that of its circle; `None` for a spiral.
    ///
    /// # Errors
    ///
    /// Why the method cannot make it.
    pub fn arc(method: &Method, arc: ArcMove, radius: Option<f64>) -> Result<Self, String> {
        let (events, _) = method.events(&Shape::Arc(arc))?;
        let one = (1_u64 << arc.fraction_bits) as f64;
        let distance = |p: [i32; 2]| {
            let [x, y] = [0, 1].map(|axis| {
                (i128::from(p[axis]) << arc.fraction_bits) - i128::from(arc.centre[axis])
            });
            (x as f64).hypot(y as f64) / one
        };
        let (start, end) = (distance(arc.from), distance(arc.to));
        let band = radius.map_or([start.min(end), start.max(end)], |radius| [radius; 2]);
        let mut at = arc.from;
        let mut record = Record::default();
        for step in events {
            let delta = step.deltas::<2>();
            for (at, delta) in at.iter_mut().zip(delta) {
                *at = at.wrapping_add(i32::from(delta));
            }
            let r = distance(at);
            record.add(&delta, (r - band[1]).max(band[0] - r).max(0.0));
        }
        Ok(record.finish(at.map(i64::from).to_vec()))
    }
}

/// The circle of a radius through points near it.
///
/// `radius_squared` is in units of 2^-2b steps², with b the fraction bits of the arc. `None` if it
/// does not fit its ends.
pub fn nominal(arc: &ArcMove, radius_squared: u128) -> Option<Rim> {
    let residue = |p: [i32; 2]| {
        let square: i128 = [0, 1]
            .map(|axis| (i128::from(p[axis]) << arc.fraction_bits) - i128::from(arc.centre[axis]))
            .iter()
            .map(|distance| distance * distance)
            .sum();
        let residue = (square - i128::try_from(radius_squared).ok()?) >> arc.fraction_bits;
        i64::try_from(residue).ok()
    };
    Some(Rim::Nominal {
        start: residue(arc.from)?,
        end: residue(arc.to)?,
    })
}

#[derive(Default)]
struct Record {
    steps: Vec<Vec<i8>>,
    moving: usize,
    largest: f64,
    sum_of_squares: f64,
}

impl Record {
    fn add(&mut self, delta: &[i8], error: f64) {
        self.steps.push(delta.to_vec());
        self.moving += usize::from(delta.iter().any(|d| *d != 0));
        self.largest = self.largest.max(error);
        self.sum_of_squares += error * error;
    }

    fn finish(self, end: Vec<i64>) -> Walk {
        let steps = if end.len() == 2 {
            Steps::Code(self.steps.iter().map(|delta| code(delta)).collect())
        } else {
            Steps::Signs(self.steps.iter().map(|delta| signs(delta)).collect())
        };
        let count = self.steps.len();
        Walk {
            iterations: count,
            moving: self.moving,
            max_error_blu: self.largest,
            rms_error_blu: (self.sum_of_squares / count.max(1) as f64).sqrt(),
            end,
            steps,
        }
    }
}

/// The code of a step: 3 (dx + 1) + dy + 1. `0` is (-1, -1), `4` is (0, 0), `8` is (+1, +1).
fn code(delta: &[i8]) -> char {
    let digit = delta.iter().fold(0, |code, d| code * 3 + (d + 1) as u8);
    char::from(b'0' + digit)
}

fn signs(delta: &[i8]) -> String {
    delta
        .iter()
        .map(|d| ['-', '0', '+'][(d + 1) as usize])
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::comparison::Move;
    use crate::method::{ARCS, by_name};
    use husillo_interp::Direction;

    #[test]
    fn a_circle_of_thirty_steps_has_the_known_errors() {
        for (method, iterations, moving, largest) in [
            ("direct-search", 168, 168, 0.453),
            ("direct-search-printed", 168, 168, 0.453),
            ("dda-printed", 188, 180, 0.887),
            ("staircase-printed", 240, 240, 0.983),
        ] {
            let Shape::Arc(circle) = Move::circle(30, Direction::CounterClockwise).shape else {
                panic!("a circle is an arc")
            };
            let walk = Walk::arc(by_name(&ARCS, method, "arcs").unwrap(), circle, None).unwrap();
            assert_eq!(
                (walk.iterations, walk.moving),
                (iterations, moving),
                "{method}"
            );
            assert_eq!(walk.end, [30, 0]);
            assert!((walk.max_error_blu - largest).abs() < 5e-4, "{method}");
        }
    }
}
