//! Pictures of rebuilt tables.

use crate::chart::{LEFT, Panel, RIGHT, ceiling, round_up};
use crate::text::escape;
use husillo_metrology::originals::micromill::Circle;
use husillo_metrology::originals::{Row, Table};
use std::f64::consts::PI;
use std::fmt::Write;

/// A picture and its caption.
#[derive(Clone, Debug)]
pub struct Picture {
    /// An SVG element.
    pub svg: String,
    /// What it shows.
    pub caption: String,
}

/// Side of the picture of a circle, and its middle.
const SIDE: f64 = 420.0;
const MIDDLE: f64 = SIDE / 2.0;
/// Radius of the programmed circle in the picture.
const RADIUS: f64 = 130.0;
/// Length of the largest error in the picture.
const ERROR: f64 = 60.0;

impl Picture {
    /// Draws the errors of a circle around the programmed one. They are those of the measured
    /// diameters, of the rebuilt diameters, and of the rebuilt contour with the original
    /// compensation and with that of today.
    pub fn circle(name: &str, [original, today]: &[Circle; 2], table: &Table) -> Self {
        let diameters: Vec<_> = (1..=8)
            .filter_map(|index| {
                let name = format!("{name}: D{index}");
                table.rows.iter().find(|row| row.name == name)
            })
            .collect();
        let programmed = diameters.first().and_then(|row| row.programmed);
        let radius_mm = programmed.unwrap_or(1.0) / 2.0;
        let off = |row: &&Row| (row.measured / 2.0 - radius_mm).abs();
        let radii = original
            .radii_mm
            .iter()
            .map(|radius| (radius - radius_mm).abs());
        let full = radii.chain(diameters.iter().map(off)).fold(1e-6, f64::max);
        let at = |degree: f64, mm: f64| {
            let length = RADIUS + ERROR * (mm - radius_mm) / full;
            let (sin, cos) = (degree * PI / 180.0).sin_cos();
            (MIDDLE + length * cos, MIDDLE - length * sin)
        };
        let mut svg = format!(
            "<svg viewBox=\"0 0 {SIDE} {SIDE}\" role=\"img\" aria-label=\"Circle {name}: errors of \
             the radius, enlarged\"><circle class=\"nominal\" cx=\"{MIDDLE}\" cy=\"{MIDDLE}\" \
             r=\"{RADIUS}\"/>\n"
        );
        for (class, circle) in [("rebuilt", original), ("mapped", today)] {
            let mut path = String::new();
            let degrees = 360.0 / circle.radii_mm.len() as f64;
            for (index, mm) in circle.radii_mm.iter().enumerate() {
                let (x, y) = at(degrees * index as f64, *mm);
                let letter = if index == 0 { 'M' } else { 'L' };
                let _ = write!(path, "{letter}{x:.1} {y:.1}");
            }
            let _ = writeln!(svg, "<path class=\"{class}\" d=\"{path}Z\"/>");
        }
        for (index, row) in diameters.iter().enumerate() {
            // A diameter does not show which of its ends is wrong, so half of the error is drawn at
            // each.
            let degree = 90.0 - 22.5 * index as f64;
            for degree in [degree, degree + 180.0] {
                let (x, y) = at(degree, row.measured / 2.0);
                let _ = writeln!(
                    svg,
                    "<circle class=\"measured\" cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"4\"><title>{}: \
                     {:.3} mm</title></circle>",
                    row.name, row.measured
                );
            }
        }
        svg.push_str("</svg>");
        Self {
            svg,
            caption: format!(
                "Circle {name}, {:.0} mm: dots are half the measured diameters, orange is the \
                 rebuilt contour, blue the contour with the compensation of today. From the \
                 programmed circle to the largest error: {:.0} um of the radius",
                2.0 * radius_mm,
                1e3 * full
            ),
        }
    }

