//! The exact programmed path of a move, and the distance of a point from it. It is cheap enough for
//! every step.
//!
//! Lengths are in nanometres as `f64`. Products stay below 2^53 * 2^-10 for moves up to 1 m. So the
//! rounding is far below a picometre. It cannot be taken for an error of the integer path that is
//! measured.

use super::curve::CurvePath;
use super::nurbs::NurbsPath;
use super::turn;
use husillo_gcode::{Command, Direction, Nm};
use std::f64::consts::TAU;

/// The exact programmed path of one move.
#[derive(Clone, Debug)]
pub enum Path {
    /// A straight line.
    Line {
        /// Start.
        from: [f64; 3],
        /// Unit vector.
        along: [f64; 3],
        /// Length.
        length: f64,
    },
    /// A circle or helix.
    Arc(ArcPath),
    /// A cubic curve.
    Curve(CurvePath),
    /// A NURBS.
    Nurbs(NurbsPath),
}

/// An arc in a plane. A helix also has a linear motion perpendicular to the plane.
#[derive(Clone, Debug)]
pub struct ArcPath {
    /// Axes of the plane.
    pub plane: [usize; 2],
    /// The axis perpendicular to the plane.
    pub across: usize,
    /// Centre in the plane.
    pub centre: [f64; 2],
    /// Start and end.
    pub ends: [[f64; 3]; 2],
    /// Smallest and largest radius of the path; equal for a circle.
    pub radii: [f64; 2],
    /// Swept angle, positive counter-clockwise, in radians.
    pub sweep: f64,
    turned: f64,
    last_angle: f64,
}

impl Path {
    /// A straight move.
    pub fn line(from: [f64; 3], to: [f64; 3]) -> Self {
        let delta = subtract(to, from);
        let length = dot(delta, delta).sqrt();
        let along = if length > 0.0 {
            delta.map(|d| d / length)
        } else {
            [0.0; 3]
        };
        Self::Line {
            from,
            along,
            length,
        }
    }

    /// A circular move. `radius` is the radius of a circle; `None` means the band between the radii
    /// of its ends.
    pub fn arc(
        plane: [usize; 2],
        from: [f64; 3],
        to: [f64; 3],
        centre: [f64; 2],
        counter_clockwise: bool,
        turns: u32,
        radius: Option<f64>,
    ) -> Self {
        let at = |p: [f64; 3]| [p[plane[0]] - centre[0], p[plane[1]] - centre[1]];
        let (start, end) = (at(from), at(to));
        let (r_start, r_end) = (start[0].hypot(start[1]), end[0].hypot(end[1]));
        let angles = [start, end].map(|spoke| turn::angle(spoke, [0.0; 2]));
        let first = turn::sweep(angles[0], angles[1], counter_clockwise);
        let sweep = (first + TAU * f64::from(turns)) * if counter_clockwise { 1.0 } else { -1.0 };
        Self::Arc(ArcPath {
            plane,
            across: 3 - plane[0] - plane[1],
            centre,
            ends: [from, to],
            radii: radius.map_or([r_start.min(r_end), r_start.max(r_end)], |radius| {
                [radius, radius]
            }),
            sweep,
            turned: 0.0,
            last_angle: angles[0],
        })
    }

    /// The path of a command in X, Y and Z, if it moves. An arc whose radii differ by at most
    /// `half_step` is a circle, otherwise it is a spiral.
    pub fn programmed<const N: usize>(
        from: [Nm; N],
        command: &Command<N>,
        half_step: f64,
    ) -> Option<Self> {
        let nm = |p: [Nm; N]| [0, 1, 2].map(|axis| p.get(axis).map_or(0.0, |at| at.0 as f64));
        match command {
            Command::Rapid { to }
            | Command::Linear { to, .. }
            | Command::Thread { to, .. }
            | Command::Probe { to, .. } => Some(Self::line(nm(from), nm(*to))),
            Command::Spline { spline, .. } => Some(Self::Curve(CurvePath::new(spline))),
            Command::Arc { arc, .. } => {
                let plane = arc.plane.axes();
                let (start, centre) = (nm(from), nm(arc.centre));
                let centre = plane.map(|axis| centre[axis]);
                let exact = (start[plane[0]] - centre[0]).hypot(start[plane[1]] - centre[1]);
                let circle = arc.mismatch.0 as f64 <= half_step;
                let radius =
                    circle.then_some(arc.radius.map_or(exact, |radius| (radius.0 as f64).abs()));
                let counter_clockwise = arc.direction == Direction::CounterClockwise;
                Some(Self::arc(
                    plane,
                    start,
                    nm(arc.to),
                    centre,
                    counter_clockwise,
                    arc.turns,
                    radius,
                ))
            }
            _ => None,
        }
    }

