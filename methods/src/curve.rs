//! The exact curve of one move on the grid: distances from it and progress along it. All lengths
//! are in BLU.

use crate::method::AXES;
use husillo_interp::{ArcMove, Direction};
use husillo_sim::geometry::turn;
use std::f64::consts::TAU;

/// The curve of a move.
#[derive(Clone, Debug)]
pub enum Curve {
    /// A straight line.
    Line {
        /// Start.
        from: [f64; AXES],
        /// Unit vector.
        along: [f64; AXES],
        /// Length.
        length: f64,
    },
    /// A circle in the first two axes. A spiral is the band between its radii.
    Arc {
        /// Centre.
        centre: [f64; 2],
        /// Smallest and largest radius.
        radii: [f64; 2],
        /// Angle of the start.
        begin: f64,
        /// Angle swept, positive counter-clockwise.
        sweep: f64,
    },
}

impl Curve {
    /// A straight move.
    pub fn line(from: [f64; AXES], to: [f64; AXES]) -> Self {
        let delta: [f64; AXES] = std::array::from_fn(|axis| to[axis] - from[axis]);
        let length = delta.iter().map(|d| d * d).sum::<f64>().sqrt();
        Self::Line {
            from,
            along: delta.map(|d| if length > 0.0 { d / length } else { 0.0 }),
            length,
        }
    }

    /// An arc; a full circle if `from` is `to`. `radius` replaces the band between the radii of the
    /// ends.
    pub fn arc(
        [from, to, centre]: [[f64; 2]; 3],
        direction: Direction,
        turns: u32,
        radius: Option<f64>,
    ) -> Self {
        let vector = |p: [f64; 2]| [p[0] - centre[0], p[1] - centre[1]];
        let (start, end) = (vector(from), vector(to));
        let radii = [start[0].hypot(start[1]), end[0].hypot(end[1])];
        let begin = turn::angle(from, centre);
        let last = if from == to {
            begin
        } else {
            turn::angle(to, centre)
        };
        let is_forward = direction == Direction::CounterClockwise;
        let sweep = turn::sweep(begin, last, is_forward) + TAU * f64::from(turns);
        Self::Arc {
            centre,
            radii: radius.map_or([radii[0].min(radii[1]), radii[0].max(radii[1])], |r| [r, r]),
            begin,
            sweep: match direction {
                Direction::CounterClockwise => sweep,
                Direction::Clockwise => -sweep,
            },
        }
    }

    /// The exact curve of an arc on the grid, with `radius` as in [`Curve::arc`].
    pub fn of(arc: &ArcMove, radius: Option<f64>) -> Self {
        let one = (1_u64 << arc.fraction_bits) as f64;
        Self::arc(
            [
                arc.from.map(f64::from),
                arc.to.map(f64::from),
                arc.centre.map(|at| at as f64 / one),
            ],
            arc.direction,
            arc.turns,
            radius,
        )
    }

    /// Length of the path.
    pub fn length(&self) -> f64 {
        match self {
            Self::Line { length, .. } => *length,
            Self::Arc { radii, sweep, .. } => 0.5 * (radii[0] + radii[1]) * sweep.abs(),
        }
    }

    /// Distance of a point: perpendicular to a line, radial to an arc. It is 0 within the band of a
    /// spiral.
    pub fn distance(&self, at: &[f64; AXES]) -> f64 {
        match self {
            Self::Line { from, along, .. } => {
                let delta: [f64; AXES] = std::array::from_fn(|axis| at[axis] - from[axis]);
                let part: f64 = delta.iter().zip(along).map(|(p, a)| p * a).sum();
                delta
                    .iter()
                    .zip(along)
                    .map(|(p, a)| (p - part * a).powi(2))
                    .sum::<f64>()
                    .sqrt()
            }
            Self::Arc { centre, radii, .. } => {
                let r = (at[0] - centre[0]).hypot(at[1] - centre[1]);
                (r - radii[1]).max(radii[0] - r).max(0.0)
            }
        }
    }

    /// Progress of a step along the path.
    pub fn progress(&self, from: &[f64; AXES], to: &[f64; AXES]) -> f64 {
        match self {
            Self::Line { along, .. } => (0..AXES)
                .map(|axis| (to[axis] - from[axis]) * along[axis])
                .sum(),
            Self::Arc {
                centre,
                radii,
                sweep,
                ..
            } => {
                let vector = |p: &[f64; AXES]| [p[0] - centre[0], p[1] - centre[1]];
                let ([ax, ay], [bx, by]) = (vector(from), vector(to));
                let turned = (ax * by - ay * bx).atan2(ax * bx + ay * by);
                turned * sweep.signum() * 0.5 * (radii[0] + radii[1])
            }
        }
    }

    /// The point at a part of the path, 0 to 1, in the first two axes.
    pub fn at(&self, part: f64) -> [f64; 2] {
        match self {
            Self::Line {
                from,
                along,
                length,
            } => [0, 1].map(|axis| from[axis] + along[axis] * length * part),
            Self::Arc {
                centre,
                radii,
                begin,
                sweep,
            } => {
                let radius = 0.5 * (radii[0] + radii[1]);
                let angle = begin + sweep * part;
                [
                    centre[0] + radius * angle.cos(),
                    centre[1] + radius * angle.sin(),
                ]
            }
        }
    }

    /// The part of the path nearest to a point.
    pub fn part(&self, at: [f64; 2]) -> f64 {
        match self {
            Self::Line {
                from,
                along,
                length,
            } => {
                let plane = along[0] * along[0] + along[1] * along[1];
                let part = (at[0] - from[0]) * along[0] + (at[1] - from[1]) * along[1];
                (part / (plane * length).max(1e-9)).clamp(0.0, 1.0)
            }
            Self::Arc {
                centre,
                begin,
                sweep,
                ..
            } => {
                let turned = turn::turned(*begin, turn::angle(at, *centre), *sweep > 0.0);
                // A point just before the start belongs to the start.
                let turned = if turned > 0.5 * (TAU + sweep.abs()) {
                    0.0
                } else {
                    turned
                };
                (turned / sweep.abs()).min(1.0)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_quarter_circle_has_its_length_and_ends() {
        let arc = Curve::arc(
            [[10.0, 0.0], [0.0, 10.0], [0.0; 2]],
            Direction::CounterClockwise,
            0,
            None,
        );
        assert!((arc.length() - 15.708).abs() < 1e-3);
        assert!((arc.part([1.0, 1.0]) - 0.5).abs() < 1e-12);
        assert_eq!((arc.part([1.0, -0.1]), arc.part([-0.1, 1.0])), (0.0, 1.0));
        let back = Curve::arc(
            [[10.0, 0.0], [0.0, 10.0], [0.0; 2]],
            Direction::Clockwise,
            0,
            None,
        );
        assert!((back.length() - 47.124).abs() < 1e-3);
        assert!((back.at(1.0 / 3.0)[1] + 10.0).abs() < 1e-9);
    }

    #[test]
    fn distance_and_progress_along_a_line() {
        let line = Curve::line([0.0; AXES], [3.0, 4.0, 0.0, 0.0, 0.0, 0.0]);
        assert_eq!(line.length(), 5.0);
        assert!((line.distance(&[4.0, -3.0, 0.0, 0.0, 0.0, 12.0]) - 13.0).abs() < 1e-9);
        let step = line.progress(&[0.0; AXES], &[1.0, 1.0, 0.0, 0.0, 0.0, 0.0]);
        assert!((step - 1.4).abs() < 1e-12);
    }
}
