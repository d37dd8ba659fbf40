//! Draws the path of each method over the exact curve of one move. One picture has the whole move.
//! Others magnify parts of it in which the methods differ.

use husillo_methods::method::{self, Shape};
use husillo_methods::trial::{start, stepped};
use husillo_methods::{Curve, Move, Row};
use husillo_sim::geometry::turn;
use std::f64::consts::FRAC_PI_4;
use std::fmt::Write;

/// Half the side of a magnified square, in steps.
const HALF: f64 = 8.5;
/// With more events than this, the picture of the whole move shows only the exact curve.
const MOST_EVENTS: u64 = 4000;

/// A square of the plane.
struct Frame {
    low: [f64; 2],
    side: f64,
    pixels: f64,
}

impl Frame {
    fn at(&self, p: [f64; 2]) -> [f64; 2] {
        let scale = self.pixels / self.side;
        [
            (p[0] - self.low[0]) * scale,
            self.pixels - (p[1] - self.low[1]) * scale,
        ]
    }

    fn holds(&self, p: [f64; 2], margin: f64) -> bool {
        [0, 1].iter().all(|axis| {
            p[*axis] > self.low[*axis] - margin && p[*axis] < self.low[*axis] + self.side + margin
        })
    }

    fn around(centre: [f64; 2], half: f64, pixels: f64) -> Self {
        Self {
            low: centre.map(|at| at - half),
            side: 2.0 * half,
            pixels,
        }
    }

    /// Draws a line at every step of both axes.
    fn grid(&self, page: &mut String) {
        let mut path = String::new();
        for axis in [0, 1] {
            let mut line = self.low[axis].ceil();
            while line <= self.low[axis] + self.side {
                let [x, y] = self.at([line; 2]);
                let _ = match axis {
                    0 => write!(path, "M{x:.1} 0V{}", self.pixels),
                    _ => write!(path, "M0 {y:.1}H{}", self.pixels),
                };
                line += 1.0;
            }
        }
        let _ = writeln!(page, "<path class=\"grid\" d=\"{path}\"/>");
    }

    /// Draws the part of the curve near the frame, or the whole curve if `is_whole`.
    fn curve(&self, page: &mut String, curve: &Curve, is_whole: bool) {
        let middle = curve.part([self.low[0] + 0.5 * self.side, self.low[1] + 0.5 * self.side]);
        let reach = if is_whole {
            1.0
        } else {
            1.5 * self.side / curve.length().max(1.0)
        };
        let (first, last) = ((middle - reach).max(0.0), (middle + reach).min(1.0));
        let mut path = String::new();
        for k in 0..=360_u32 {
            let [x, y] = self.at(curve.at(first + (last - first) * f64::from(k) / 360.0));
            let _ = write!(path, "{}{x:.1} {y:.1}", if k == 0 { 'M' } else { 'L' });
        }
        let _ = writeln!(page, "<path class=\"exact\" d=\"{path}\"/>");
    }
}

/// Writes the section of the page.
pub fn section(page: &mut String, one: &Move, rows: &[Row]) {
    page.push_str(
        "<section><h2>The methods over the exact curve</h2>\n\
         <p>The thin line is the exact curve. Grid lines are one step apart. Methods as printed \
         are narrow and dashed, the others wide. \
         Frames in the whole move mark the magnified places.</p>\n<p class=\"show\">",
    );
    for row in rows {
        let _ = write!(
            page,
            "<label><input type=\"checkbox\" id=\"show-{0}\" checked> <svg viewBox=\"0 0 40 8\" \
             aria-hidden=\"true\">\
             <path class=\"m-{0}\" d=\"M0 4H40\"/></svg> {0}</label> ",
            row.method
        );
    }
    page.push_str("</p>\n");
    let frames = frames(one, rows);
    let paths = paths(one, rows, &frames);
    page.push_str("<div class=\"zooms\">\n");
    for (index, (title, frame)) in frames.iter().enumerate() {
        let _ = writeln!(
            page,
            "<figure><figcaption>{title}</figcaption><svg viewBox=\"0 0 {0} {0}\" role=\"img\" \
             aria-label=\"{title}\">",
            frame.pixels
        );
        if frame.side < 100.0 {
            frame.grid(page);
        }
        for (row, paths) in rows.iter().zip(&paths) {
            if !paths[index].is_empty() {
                let _ = writeln!(
                    page,
                    "<path class=\"m-{}\" d=\"{}\"/>",
                    row.method, paths[index]
                );
            }
        }
        frame.curve(page, &one.curve, index == 0);
        if index == 0 {
            for (_, zoom) in &frames[1..] {
                let [x, y] = frame.at([zoom.low[0], zoom.low[1] + zoom.side]);
                let side = (zoom.side * frame.pixels / frame.side).max(8.0);
                let _ = writeln!(
                    page,
                    "<rect class=\"area\" x=\"{x:.1}\" y=\"{y:.1}\" width=\"{side:.1}\" \
                     height=\"{side:.1}\"/>"
                );
            }
        }
        page.push_str("</svg></figure>\n");
    }
    page.push_str("</div></section>\n");
}