    /// Length of the path in nanometres.
    pub fn length(&self) -> f64 {
        match self {
            Self::Line { length, .. } => *length,
            Self::Arc(arc) => {
                let radius = 0.5 * (arc.radii[0] + arc.radii[1]);
                (arc.sweep * radius).hypot(arc.ends[1][arc.across] - arc.ends[0][arc.across])
            }
            Self::Curve(curve) => curve.length(),
            Self::Nurbs(curve) => curve.length(),
        }
    }

    /// Returns the square of the distance from `tool` to the path. Points of a helix must come in
    /// order.
    ///
    /// `tool` is a reference for speed. A copy would read the point as a whole right after it was
    /// written in parts, and the processor would wait for these writes.
    #[inline]
    pub fn distance_squared(&mut self, tool: &[f64; 3]) -> f64 {
        match self {
            Self::Line {
                from,
                along,
                length,
            } => {
                let p = subtract(*tool, *from);
                let t = dot(p, *along);
                if t < 0.0 || t > *length {
                    let beyond = t.clamp(0.0, *length);
                    let rest = subtract(p, along.map(|a| a * beyond));
                    return dot(rest, rest);
                }
                // The cross product instead of |p|^2 - t^2: the difference of two large squares
                // would lose the nanometres.
                let cross = [
                    p[1] * along[2] - p[2] * along[1],
                    p[2] * along[0] - p[0] * along[2],
                    p[0] * along[1] - p[1] * along[0],
                ];
                dot(cross, cross)
            }
            Self::Arc(arc) => arc.distance_squared(tool),
            Self::Curve(curve) => curve.distance_squared(tool),
            Self::Nurbs(curve) => curve.distance_squared(tool),
        }
    }

    /// Returns the nearest point of the path.
    pub fn nearest(&self, tool: [f64; 3]) -> [f64; 3] {
        match self {
            Self::Line {
                from,
                along,
                length,
            } => {
                let t = dot(subtract(tool, *from), *along).clamp(0.0, *length);
                [0, 1, 2].map(|axis| from[axis] + along[axis] * t)
            }
            Self::Arc(arc) => {
                let p = arc.vector(&tool);
                let r = p[0].hypot(p[1]);
                if r == 0.0 || !arc.covers(p) {
                    return arc.nearest_end(&tool);
                }
                let scale = r.clamp(arc.radii[0], arc.radii[1]) / r;
                let mut nearest = tool;
                nearest[arc.plane[0]] = arc.centre[0] + p[0] * scale;
                nearest[arc.plane[1]] = arc.centre[1] + p[1] * scale;
                nearest
            }
            Self::Curve(curve) => curve.nearest(tool),
            Self::Nurbs(curve) => curve.nearest(tool),
        }
    }
}

impl ArcPath {
    fn vector(&self, p: &[f64; 3]) -> [f64; 2] {
        [
            p[self.plane[0]] - self.centre[0],
            p[self.plane[1]] - self.centre[1],
        ]
    }

    /// The distance of a radius from the band. It does not use `f64::max`, which is slower because
    /// it also handles NaN.
    #[inline]
    fn outside(&self, r: f64) -> f64 {
        if r > self.radii[1] {
            r - self.radii[1]
        } else if r < self.radii[0] {
            self.radii[0] - r
        } else {
            0.0
        }
    }

    /// Whether the arc passes the direction of `p` from the centre.
    #[inline]
    fn covers(&self, p: [f64; 2]) -> bool {
        if self.sweep.abs() >= std::f64::consts::TAU - 1e-9 {
            return true;
        }
        let sign = self.sweep.signum();
        let (start, end) = (self.vector(&self.ends[0]), self.vector(&self.ends[1]));
        let after_start = sign * (start[0] * p[1] - start[1] * p[0]) >= 0.0;
        let before_end = sign * (p[0] * end[1] - p[1] * end[0]) >= 0.0;
        if self.sweep.abs() <= std::f64::consts::PI {
            after_start && before_end
        } else {
            after_start || before_end
        }
    }

