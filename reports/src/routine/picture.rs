//! Features and their points in a plan view. Deviations are magnified.

use crate::run::{View, round_down};
use crate::text::escape;
use crate::text::length;
use husillo_metrology::routine::vector::{self, Vector, floats, minus, plus, scaled};
use husillo_metrology::routine::{Feature, Frame, Mark, Shape};
use std::fmt::Write;

/// A view along an axis of the part. It selects the axes that point right and up.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Plan {
    /// Its name, which also begins identifiers in the page.
    pub name: &'static str,
    right: usize,
    up: usize,
}

/// From above.
pub const ABOVE: Plan = Plan {
    name: "XY",
    right: 0,
    up: 1,
};

/// From the front.
pub const FRONT: Plan = Plan {
    name: "XZ",
    right: 0,
    up: 2,
};

impl Plan {
    fn flat(self, part: Vector) -> [f64; 2] {
        [part[self.right], part[self.up]]
    }
}

/// The magnification of deviations, at least 1. The largest deviation is then clearly visible.
pub fn factor(features: &[Feature], size_nm: f64) -> f64 {
    let marks = features.iter().flat_map(|feature| &feature.marks);
    let largest = marks.map(|mark| mark.residual_nm.abs()).max();
    round_down((0.03 * size_nm / largest.unwrap_or_default().max(1) as f64).max(1.0))
}

/// The largest extent of all points, nm.
pub fn size_nm(features: &[Feature], part: &Frame) -> f64 {
    let [low, high] = bounds(features, part, ABOVE);
    (high[0] - low[0]).max(high[1] - low[1]).max(1.0)
}

/// Draws all features in the frame of the part.
pub fn draw(page: &mut String, features: &[Feature], part: &Frame, plan: Plan, factor: f64) {
    let [low, high] = bounds(features, part, plan);
    let pad = 0.08 * (high[0] - low[0]).max(high[1] - low[1]).max(1e5);
    let view = View::around([[low[0] - pad, low[1] - pad], [high[0] + pad, high[1] + pad]]);
    let names: Vec<&str> = features
        .iter()
        .map(|feature| feature.name.as_str())
        .collect();
    view.open(
        page,
        plan.name,
        &format!("Features and points, {} view", plan.name),
        &format!(
            "{}; deviations are magnified {factor:.0} times",
            names.join(", ")
        ),
    );
    for feature in features {
        outline(page, &view, feature, part, plan);
    }
    for mark in features.iter().flat_map(|feature| &feature.marks) {
        point(page, &view, mark, part, plan, factor);
    }
    let mut labels = Labels::default();
    for feature in features {
        label(page, &view, &mut labels, feature, part, plan);
    }
    view.scale_bar(page);
    page.push_str("</svg>\n");
}

fn place(nm: [i64; 3], part: &Frame) -> Vector {
    floats(part.to_part(nm))
}

fn bounds(features: &[Feature], part: &Frame, plan: Plan) -> [[f64; 2]; 2] {
    let mut points: Vec<[f64; 2]> = Vec::new();
    for feature in features {
        let marks = feature.marks.iter().map(|mark| mark.surface_nm);
        let ends = ends(&feature.shape);
        for nm in marks.chain(feature.shape.point_nm()).chain(ends) {
            points.push(plan.flat(place(nm, part)));
        }
        if let Some((centre, radius)) = round(&feature.shape) {
            let [x, y] = plan.flat(place(centre, part));
            points.extend([[x - radius, y - radius], [x + radius, y + radius]]);
        }
    }
    let start = [[f64::MAX; 2], [f64::MIN; 2]];
    let [low, high] = points.iter().fold(start, |[low, high], at| {
        [
            [low[0].min(at[0]), low[1].min(at[1])],
            [high[0].max(at[0]), high[1].max(at[1])],
        ]
    });
    if low[0] <= high[0] {
        [low, high]
    } else {
        [[0.0; 2], [1e6; 2]]
    }
}

/// The ends of a shape that is drawn as one stroke.
fn ends(shape: &Shape) -> Vec<[i64; 3]> {
    match shape {
        Shape::Width { ends_nm, .. } | Shape::Distance { ends_nm, .. } => ends_nm.to_vec(),
        _ => Vec::new(),
    }
}

fn round(shape: &Shape) -> Option<([i64; 3], f64)> {
    match shape {
        Shape::Circle(circle) => Some((circle.centre_nm, circle.radius_nm as f64)),
        Shape::Sphere(sphere) => Some((sphere.centre_nm, sphere.radius_nm as f64)),
        _ => None,
    }
}

