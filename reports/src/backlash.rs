//! The report of `husillo calibrate backlash`: one value per axis and the map, side by side.

use crate::frame;
use husillo_metrology::calibration::backlash::Field;
use std::fmt::Write;

/// One axis.
#[derive(Clone, Debug)]
pub struct Panel {
    /// Its letter.
    pub letter: char,
    /// The backlash as one value.
    pub value_um: f64,
    /// The remaining backlash with one value, and with the map.
    pub fields: [Field; 2],
}

const PICTURE: &str = "\
.pairs{display:grid;grid-template-columns:repeat(auto-fit,minmax(24rem,1fr));gap:1rem}.pairs \
figure{margin:0}\
.above{fill:#c2410c}.below{fill:#0b5cad}.frame{fill:none;stroke:var(--line)}\
@media(prefers-color-scheme:dark){.above{fill:#ff9a4d}.below{fill:#5aa9ff}}\
figcaption{color:var(--soft);font-size:.9rem}td,th{text-align:right}td:first-child,\
th:first-child{text-align:left}";

/// Width of a picture.
const WIDTH: f64 = 480.0;
/// Margin for the figures.
const MARGIN: f64 = 34.0;

/// Writes the page.
pub fn html(title: &str, readings: usize, is_simulated: bool, panels: &[Panel]) -> String {
    let source = if is_simulated {
        "cut and measured on the simulated machine, which then moves to and fro over the work area"
    } else {
        "as measured, at the measured positions"
    };
    let name = format!("{title}: backlash");
    let line = format!("{readings} two-line tests, {source}");
    let mut page = frame::open(&name, &name, &line, PICTURE);
    page.push_str(
        "<section><h2>Remaining backlash</h2><table><tr><th>axis</th><th>one value</th>\
         <th>left with it</th><th>left with the map</th></tr>\n",
    );
    for panel in panels {
        let [before, after] = panel.fields.each_ref().map(|field| field.span_um);
        let _ = writeln!(
            page,
            "<tr><td>{}</td><td>{:.2} um</td><td>{:+.2} to {:+.2} um</td><td>{:+.2} to {:+.2} \
             um</td></tr>",
            panel.letter, panel.value_um, before[0], before[1], after[0], after[1]
        );
    }
    page.push_str("</table></section>\n");
    for panel in panels {
        // Both fields have the same scale, so that they can be compared.
        let spans = panel.fields.iter().flat_map(|field| field.span_um);
        let full = spans.fold(0.1_f64, |full, um| full.max(um.abs()));
        let _ = writeln!(
            page,
            "<section><h2>{}</h2><p>The strongest colour is {full:.1} um. Orange: the tool is too \
             far in the positive direction. Blue: in the negative one.</p><div class=\"pairs\">",
            panel.letter
        );
        for (field, name) in panel.fields.iter().zip(["One value", "The map"]) {
            picture(&mut page, field, full, name);
        }
        page.push_str("</div></section>\n");
    }
    frame::close(page, None)
}

fn picture(page: &mut String, field: &Field, full_um: f64, name: &str) {
    let [across, up] = &field.edges_mm;
    let (Some(left), Some(right)) = (across.first(), across.last()) else {
        return;
    };
    let (Some(low), Some(high)) = (up.first(), up.last()) else {
        return;
    };
    let scale = (WIDTH - 2.0 * MARGIN) / (right - left);
    let height = (high - low) * scale + 2.0 * MARGIN;
    let at = |x: f64, y: f64| {
        (
            MARGIN + (x - left) * scale,
            height - MARGIN - (y - low) * scale,
        )
    };
    let _ = writeln!(
        page,
        "<figure><svg viewBox=\"0 0 {WIDTH} {height:.0}\" role=\"img\" aria-label=\"{name}: \
         remaining backlash over the work area\">"
    );
    let cells = up
        .windows(2)
        .flat_map(|row| across.windows(2).map(move |column| (column, row)));
    for ((column, row), um) in cells.zip(&field.um) {
        let ((x0, y1), (x1, y0)) = (at(column[0], row[0]), at(column[1], row[1]));
        let class = if *um > 0.0 { "above" } else { "below" };
        let _ = writeln!(
            page,
            "<rect class=\"{class}\" x=\"{x0:.1}\" y=\"{y0:.1}\" width=\"{:.1}\" height=\"{:.1}\" \
             fill-opacity=\"{:.3}\"><title>X {:.2} to {:.2}, Y {:.2} to {:.2} mm: {um:+.2} \
             um</title></rect>",
            x1 - x0,
            y1 - y0,
            um.abs() / full_um,
            column[0],
            column[1],
            row[0],
            row[1]
        );
    }
    let ((x0, y1), (x1, y0)) = (at(*left, *low), at(*right, *high));
    let _ = writeln!(
        page,
        "<rect class=\"frame\" x=\"{x0:.1}\" y=\"{y0:.1}\" width=\"{:.1}\" height=\"{:.1}\"/>\
         <text x=\"{x0:.0}\" y=\"{2:.0}\">{left} mm</text><text x=\"{x1:.0}\" y=\"{2:.0}\" \
         text-anchor=\"end\">{right} mm</text>\
         <text x=\"{x0:.0}\" y=\"{3:.0}\">{high} mm</text></svg>\
         <figcaption>{name}: {4:+.2} to {5:+.2} um</figcaption></figure>",
        x1 - x0,
        y1 - y0,
        y1 + 20.0,
        y0 - 8.0,
        field.span_um[0],
        field.span_um[1]
    );
}
