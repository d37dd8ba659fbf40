//! The directions in which the circles of table 15 were measured, and the squareness of the axes.

use super::circle::{Circle, DIRECTIONS};
use super::measured::CIRCLES;
use crate::least_squares::least_squares;
use crate::originals::Parameter;
use std::f64::consts::TAU;

/// The direction of D1, and the direction in which the others follow, 22.5 degrees apart.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Order {
    /// Direction of D1 from +X, in steps of 22.5 degrees.
    first: usize,
    is_clockwise: bool,
}

impl Order {
    /// Number of the direction of a diameter.
    pub const fn direction(self, index: usize) -> usize {
        const STEP: usize = DIRECTIONS / 16;
        let turn = if self.is_clockwise { 16 - index } else { index };
        (self.first + turn) % 16 * STEP
    }
}

/// The order of the diameters, and the squareness.
#[derive(Clone, Copy, Debug)]
pub struct Frame {
    pub order: Order,
    /// The error of squareness: the additional motion of X, divided by the distance along Y.
    pub skew: f64,
    /// The unexplained part of the diameters, mm (RMS).
    rms_mm: f64,
}

impl Frame {
    /// Finds the order, of all sixteen, and the squareness with the smallest unexplained part.
    pub fn fitted(made: &[Circle]) -> Self {
        let orders = (0..8).flat_map(|first| {
            [false, true].map(|is_clockwise| Order {
                first,
                is_clockwise,
            })
        });
        let frames = orders.map(|order| {
            let pairs = CIRCLES.iter().zip(made).flat_map(|(measured, circle)| {
                let straight = Frame {
                    order,
                    skew: 0.0,
                    rms_mm: 0.0,
                };
                let circle = circle.on(&straight, measured.radius_mm);
                (0..8).map(move |index| {
                    let angle = TAU * order.direction(index) as f64 / DIRECTIONS as f64;
                    let per_skew = measured.radius_mm * (2.0 * angle).sin();
                    let left = measured.diameters_mm[index] - circle.diameters_mm[index];
                    (per_skew, left)
                })
            });
            let pairs: Vec<(f64, f64)> = pairs.collect();
            let [skew] =
                least_squares(pairs.iter().map(|(a, b)| ([*a], *b)), [true]).unwrap_or_default();
            let squares = pairs.iter().map(|(a, b)| (b - skew * a).powi(2));
            Frame {
                order,
                skew,
                rms_mm: (squares.sum::<f64>() / pairs.len() as f64).sqrt(),
            }
        });
        let best = frames.min_by(|a, b| a.rms_mm.total_cmp(&b.rms_mm));
        best.unwrap_or_else(|| unreachable!("there are sixteen orders"))
    }

    pub fn parameters(&self) -> [Parameter; 2] {
        let direction = if self.order.is_clockwise {
            "clockwise"
        } else {
            "anticlockwise"
        };
        [
            Parameter::new(
                "directions of D1 to D8",
                format!(
                    "D1 at {} degrees from X, the others {direction}",
                    22.5 * self.order.first as f64
                ),
                "fitted: the best of all sixteen orders; the original states none",
            ),
            Parameter::new(
                "squareness",
                format!("{:.1} um of X per mm of Y", 1e3 * self.skew),
                "fitted to the 24 diameters",
            ),
        ]
    }
}