fn outline(page: &mut String, view: &View, feature: &Feature, part: &Frame, plan: Plan) {
    let class = if feature.is_good() { "good" } else { "bad" };
    let at = |part: Vector| view.at(plan.flat(part));
    let mut stroke = |points: &[Vector], extra: &str| {
        let mut path = String::new();
        for (index, point) in points.iter().enumerate() {
            let [x, y] = at(*point);
            // Writing to a String cannot fail.
            let _ = write!(path, "{}{x:.1} {y:.1}", if index == 0 { 'M' } else { 'L' });
        }
        let _ = writeln!(page, "<path class=\"{class}{extra}\" d=\"{path}\"/>");
    };
    match &feature.shape {
        Shape::Circle(circle) => {
            let axis = part.direction_to_part(&circle.axis);
            let centre = place(circle.centre_nm, part);
            // Any two directions perpendicular to the axis.
            let (first, _) = vector::nearest_axis(axis, None);
            let mut other = [0.0; 3];
            other[(first + 1) % 3] = 1.0;
            let Some(right) = vector::across(other, axis) else {
                return;
            };
            let up = vector::cross(axis, right);
            let rim: Vec<Vector> = (0..=72)
                .map(|step| {
                    let angle = f64::from(step) * std::f64::consts::TAU / 72.0;
                    let out = plus(scaled(right, angle.cos()), scaled(up, angle.sin()));
                    plus(centre, scaled(out, circle.radius_nm as f64))
                })
                .collect();
            stroke(&rim, "");
        }
        Shape::Sphere(sphere) => {
            let [x, y] = at(place(sphere.centre_nm, part));
            let radius = sphere.radius_nm as f64 * view.scale;
            let _ = writeln!(
                page,
                "<circle class=\"{class}\" cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"{radius:.1}\"/>"
            );
        }
        Shape::Plane(_) => {
            let mut rim: Vec<Vector> = hull(feature, part, plan);
            rim.extend(rim.first().copied());
            stroke(&rim, " face");
        }
        Shape::Edge { along, .. } => {
            let along = part.direction_to_part(along);
            stroke(&extent(feature, part, along), "");
        }
        Shape::Line { line, .. } => {
            let along = part.direction_to_part(&line.direction);
            stroke(&extent(feature, part, along), "");
        }
        Shape::Corner { at_nm, .. } => {
            let corner = place(*at_nm, part);
            let marks = feature
                .marks
                .iter()
                .map(|mark| place(mark.surface_nm, part));
            for mark in marks {
                stroke(&[corner, mark], "");
            }
        }
        Shape::Width {
            ends_nm: [from, to],
            ..
        } => {
            stroke(&[place(*from, part), place(*to, part)], "");
        }
        Shape::Distance {
            ends_nm: [from, to],
            ..
        } => {
            stroke(&[place(*from, part), place(*to, part)], " size");
        }
        Shape::Point { .. } | Shape::Angle { .. } => {}
    }
}

/// A line from the first to the last point along a direction, extended a little at both ends.
fn extent(feature: &Feature, part: &Frame, along: Vector) -> Vec<Vector> {
    let Some(origin) = feature.shape.point_nm().map(|nm| place(nm, part)) else {
        return Vec::new();
    };
    let marks = feature.marks.iter();
    let places = marks.map(|mark| vector::dot(minus(place(mark.surface_nm, part), origin), along));
    let [low, high] = places.fold([0.0_f64; 2], |[low, high], at| [low.min(at), high.max(at)]);
    let beyond = 0.08 * (high - low) + 5e5;
    let ends = [low - beyond, high + beyond];
    ends.map(|at| plus(origin, scaled(along, at))).to_vec()
}

/// The points of a face, in the order of their angle around its middle.
fn hull(feature: &Feature, part: &Frame, plan: Plan) -> Vec<Vector> {
    let marks = feature.marks.iter();
    let mut points: Vec<Vector> = marks.map(|mark| place(mark.surface_nm, part)).collect();
    let count = points.len().max(1) as f64;
    let middle = points
        .iter()
        .fold([0.0; 3], |sum, at| plus(sum, scaled(*at, 1.0 / count)));
    let angle = |at: &Vector| {
        let [x, y] = plan.flat(minus(*at, middle));
        y.atan2(x)
    };
    points.sort_by(|a, b| angle(a).total_cmp(&angle(b)));
    points
}

/// Draws a point and its deviation along the normal.
fn point(page: &mut String, view: &View, mark: &Mark, part: &Frame, plan: Plan, factor: f64) {
    let surface = place(mark.surface_nm, part);
    // Rotates the normal from the machine's frame to that of the part.
    let normal = vector::direction(mark.normal).map(|normal| part.direction_to_part(&normal));
    let [x, y] = view.at(plan.flat(surface));
    let _ = writeln!(
        page,
        "<circle class=\"dot\" cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"2.6\"/>"
    );
    if mark.residual_nm != 0 {
        let deviation = scaled(normal.unwrap_or_default(), mark.residual_nm as f64 * factor);
        let [u, v] = view.at(plan.flat(plus(surface, deviation)));
        let _ = writeln!(
            page,
            "<path class=\"off\" d=\"M{x:.1} {y:.1}L{u:.1} {v:.1}\"><title>{}</title></path>",
            length(mark.residual_nm as f64)
        );
    }
}

/// The labels drawn so far, each as its left end, right end and base line.
#[derive(Default)]
struct Labels(Vec<[f64; 3]>);