/// The square around the whole move, and the squares that are magnified, each with its title.
fn frames(one: &Move, rows: &[Row]) -> Vec<(String, Frame)> {
    let points: Vec<[f64; 2]> = (0..=360_u32)
        .map(|k| one.curve.at(f64::from(k) / 360.0))
        .collect();
    let low = [0, 1].map(|axis| points.iter().map(|p| p[axis]).fold(f64::INFINITY, f64::min));
    let high = [0, 1].map(|axis| points.iter().map(|p| p[axis]).fold(f64::MIN, f64::max));
    let half = 0.5 * (high[0] - low[0]).max(high[1] - low[1]) * 1.04 + 3.0;
    let middle = [0, 1].map(|axis| 0.5 * (low[axis] + high[axis]));
    let mut frames = vec![(
        "the whole move".to_owned(),
        Frame::around(middle, half, 1000.0),
    )];
    if half <= 2.0 * HALF {
        return frames;
    }
    let mut add = |title: String, at: [f64; 2]| {
        let is_new = frames[1..]
            .iter()
            .all(|(_, frame)| !frame.holds(at, -0.5 * HALF));
        if is_new {
            frames.push((title, Frame::around(at, HALF, 480.0)));
        }
    };
    if let Curve::Arc { begin, sweep, .. } = one.curve {
        // Keeps an angle well inside the sweep, so that the arc continues on both sides.
        let within = |angle: f64| {
            let part = turn::turned(begin, angle, sweep > 0.0) / sweep.abs();
            let edge = 3.0 / one.curve.length().max(1.0);
            (part > edge && part < 1.0 - edge).then(|| one.curve.at(part))
        };
        let border = (1..=4_u32).find_map(|k| within(f64::from(2 * k) * FRAC_PI_4));
        let octant = [1, 3, 5, 7_u32]
            .into_iter()
            .find_map(|k| within(f64::from(k) * FRAC_PI_4));
        if let Some(at) = border {
            add("at a quadrant border".to_owned(), at);
        }
        if let Some(at) = octant {
            add("at an octant border".to_owned(), at);
        }
    } else {
        add("at the start".to_owned(), one.curve.at(0.0));
    }
    let mut worst: Vec<&Row> = rows.iter().collect();
    worst.sort_by(|a, b| b.max_error_blu.total_cmp(&a.max_error_blu));
    for row in worst.into_iter().take(2) {
        let title = format!(
            "largest error of {}: {:.3} BLU",
            row.method, row.max_error_blu
        );
        add(title, row.worst_at);
    }
    add("at the end".to_owned(), one.curve.at(1.0));
    frames.truncate(5);
    frames
}

/// The path of each method in each frame.
fn paths(one: &Move, rows: &[Row], frames: &[(String, Frame)]) -> Vec<Vec<String>> {
    let mut all = Vec::new();
    for row in rows {
        let mut paths = vec![String::new(); frames.len()];
        let method = method::of(&one.shape)
            .iter()
            .find(|method| method.name == row.method);
        let Some((events, _)) = method.and_then(|method| method.events(&one.shape).ok()) else {
            all.push(paths);
            continue;
        };
        let mut at = start(&one.shape);
        let mut inside = vec![false; frames.len()];
        let is_short = row.iterations <= MOST_EVENTS;
        for step in std::iter::once(husillo_interp::Step::default()).chain(events) {
            at = stepped(&at, &step.deltas());
            let p = [at[0], at[1]];
            for (index, (_, frame)) in frames.iter().enumerate() {
                let is_inside = (index > 0 || is_short) && frame.holds(p, 2.0);
                if is_inside {
                    let [x, y] = frame.at(p);
                    let verb = if inside[index] { 'L' } else { 'M' };
                    let _ = write!(paths[index], "{verb}{x:.1} {y:.1}");
                }
                inside[index] = is_inside;
            }
        }
        all.push(paths);
    }
    all
}

/// Whether the move is a plane curve, which can be drawn.
pub fn is_flat(one: &Move) -> bool {
    match &one.shape {
        Shape::Line(delta) => delta[2..].iter().all(|d| *d == 0),
        Shape::Arc(_) => true,
    }
}
