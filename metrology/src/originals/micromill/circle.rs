//! A circle that is cut, and its radii.

use super::MIDDLE_MM;
use super::cutting::{approach, cut};
use super::frame::Frame;
use crate::calibration::backlash::{Bench, Moment};
use std::f64::consts::{FRAC_1_SQRT_2, PI, TAU};

/// Angle from an end of a circle to the point at which the backlash is read, radians. There the nut
/// is on its new flank: 50 um of backlash are 10 degrees at a radius of 3 mm.
const BEHIND: f64 = 20.0 * PI / 180.0;

/// A circle that was cut.
#[derive(Clone, Debug)]
pub struct Circle {
    /// Its diameters D1 to D8, mm.
    pub diameters_mm: [f64; 8],
    /// Backlash that remained at the ends left, right, top, bottom, um.
    pub ends_um: [f64; 4],
    /// Time, min.
    pub minutes: f64,
    /// Radii of the cut at every half degree from +X anticlockwise, mm.
    pub radii_mm: Vec<f64>,
}

/// Directions of radii per turn.
pub const DIRECTIONS: usize = 720;

impl Circle {
    /// Mean of the diameters, mm, and their standard deviation, um.
    #[must_use]
    pub fn mean_and_sigma(&self) -> (f64, f64) {
        let mean = self.diameters_mm.iter().sum::<f64>() / 8.0;
        let squares = self.diameters_mm.iter().map(|d| (d - mean).powi(2));
        (mean, 1e3 * (squares.sum::<f64>() / 7.0).sqrt())
    }

    /// The same circle on axes that are not square, with its diameters in the order of the frame.
    pub(super) fn on(&self, frame: &Frame, radius_mm: f64) -> Self {
        let turned = self.radii_mm.iter().enumerate().map(|(index, radius)| {
            let angle = TAU * index as f64 / DIRECTIONS as f64;
            radius + frame.skew * radius_mm * angle.sin() * angle.cos()
        });
        let radii_mm: Vec<f64> = turned.collect();
        let diameter = |index: usize| {
            let at = frame.order.direction(index);
            radii_mm[at] + radii_mm[(at + DIRECTIONS / 2) % DIRECTIONS]
        };
        Self {
            diameters_mm: std::array::from_fn(diameter),
            radii_mm,
            ..self.clone()
        }
    }
}

/// Cuts a circle clockwise at a feed in mm/min. `scale` is the calculated length divided by the
/// true length.
pub fn cut_circle(
    bench: &mut dyn Bench,
    radius_mm: f64,
    feed_mm_per_min: f64,
    scale: f64,
) -> Result<Circle, String> {
    let [x, y] = MIDDLE_MM;
    let reach = radius_mm * FRAC_1_SQRT_2;
    // At this start a clockwise circle moves X and Y forward.
    let start = [x - reach, y + reach];
    approach(bench, start)?;
    let moments = cut(
        bench,
        &format!(
            "G2 X{:.5} Y{:.5} I{reach:.5} J{:.5} F{feed_mm_per_min:.3}",
            start[0], start[1], -reach
        ),
    )?;
    let (first, last) = moments.first().zip(moments.last()).ok_or("no steps")?;
    let around: Vec<Point> = moments
        .iter()
        .filter(|moment| !moment.is_take_up)
        .map(|moment| Point::of(moment, scale))
        .collect();
    let mut by_direction: Vec<(f64, f64)> = around
        .iter()
        .map(|point| (point.at, point.radius_mm))
        .collect();
    by_direction.sort_by(|a, b| a.0.total_cmp(&b.0));
    let directions = (0..DIRECTIONS).map(|index| TAU * index as f64 / DIRECTIONS as f64);
    Ok(Circle {
        diameters_mm: [2.0 * radius_mm; 8],
        ends_um: [PI, 0.0, PI / 2.0, 1.5 * PI].map(|end| left_at(&around, end)),
        minutes: (last.at_s - first.at_s) / 60.0,
        radii_mm: directions.map(|at| radius_at(&by_direction, at)).collect(),
    })
}

/// A point of a circle, seen from its centre.
struct Point {
    /// Direction of the tool, and of its commanded position, radians from +X anticlockwise.
    at: f64,
    sent_at: f64,
    radius_mm: f64,
    /// Position of the tool minus its commanded position, um.
    off_um: [f64; 2],
}

impl Point {
    fn of(moment: &Moment, scale: f64) -> Self {
        let centre = MIDDLE_MM.map(|mm| mm / scale);
        let tool = [0, 1].map(|axis| moment.tool_nm[axis] / 1e6 - centre[axis]);
        let sent = [0, 1].map(|axis| moment.sent_nm[axis] / 1e6 / scale - centre[axis]);
        Self {
            at: tool[1].atan2(tool[0]),
            sent_at: sent[1].atan2(sent[0]),
            radius_mm: tool[0].hypot(tool[1]),
            off_um: [0, 1].map(|axis| (tool[axis] - sent[axis]) * 1e3),
        }
    }
}

/// Angle between two directions, radians, not negative.
fn between(from: f64, to: f64) -> f64 {
    let turn = (to - from).rem_euclid(TAU);
    turn.min(TAU - turn)
}

/// Radius of the cut in a direction, mm. The points are sorted by their direction, -pi to pi.
fn radius_at(by_direction: &[(f64, f64)], at: f64) -> f64 {
    let at = if at > PI { at - TAU } else { at };
    let behind = by_direction.partition_point(|point| point.0 < at);
    let near = [behind.wrapping_sub(1), behind];
    let near = near.iter().filter_map(|index| by_direction.get(*index));
    let nearest = near.min_by(|a, b| (a.0 - at).abs().total_cmp(&(b.0 - at).abs()));
    nearest.map_or(0.0, |point| point.1)
}

/// Backlash that remains at an end: the error on the negative flank minus the error on the positive
/// one.
fn left_at(around: &[Point], end: f64) -> f64 {
    let axis = usize::from(end.cos().abs() < 0.5);
    let off = |at: f64| {
        let near =
            |a: &&Point, b: &&Point| between(a.sent_at, at).total_cmp(&between(b.sent_at, at));
        around
            .iter()
            .min_by(near)
            .map_or(0.0, |point| point.off_um[axis])
    };
    // On a clockwise circle the angle falls.
    let change = off(end - BEHIND) - off(end + BEHIND);
    // At the right and at the top the axis continues to its negative flank.
    if end < 0.75 * PI { change } else { -change }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_nearest_point_has_the_radius() {
        let points = [(-3.0, 1.0), (-1.0, 2.0), (0.1, 3.0), (3.0, 4.0)];
        let radii = [0.0, 1.0, 3.1, TAU - 1.1, TAU - 3.0];
        let radii = radii.map(|at| radius_at(&points, at));
        assert_eq!(radii, [3.0, 3.0, 4.0, 2.0, 1.0]);
    }
}