impl Labels {
    /// Width of a character, pixels. Most texts in the 12 pixels of the page are narrower.
    const CHARACTER: f64 = 7.0;
    /// Height of a line, pixels.
    const LINE: f64 = 13.0;

    /// A position where a label can begin without covering another one. It tries above the point,
    /// below it, and then line by line farther up.
    fn place(&mut self, text: &str, [x, y]: [f64; 2]) -> [f64; 2] {
        let left = x + 6.0;
        let right = left + text.chars().count() as f64 * Self::CHARACTER;
        let is_free = |base: f64| {
            self.0.iter().all(|[from, to, other]| {
                right <= *from || *to <= left || (base - other).abs() >= Self::LINE
            })
        };
        let above = y - 6.0;
        let lines = (1..=self.0.len()).map(|line| above - line as f64 * Self::LINE);
        let mut bases = [above, y + 15.0].into_iter().chain(lines);
        let base = bases.find(|base| is_free(*base)).unwrap_or(above);
        self.0.push([left, right, base]);
        [left, base]
    }
}

fn label(
    page: &mut String,
    view: &View,
    labels: &mut Labels,
    feature: &Feature,
    part: &Frame,
    plan: Plan,
) {
    let middle = match &feature.shape {
        Shape::Distance {
            ends_nm: [from, to],
            ..
        } => Some(vector::halfway(*from, *to)),
        shape => shape.point_nm(),
    };
    let Some(middle) = middle else { return };
    let [x, y] = view.at(plan.flat(place(middle, part)));
    let class = if feature.is_good() {
        ""
    } else {
        " class=\"bad\""
    };
    let [left, base] = labels.place(&feature.name, [x, y]);
    let _ = writeln!(
        page,
        "<text{class} x=\"{left:.1}\" y=\"{base:.1}\">{}</text>",
        escape(&feature.name)
    );
    if matches!(
        feature.shape,
        Shape::Circle(_) | Shape::Sphere(_) | Shape::Corner { .. }
    ) {
        let _ = writeln!(
            page,
            "<path class=\"thin\" d=\"M{:.1} {y:.1}h10M{x:.1} {:.1}v10\"/>",
            x - 5.0,
            y - 5.0
        );
    }
}

/// Draws the residuals of a feature as bars, in the order of touching.
pub fn residuals(page: &mut String, feature: &Feature) {
    const WIDTH: f64 = 1000.0;
    const HEIGHT: f64 = 150.0;
    let marks = &feature.marks;
    let most = marks.iter().map(|mark| mark.residual_nm.abs()).max();
    let most = most.unwrap_or_default().max(1) as f64;
    let (middle, unit) = (HEIGHT / 2.0, (HEIGHT / 2.0 - 18.0) / most);
    let step = (WIDTH - 160.0) / marks.len().max(1) as f64;
    let _ = writeln!(
        page,
        "<figure><figcaption>{} {}: form {}</figcaption><svg viewBox=\"0 0 {WIDTH:.0} \
         {HEIGHT:.0}\" role=\"img\" \
         aria-label=\"Residuals of {}\"><path class=\"grid\" d=\"M130 {middle}H{WIDTH}\"/>",
        feature.keyword,
        escape(&feature.name),
        length(feature.form_nm() as f64),
        escape(&feature.name)
    );
    for (value, y) in [(most, middle - most * unit), (-most, middle + most * unit)] {
        let _ = writeln!(
            page,
            "<path class=\"grid\" d=\"M130 {y:.1}H{WIDTH}\"/><text x=\"122\" y=\"{:.1}\" \
             text-anchor=\"end\">{}</text>",
            y + 4.0,
            length(value)
        );
    }
    for (index, mark) in marks.iter().enumerate() {
        let x = 145.0 + step * (index as f64 + 0.5);
        let height = mark.residual_nm as f64 * unit;
        let _ = writeln!(
            page,
            "<path class=\"bar\" d=\"M{x:.1} {middle}v{:.1}\"><title>point {}: {}</title></path>\
             <circle class=\"dot\" cx=\"{x:.1}\" cy=\"{:.1}\" r=\"3\"/>",
            -height,
            index + 1,
            length(mark.residual_nm as f64),
            middle - height
        );
    }
    page.push_str("</svg></figure>\n");
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn labels_do_not_overlap() {
        let mut labels = Labels::default();
        let mut places = Vec::new();
        for name in ["far", "right", "B", "sides", "far"] {
            places.push(labels.place(name, [100.0, 50.0]));
        }
        // There is room elsewhere.
        assert_eq!(labels.place("left", [20.0, 50.0]), [26.0, 44.0]);
        assert_eq!(places[..2], [[106.0, 44.0], [106.0, 65.0]]);
        for (number, [_, y]) in places.iter().enumerate() {
            let others = places.iter().skip(number + 1);
            assert!(
                others
                    .into_iter()
                    .all(|[_, other]| (y - other).abs() >= 13.0)
            );
        }
    }
}