    fn nearest_end(&self, tool: &[f64; 3]) -> [f64; 3] {
        let square = |end: [f64; 3]| dot(subtract(*tool, end), subtract(*tool, end));
        let [start, end] = self.ends;
        if square(start) < square(end) {
            start
        } else {
            end
        }
    }

    #[inline]
    fn distance_squared(&mut self, tool: &[f64; 3]) -> f64 {
        let p = self.vector(tool);
        let r = (p[0] * p[0] + p[1] * p[1]).sqrt();
        let rise = self.ends[1][self.across] - self.ends[0][self.across];
        if rise == 0.0 {
            if !self.covers(p) {
                let rest = subtract(*tool, self.nearest_end(tool));
                return dot(rest, rest);
            }
            let radial = self.outside(r);
            let across = tool[self.across] - self.ends[0][self.across];
            return radial * radial + across * across;
        }
        // A helix: the angle turned so far gives the position along it.
        let angle = p[1].atan2(p[0]);
        let mut turned = angle - self.last_angle;
        if turned > std::f64::consts::PI {
            turned -= std::f64::consts::TAU;
        } else if turned < -std::f64::consts::PI {
            turned += std::f64::consts::TAU;
        }
        self.last_angle = angle;
        self.turned += turned;
        let part = (self.turned / self.sweep).clamp(0.0, 1.0);
        let across = tool[self.across] - (self.ends[0][self.across] + rise * part);
        let radial = self.outside(r);
        // The helix has a slope, so the perpendicular distance is shorter than the one along the
        // axis.
        let slope = rise / (self.sweep * r.max(1.0));
        radial * radial + across * across / (1.0 + slope * slope)
    }
}

#[inline]
fn subtract(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

#[inline]
fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distances_beyond_the_ends_of_a_line() {
        let mut line = Path::line([0.0; 3], [100.0, 0.0, 0.0]);
        assert_eq!(line.distance_squared(&[50.0, 3.0, 4.0]), 25.0);
        assert_eq!(line.distance_squared(&[-3.0, 4.0, 0.0]), 25.0);
        assert_eq!(line.distance_squared(&[103.0, 0.0, 4.0]), 25.0);
        assert_eq!(line.nearest([50.0, 3.0, 4.0]), [50.0, 0.0, 0.0]);
    }

    #[test]
    fn distances_beyond_the_ends_of_an_arc() {
        let mut arc = Path::arc(
            [0, 1],
            [100.0, 0.0, 0.0],
            [0.0, 100.0, 0.0],
            [0.0; 2],
            true,
            0,
            Some(100.0),
        );
        assert!((arc.distance_squared(&[60.0, 81.0, 0.0]).sqrt() - 0.8016).abs() < 1e-3);
        assert_eq!(arc.distance_squared(&[100.0, -7.0, 0.0]), 49.0);
        assert_eq!(arc.distance_squared(&[-7.0, 100.0, 0.0]), 49.0);
        assert!((arc.length() - 157.0796).abs() < 1e-3);
    }

    #[test]
    fn a_clockwise_arc_covers_the_other_three_quarters() {
        let mut arc = Path::arc(
            [0, 1],
            [100.0, 0.0, 0.0],
            [0.0, 100.0, 0.0],
            [0.0; 2],
            false,
            0,
            Some(100.0),
        );
        assert!(arc.distance_squared(&[-60.0, -80.0, 0.0]) < 1e-20);
        assert!(arc.distance_squared(&[60.0, 80.0, 0.0]) > 1.0);
    }

    #[test]
    fn points_of_a_helix_have_no_distance() {
        let mut arc = Path::arc(
            [0, 1],
            [100.0, 0.0, 0.0],
            [100.0, 0.0, 40.0],
            [0.0; 2],
            true,
            1,
            Some(100.0),
        );
        for k in 1..=400 {
            let angle = f64::from(k) / 400.0 * 2.0 * std::f64::consts::TAU;
            let tool = [
                100.0 * angle.cos(),
                100.0 * angle.sin(),
                40.0 * f64::from(k) / 400.0,
            ];
            assert!(arc.distance_squared(&tool) < 1e-16);
        }
    }
}
