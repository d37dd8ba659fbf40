//! Pictures of rebuilt tables.

use husillo_metrology::originals::Table;
use husillo_metrology::originals::micromill::Circle;
use std::f64::consts::PI;
use std::fmt::Write;

/// A picture and its caption.
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
    /// The errors of a circle around the programmed one: of the diameters as measured and as
    /// rebuilt, and of the rebuilt contour before and with the compensation of today.
    pub fn circle(name: &str, [original, today]: &[Circle; 2], table: &Table) -> Self {
        let diameters: Vec<_> = (1..=8)
            .filter_map(|index| {
                let name = format!("{name}: D{index}");
                table.rows.iter().find(|row| row.name == name)
            })
            .collect();
        let programmed = diameters.first().and_then(|row| row.programmed);
        let radius_mm = programmed.unwrap_or(1.0) / 2.0;
        let off = |row: &&husillo_metrology::originals::Row| (row.measured / 2.0 - radius_mm).abs();
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
            for (degree, mm) in circle.radii_mm.iter().enumerate() {
                let (x, y) = at(degree as f64, *mm);
                let letter = if degree == 0 { 'M' } else { 'L' };
                let _ = write!(path, "{letter}{x:.1} {y:.1}");
            }
            let _ = writeln!(svg, "<path class=\"{class}\" d=\"{path}Z\"/>");
        }
        for (index, row) in diameters.iter().enumerate() {
            // A diameter does not say at which of its ends the error is: half at both.
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
}
