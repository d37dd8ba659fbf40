//! The report of a run: one self-contained HTML file, which needs no network. Its pictures and
//! tables can be read without scripts; with them, the viewer takes the place of the pictures.

use crate::chart;
use crate::frame;
use crate::operation::{self, Operation};
use crate::text::escape;
use crate::text::{length, millimetres};
use husillo_sim::observers::drawing::{Class, Drawing, Point};
use husillo_sim::observers::phases::Motor;
use husillo_sim::observers::picture::Ideal;
use husillo_sim::observers::speed::Speed;
use std::fmt::Write;

/// The content of a report.
#[derive(Debug)]
pub struct Report {
    /// Name of the program.
    pub program: String,
    /// Title of the machine.
    pub machine: String,
    /// What became of it on a machine, if it was made on one.
    pub operation: Option<Operation>,
    /// Rows of the table of figures: name and value.
    pub figures: Vec<(&'static str, String)>,
    /// One row per axis.
    pub axes: Vec<AxisRow>,
    /// The path of the tool.
    pub drawing: Drawing,
    /// The exact programmed path.
    pub ideal: Vec<Ideal>,
    /// Whether `ideal` has every move. Otherwise the report uses the points of `drawing`.
    pub ideal_is_whole: bool,
    /// The axes of the pictures, to the right and up.
    pub view: [char; 2],
    /// Work area in the axes of `view`, nm, in the frame of the drawing.
    pub area: Option<[[f64; 2]; 2]>,
    /// Largest deviation in nm.
    pub largest_nm: f64,
    /// Speed along the path.
    pub speed: Speed,
    /// Whether moves start and stop with ramps.
    pub has_ramps: bool,
    /// Coil currents of the first steps.
    pub phases: Vec<Motor>,
    /// Warnings, one line each.
    pub warnings: Vec<String>,
    /// The element of the scene: `husillo_simulator::scene::Scene::element`.
    pub scene: String,
}

/// Extents of one axis.
#[derive(Debug)]
pub struct AxisRow {
    /// Its letter.
    pub letter: char,
    /// Smallest and largest position of the tool, nm, work frame.
    pub extent_nm: [f64; 2],
    /// Limits, nm, work frame.
    pub travel_nm: Option<[f64; 2]>,
    /// Last position of the tool, nm, work frame.
    pub end_nm: f64,
    /// Number of take-ups.
    pub reversals: u64,
    /// Steps that its motor lost.
    pub lost_steps: u64,
}

/// Writes the report.
pub fn html(report: &Report) -> String {
    let mut page = String::new();
    if let Some(operation) = &report.operation {
        operation::section(&mut page, operation);
        page.push_str("<h2>Simulated</h2>\n");
    }
    frame::figures(&mut page, report.figures.iter().cloned());
    warnings(&mut page, &report.warnings);
    page.push_str("<section id=\"viewer\" hidden></section>\n<div class=\"still\">\n");
    path_section(&mut page, report);
    chart::section(&mut page, &report.speed, report.has_ramps);
    page.push_str("</div>\n");
    deviation_section(&mut page, report);
    axis_section(&mut page, &report.axes);
    phase_section(&mut page, &report.phases);
    frame::with_viewer(&report.program, &report.machine, &page, &report.scene)
}

fn warnings(page: &mut String, warnings: &[String]) {
    if warnings.is_empty() {
        return;
    }
    page.push_str("<section><h2>Warnings</h2><ul>\n");
    for warning in warnings {
        let _ = writeln!(page, "<li><code>{}</code></li>", escape(warning));
    }
    page.push_str("</ul></section>\n");
}

/// Maps nanometres to the picture; Y points up.
#[derive(Clone, Copy, Debug)]
pub struct View {
    low: [f64; 2],
    /// Units of the picture per nanometre.
    pub scale: f64,
    size: [f64; 2],
}

const WIDTH: f64 = 1000.0;
const MARGIN: f64 = 36.0;

impl View {
    /// A frame around these corners. It is as large as the width, or a height of 800, allows.
    pub fn around([low, high]: [[f64; 2]; 2]) -> Self {
        let span = [(high[0] - low[0]).max(1.0), (high[1] - low[1]).max(1.0)];
        let scale = ((WIDTH - 2.0 * MARGIN) / span[0]).min(800.0 / span[1]);
        Self {
            low: [
                low[0] - 0.5 * ((WIDTH - 2.0 * MARGIN) / scale - span[0]),
                low[1],
            ],
            scale,
            size: [WIDTH, span[1] * scale + 2.0 * MARGIN],
        }
    }