    /// Draws the rows of a table whose names contain a rate as dots, with the curve of the model.
    pub fn curve(table: &Table, model: impl Fn(f64) -> f64) -> Self {
        const BOTTOM: f64 = 300.0;
        let points: Vec<(f64, f64)> = table
            .rows
            .iter()
            .filter_map(|row| {
                let hz = row.name.split_whitespace().nth(1)?.parse().ok()?;
                Some((hz, row.measured))
            })
            .collect();
        let most = points.iter().fold([1e-6_f64; 2], |most, (hz, amperes)| {
            [most[0].max(*hz), most[1].max(*amperes)]
        });
        let [right, top] = [ceiling(most[0], 6.0), ceiling(most[1], 5.0)];
        let at = |hz: f64, amperes: f64| {
            (
                LEFT + (RIGHT - LEFT) * hz / right,
                BOTTOM - (BOTTOM - 30.0) * amperes / top,
            )
        };
        let mut svg = String::from(
            "<svg viewBox=\"0 0 1000 350\" role=\"img\" aria-label=\"Current over the rate of \
             CLOCK\">\n",
        );
        let panel = Panel {
            top: 30.0,
            bottom: BOTTOM,
            low: 0.0,
            high: top,
        };
        panel.scale(&mut svg, "current, A");
        let step = round_up(right / 6.0);
        for index in 0..=(right / step).round() as u32 {
            let hz = step * f64::from(index);
            let _ = write!(
                svg,
                "<text x=\"{:.0}\" y=\"320\" text-anchor=\"middle\">{hz:.0}</text>",
                at(hz, 0.0).0
            );
        }
        let _ = writeln!(
            svg,
            "<text x=\"{RIGHT}\" y=\"340\" text-anchor=\"end\">CLOCK, Hz</text>"
        );
        let mut path = String::new();
        for index in 1..=200 {
            let hz = right * f64::from(index) / 200.0;
            let (x, y) = at(hz, model(hz));
            let letter = if index == 1 { 'M' } else { 'L' };
            let _ = write!(path, "{letter}{x:.1} {y:.1}");
        }
        let _ = writeln!(svg, "<path class=\"rebuilt\" d=\"{path}\"/>");
        for (hz, amperes) in points {
            let (x, y) = at(hz, amperes);
            let _ = writeln!(
                svg,
                "<circle class=\"measured\" cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"4\"><title>{hz} Hz: \
                 {amperes} A</title></circle>"
            );
        }
        svg.push_str("</svg>");
        Self {
            svg,
            caption: "Dots are measured, the line is the coil model.".to_owned(),
        }
    }

    /// Draws the unexplained part of each row of a table, in units of its spread. `None` if fewer
    /// than four rows have one.
    pub fn unexplained(table: &Table) -> Option<Self> {
        let spreads = table.rows.iter().filter_map(|row| {
            let left = row.unexplained()?;
            (row.spread > 0.0).then(|| (row.name.as_str(), left / row.spread))
        });
        let spreads: Vec<(&str, f64)> = spreads.collect();
        if spreads.len() < 4 {
            return None;
        }
        let panel = Panel {
            top: 30.0,
            bottom: 200.0,
            low: -2.0,
            high: 2.0,
        };
        let mut svg = String::from(
            "<svg viewBox=\"0 0 1000 215\" role=\"img\" aria-label=\"Unexplained part of each row, \
             in its spreads\">\n",
        );
        panel.scale(&mut svg, "unexplained, in spreads");
        for edge in [-1.0, 1.0] {
            let _ = writeln!(
                svg,
                "<path class=\"hatch\" d=\"M{LEFT} {:.1}H{RIGHT}\"/>",
                panel.y(edge)
            );
        }
        let apart = (RIGHT - LEFT) / spreads.len() as f64;
        for (index, (name, left)) in spreads.iter().enumerate() {
            let x = LEFT + apart * (index as f64 + 0.5);
            let _ = writeln!(
                svg,
                "<path class=\"rebuilt\" d=\"M{x:.1} {:.1}V{y:.1}\"/><circle class=\"measured\" \
                 cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"3\"><title>{}: {left:+.2}</title></circle>",
                panel.y(0.0),
                escape(name),
                y = panel.y(*left)
            );
        }
        svg.push_str("</svg>");
        Some(Self {
            svg,
            caption: "Each dot is a row in the order of the table: what is left unexplained, in \
                      spreads of its measurement. Rows beyond the picture are at its edge."
                .to_owned(),
        })
    }
}
