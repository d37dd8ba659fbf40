//! The exact path of a cubic curve, and the distance of a point from it.

use super::chords_length;
use husillo_gcode::{Nm, Spline};

/// A cubic curve in XY; Z stays where the curve ends.
#[derive(Clone, Debug)]
pub struct CurvePath {
    points: [[f64; 2]; 4],
    z: f64,
    /// Parameter of the last point.
    u: f64,
}

/// Parts of the curve for its length.
const PARTS: u32 = 4096;

impl CurvePath {
    /// The path of a spline.
    pub fn new<const N: usize>(spline: &Spline<N>) -> Self {
        let nm = |Nm(nm): Nm| nm as f64;
        Self {
            points: spline.points.map(|point| point.map(nm)),
            z: spline.to.get(2).map_or(0.0, |z| nm(*z)),
            u: 0.0,
        }
    }

    /// Position, and first and second derivative, at `u` from 0 to 1.
    fn at(&self, u: f64) -> [[f64; 2]; 3] {
        let v = 1.0 - u;
        let all = [0, 1].map(|axis: usize| {
            let [a, b, c, d] = self.points.map(|point| point[axis]);
            [
                v * v * v * a + 3.0 * v * v * u * b + 3.0 * v * u * u * c + u * u * u * d,
                3.0 * (v * v * (b - a) + 2.0 * v * u * (c - b) + u * u * (d - c)),
                6.0 * (v * (a - 2.0 * b + c) + u * (b - 2.0 * c + d)),
            ]
        });
        [0, 1, 2].map(|order: usize| [all[0][order], all[1][order]])
    }

    /// Square of the distance of a point in the plane from the curve at `u`.
    fn off(&self, p: [f64; 2], u: f64) -> f64 {
        let [[x, y], ..] = self.at(u);
        (x - p[0]) * (x - p[0]) + (y - p[1]) * (y - p[1])
    }

    /// Parameter of the nearest point, searched from `u` on.
    fn nearest_from(&self, p: [f64; 2], mut u: f64) -> f64 {
        let dot = |a: [f64; 2], b: [f64; 2]| a[0] * b[0] + a[1] * b[1];
        for _ in 0..4 {
            let [at, slope, bend] = self.at(u);
            let off = [at[0] - p[0], at[1] - p[1]];
            // The second derivative is left out where it would lead away from the nearest point.
            let full = dot(slope, slope) + dot(off, bend);
            let divisor = if full > 0.0 { full } else { dot(slope, slope) };
            if divisor == 0.0 {
                return u;
            }
            u = (u - dot(off, slope) / divisor).clamp(0.0, 1.0);
        }
        u
    }

    /// Square of the distance of `tool` from the curve. Points must come in order.
    pub fn distance_squared(&mut self, tool: &[f64; 3]) -> f64 {
        let p = [tool[0], tool[1]];
        let found = self.nearest_from(p, self.u);
        // In a cusp the curve stands still, so a search has to begin beyond it.
        let ahead = self.nearest_from(p, (self.u + 0.01).min(1.0));
        self.u = if self.off(p, ahead) < self.off(p, found) {
            ahead
        } else {
            found
        };
        let rise = tool[2] - self.z;
        self.off(p, self.u) + rise * rise
    }

    /// The point of the curve nearest to `tool`.
    pub fn nearest(&self, tool: [f64; 3]) -> [f64; 3] {
        let p = [tool[0], tool[1]];
        let u = (0..=16)
            .map(|part| self.nearest_from(p, f64::from(part) / 16.0))
            .min_by(|a, b| self.off(p, *a).total_cmp(&self.off(p, *b)));
        let [[x, y], ..] = self.at(u.unwrap_or(0.0));
        [x, y, self.z]
    }

    /// The point at a parameter from 0 to 1.
    pub fn place(&self, u: f64) -> [f64; 3] {
        let [[x, y], ..] = self.at(u);
        [x, y, self.z]
    }

    /// Length of the curve.
    pub fn length(&self) -> f64 {
        chords_length(PARTS, |part| self.at(f64::from(part) / f64::from(PARTS))[0])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_straight_curve_is_a_line() {
        let points = [[0, 0], [1000, 0], [2000, 0], [3000, 0]].map(|point| point.map(Nm));
        let mut curve = CurvePath::new(&Spline {
            to: [Nm(3000), Nm(0), Nm(7)],
            points,
        });
        assert!((curve.length() - 3000.0).abs() < 1e-6);
        for x in 0..=30 {
            let x = f64::from(x) * 100.0;
            assert!((curve.distance_squared(&[x, 3.0, 7.0]) - 9.0).abs() < 1e-6);
        }
        assert_eq!(curve.place(0.5), [1500.0, 0.0, 7.0]);
        assert_eq!(curve.nearest([-5.0, 1.0, 9.0]), [0.0, 0.0, 7.0]);
        assert!((curve.nearest([1234.0, 1.0, 9.0])[0] - 1234.0).abs() < 1e-6);
    }
}