    /// The position of a point in the picture.
    pub fn at(&self, p: [f64; 2]) -> [f64; 2] {
        [
            MARGIN + (p[0] - self.low[0]) * self.scale,
            self.size[1] - MARGIN - (p[1] - self.low[1]) * self.scale,
        ]
    }

    /// Begins the picture.
    pub fn open(&self, page: &mut String, id: &str, title: &str, description: &str) {
        let _ = writeln!(
            page,
            "<svg viewBox=\"0 0 {:.0} {:.0}\" role=\"img\" aria-labelledby=\"{id}-t {id}-d\">\
             <title id=\"{id}-t\">{}</title><desc id=\"{id}-d\">{}</desc>",
            self.size[0],
            self.size[1],
            escape(title),
            escape(description)
        );
    }

    /// Draws a bar of a round length in the lower left corner.
    pub fn scale_bar(&self, page: &mut String) {
        let mut nm = 1.0;
        while nm * 10.0 * self.scale < 0.4 * WIDTH {
            nm *= 10.0;
        }
        let x = MARGIN + nm * self.scale;
        let y = self.size[1] - 10.0;
        let _ = writeln!(
            page,
            "<path class=\"thin\" d=\"M{MARGIN} {0:.0}v6h{1:.1}v-6\"/>\
             <text x=\"{2:.1}\" y=\"{3:.0}\">{4}</text>",
            y - 6.0,
            nm * self.scale,
            x + 8.0,
            y,
            length(nm)
        );
    }
}

fn bounds(report: &Report) -> [[f64; 2]; 2] {
    let drawn = report.drawing.bounds();
    match (drawn, report.area) {
        (Some([a, b]), Some([c, d])) => [
            [a[0].min(c[0]), a[1].min(c[1])],
            [b[0].max(d[0]), b[1].max(d[1])],
        ],
        (Some(drawn), None) => drawn,
        (None, Some(area)) => area,
        (None, None) => [[0.0; 2], [1e6; 2]],
    }
}

fn path_section(page: &mut String, report: &Report) {
    let frame = View::around(bounds(report));
    let extents: Vec<String> = report
        .axes
        .iter()
        .map(|axis| {
            format!(
                "{} {} to {}",
                axis.letter,
                millimetres(axis.extent_nm[0]),
                millimetres(axis.extent_nm[1])
            )
        })
        .collect();
    let [right, up] = report.view;
    let _ = writeln!(page, "<section><h2>Tool path in {right} and {up}</h2>");
    frame.open(
        page,
        "path",
        &format!(
            "Path of the simulated tool over the programmed path, {right} to the right, {up} up"
        ),
        &format!(
            "In mm: {}. Largest deviation {}.",
            extents.join(", "),
            length(report.largest_nm)
        ),
    );
    if let Some([low, high]) = report.area {
        work_area(page, &frame, low, high);
    }
    ideal(page, &frame, report, "ideal");
    strokes(page, &frame, &report.drawing, |point| point.tool);
    for mark in &report.drawing.take_ups {
        let [x, y] = frame.at(*mark);
        let _ = writeln!(
            page,
            "<path class=\"take-up\" d=\"M{:.1} {:.1}v10\"/>",
            x,
            y - 5.0
        );
    }
    frame.scale_bar(page);
    page.push_str("</svg>\n");
    legend(page);
    page.push_str("</section>\n");
}

fn work_area(page: &mut String, frame: &View, low: [f64; 2], high: [f64; 2]) {
    let ([x0, y1], [x1, y0]) = (frame.at(low), frame.at(high));
    let _ = writeln!(
        page,
        "<defs><pattern id=\"hatch\" width=\"7\" height=\"7\" patternUnits=\"userSpaceOnUse\" \
         patternTransform=\"rotate(45)\">\
         <path class=\"hatch\" d=\"M0 0v7\"/></pattern></defs>\
         <path style=\"fill:url(#hatch);fill-rule:evenodd\" d=\"M{:.1} \
         {:.1}H{:.1}V{:.1}H{:.1}ZM{x0:.1} {y0:.1}V{y1:.1}H{x1:.1}V{y0:.1}Z\"/>\
         <rect class=\"area\" x=\"{x0:.1}\" y=\"{y0:.1}\" width=\"{:.1}\" height=\"{:.1}\">\
         <title>work area</title></rect>",
        x0 - 8.0,
        y0 - 8.0,
        x1 + 8.0,
        y1 + 8.0,
        x0 - 8.0,
        x1 - x0,
        y1 - y0
    );
}

fn ideal(page: &mut String, frame: &View, report: &Report, class: &str) {
    if !report.ideal_is_whole {
        strokes_as(page, frame, &report.drawing, class, |point| point.ideal);
        return;
    }
    let mut path = String::new();
    let mut pen = None;
    for ideal in &report.ideal {
        let (from, to) = match *ideal {
            Ideal::Line(from, to) | Ideal::Arc(from, to, ..) => (from, to),
        };
        let ([x, y], [u, v]) = (frame.at(from), frame.at(to));
        if pen != Some(from) {
            let _ = write!(path, "M{x:.2} {y:.2}");
        }
        match *ideal {
            Ideal::Line(..) => {
                let _ = write!(path, "L{u:.2} {v:.2}");
            }
            Ideal::Arc(from, to, centre, counter_clockwise) => {
                let radius = (from[0] - centre[0]).hypot(from[1] - centre[1]) * frame.scale;
                let sweep = u8::from(!counter_clockwise);
                let cross = (from[0] - centre[0]) * (to[1] - centre[1])
                    - (from[1] - centre[1]) * (to[0] - centre[0]);
                if (from[0] - to[0]).hypot(from[1] - to[1]) * frame.scale < 0.02 {
                    let opposite = frame.at([2.0 * centre[0] - from[0], 2.0 * centre[1] - from[1]]);
                    let _ = write!(
                        path,
                        "A{radius:.2} {radius:.2} 0 0 {sweep} {:.2} {:.2}A{radius:.2} {radius:.2} \
                         0 0 {sweep} {u:.2} {v:.2}",
                        opposite[0], opposite[1]
                    );
                } else {
                    let large = u8::from((cross < 0.0) == counter_clockwise);
                    let _ = write!(
                        path,
                        "A{radius:.2} {radius:.2} 0 {large} {sweep} {u:.2} {v:.2}"
                    );
                }
            }
        }
        pen = Some(to);
    }
    let _ = writeln!(page, "<path class=\"{class}\" d=\"{path}\"/>");
}

fn strokes(
    page: &mut String,
    frame: &View,
    drawing: &Drawing,
    at: impl Fn(&Point) -> [f64; 2] + Copy,
) {
    for (class, name) in [
        (Class::Jog, "jog"),
        (Class::Rapid, "rapid"),
        (Class::Feed, "feed"),
    ] {
        polyline(page, frame, drawing, name, |of| of == class, at);
    }
}

fn strokes_as(
    page: &mut String,
    frame: &View,
    drawing: &Drawing,
    name: &str,
    at: impl Fn(&Point) -> [f64; 2] + Copy,
) {
    polyline(page, frame, drawing, name, |class| class == Class::Feed, at);
}

fn polyline(
    page: &mut String,
    frame: &View,
    drawing: &Drawing,
    name: &str,
    wanted: impl Fn(Class) -> bool,
    at: impl Fn(&Point) -> [f64; 2],
) {
    let mut path = String::new();
    for stroke in drawing.strokes.iter().filter(|stroke| wanted(stroke.class)) {
        for (index, point) in stroke.points.iter().enumerate() {
            let [x, y] = frame.at(at(point));
            let _ = write!(path, "{}{x:.2} {y:.2}", if index == 0 { 'M' } else { 'L' });
        }
    }
    if !path.is_empty() {
        let _ = writeln!(page, "<path class=\"{name}\" d=\"{path}\"/>");
    }
}

fn legend(page: &mut String) {
    page.push_str(
        "<svg viewBox=\"0 0 1000 28\" role=\"img\" aria-label=\"Legend: jog dotted, rapid dashed, \
         feed solid, \
         take-up a tick, programmed path a wide band\" style=\"border:0\">\n",
    );
    let entries = [
        ("jog", "jog", "M0 0h40"),
        ("rapid", "rapid, home", "M0 0h40"),
        ("feed", "feed", "M0 0h40"),
        ("take-up", "backlash take-up", "M20 -6v12"),
        ("ideal", "programmed path", "M0 0h40"),
        ("area", "work area", "M0 0h40"),
    ];
    for (index, (class, text, shape)) in entries.iter().enumerate() {
        let x = 10 + 158 * index;
        let _ = writeln!(
            page,
            "<g transform=\"translate({x} 14)\"><path class=\"{class}\" d=\"{shape}\"/>\
             <text x=\"48\" y=\"4\">{text}</text></g>"
        );
    }
    page.push_str("</svg>\n");
}

fn deviation_section(page: &mut String, report: &Report) {
    let feed = |drawing: &Drawing| {
        drawing
            .strokes
            .iter()
            .any(|stroke| stroke.class == Class::Feed && stroke.points.len() > 1)
    };
    if !feed(&report.drawing) || report.largest_nm <= 0.0 {
        return;
    }
    let points = report
        .drawing
        .strokes
        .iter()
        .filter(|stroke| stroke.class == Class::Feed)
        .flat_map(|stroke| &stroke.points)
        .map(|point| point.ideal);
    let [low, high] = points.fold([[f64::MAX; 2], [f64::MIN; 2]], |[low, high], at| {
        [
            [low[0].min(at[0]), low[1].min(at[1])],
            [high[0].max(at[0]), high[1].max(at[1])],
        ]
    });
    let size = (high[0] - low[0]).max(high[1] - low[1]).max(1.0);
    let factor = round_down(0.04 * size / report.largest_nm);
    if factor <= 1.0 {
        return; // The picture of the tool path shows it without magnification.
    }
    let pad = 0.06 * size;
    let frame = View::around([[low[0] - pad, low[1] - pad], [high[0] + pad, high[1] + pad]]);
    let _ = writeln!(
        page,
        "<section><h2>Deviation, magnified {factor:.0} times</h2>\
         <p>The thin line is the programmed path. The distance of each point of the tool from it \
         is drawn {factor:.0} times as large; the largest distance is {}.</p>",
        length(report.largest_nm)
    );
    frame.open(
        page,
        "deviation",
        "Deviation of the tool from the programmed path, magnified",
        &format!(
            "Magnified {factor:.0} times; largest deviation {}.",
            length(report.largest_nm)
        ),
    );
    ideal(page, &frame, report, "thin");
    strokes_as(page, &frame, &report.drawing, "feed", |point| {
        [0, 1].map(|axis| point.ideal[axis] + factor * (point.tool[axis] - point.ideal[axis]))
    });
    frame.scale_bar(page);
    page.push_str("</svg></section>\n");
}

/// Rounds down to 1, 2 or 5 times a power of ten; the result is at least 1.
pub fn round_down(value: f64) -> f64 {
    let mut power = 1.0;
    while power * 10.0 <= value {
        power *= 10.0;
    }
    [5.0, 2.0]
        .into_iter()
        .map(|digit| digit * power)
        .find(|round| *round <= value)
        .unwrap_or(power)
}

fn axis_section(page: &mut String, axes: &[AxisRow]) {
    page.push_str(
        "<section><h2>Extents</h2><div class=\"scroll\" tabindex=\"0\"><table><thead><tr>\
         <th scope=\"col\">axis</th><th scope=\"col\">least mm</th>\
         <th scope=\"col\">most mm</th><th scope=\"col\">span mm</th>\
         <th scope=\"col\">limits mm</th><th scope=\"col\">end mm</th>\
         <th scope=\"col\">reversals</th><th scope=\"col\">lost steps</th></tr></thead><tbody>\n",
    );
    for axis in axes {
        let [low, high] = axis.extent_nm;
        let limits = match axis.travel_nm {
            Some([from, to]) => {
                let verdict = if low >= from && high <= to {
                    "fits"
                } else {
                    "beyond"
                };
                format!("{} to {}, {verdict}", millimetres(from), millimetres(to))
            }
            None => "none".to_owned(),
        };
        let _ = writeln!(
            page,
            "<tr><th scope=\"row\">{}</th><td>{}</td><td>{}</td><td>{}</td><td>{limits}</td>\
             <td>{}</td><td>{}</td><td>{}</td></tr>",
            axis.letter,
            millimetres(low),
            millimetres(high),
            millimetres(high - low),
            millimetres(axis.end_nm),
            axis.reversals,
            axis.lost_steps
        );
    }
    page.push_str("</tbody></table></div></section>\n");
}

fn phase_section(page: &mut String, motors: &[Motor]) {
    let motors: Vec<_> = motors
        .iter()
        .filter(|motor| motor.steps.len() > 1)
        .collect();
    if motors.is_empty() {
        return;
    }
    page.push_str("<section><h2>Phases of the first steps</h2>\n");
    for motor in motors {
        let last = motor.steps.last().map_or(1, |(at, _)| *at).max(1);
        let first = motor.steps.first().map_or(0, |(at, _)| *at);
        let span = (last - first).max(1) as f64;
        let _ = writeln!(
            page,
            "<svg viewBox=\"0 0 1000 170\" role=\"img\" aria-labelledby=\"phase-{0}-t \
             phase-{0}-d\"><title id=\"phase-{0}-t\">\
             Coil currents of motor {0}, {1}</title><desc id=\"phase-{0}-d\">{2} steps in {3:.1} \
             ms</desc>",
            motor.letter,
            escape(&motor.driver),
            motor.steps.len() - 1,
            span / 1000.0
        );
        for coil in 0..2 {
            let base = 45.0 + 70.0 * coil as f64;
            let _ = write!(
                page,
                "<text x=\"6\" y=\"{:.0}\">{} {}</text>\
                 <path class=\"grid\" d=\"M90 {base:.0}H990\"/>",
                base + 4.0,
                motor.letter,
                motor.rows[coil]
            );
            let mut path = String::new();
            for (index, (at, currents)) in motor.steps.iter().enumerate() {
                let x = 90.0 + 880.0 * ((at - first) as f64) / span;
                let y = base - 0.025 * f64::from(currents[coil]);
                let _ = if index == 0 {
                    write!(path, "M{x:.1} {y:.1}")
                } else {
                    write!(path, "H{x:.1}V{y:.1}")
                };
            }
            let _ = writeln!(page, "<path class=\"feed\" d=\"{path}H990\"/>");
        }
        let _ = writeln!(
            page,
            "<text x=\"90\" y=\"164\">{:.1} ms</text><text x=\"990\" y=\"164\" \
             text-anchor=\"end\">{:.1} ms, {}</text></svg>",
            first as f64 / 1000.0,
            last as f64 / 1000.0,
            escape(&motor.driver)
        );
    }
    page.push_str("</section>\n");
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_page_is_self_contained() {
        let mut drawing = Drawing::default();
        let point = |x: f64, y: f64| Point {
            tool: [x, y],
            ideal: [x, y],
        };
        drawing.begin(Class::Feed, point(0.0, 0.0));
        drawing.add(point(1e6, 2e6));
        let coils = Some(husillo_stepper::Driver::Pbl3717a);
        let mut motor = Motor::new('X', "pbl3717a, full".to_owned(), coils);
        motor.steps = vec![(0, [1000, 1000]), (5000, [1000, -1000])];
        let report = Report {
            operation: None,
            program: "<script>.nc".to_owned(),
            machine: "test".to_owned(),
            figures: vec![("events", "1".to_owned())],
            axes: Vec::new(),
            drawing,
            ideal: vec![Ideal::Line([0.0; 2], [1e6, 2e6])],
            ideal_is_whole: true,
            view: ['X', 'Y'],
            area: Some([[0.0; 2], [1e7, 7e6]]),
            largest_nm: 70.0,
            speed: Speed::new(1_000_000, None),
            has_ramps: false,
            phases: vec![motor],
            warnings: vec!["part.nc:1:1: warning".to_owned()],
            scene: "<script id=\"scene\">AAAA</script>\n".to_owned(),
        };
        let page = html(&report);
        assert!(page.contains("<title>&lt;script&gt;.nc</title>") && !page.contains("<script>.nc"));
        assert!(!page.contains("http:") && !page.contains("https:") && !page.contains(" src="));
        assert!(page.contains(">AAAA</script>"));
        assert_eq!(page.matches("<svg").count(), page.matches("</svg>").count());
        assert!(page.contains("class=\"feed\"") && page.contains("class=\"ideal\""));
    }

    #[test]
    fn factors_are_rounded_down() {
        assert_eq!(
            [0.3, 1.0, 4.9, 7.0, 1999.0].map(round_down),
            [1.0, 1.0, 2.0, 5.0, 1000.0]
        );
        assert_eq!(length(70.0), "70 nm");
        assert_eq!(length(204_000.0), "204 um");
    }
}
