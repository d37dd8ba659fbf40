//! A picture of the board: holes, order and travel.

use crate::frame;
use crate::operation::{self, Operation};
use crate::text::escape;
use husillo_clients::drill::{Part, millimetres, seconds, spoken, travel_s, travel_steps};
use husillo_transports::drill::{STEPS_PER_MM, Table};
use std::fmt::Write;

/// Colours of tools for light and dark pages. There are six, which repeat.
const COLOURS: &str = "\
:root{--t0:#0b5cad;--t1:#b3261e;--t2:#1b7f3b;--t3:#8a4fbf;--t4:#9a6700;--t5:#00767f}\
@media(prefers-color-scheme:dark){:root{--t0:#5aa9ff;--t1:#ff8a80;--t2:#58d68d;--t3:#c9a0ff;\
--t4:#f0c419;--t5:#4dd0d8}}\
.way{stroke-width:1;stroke-opacity:.55;stroke-linejoin:round}.hole{fill-opacity:.75;stroke:none}\
.back{stroke-dasharray:1 \
3}.swatch{display:inline-block;width:.8em;height:.8em;border-radius:50%;margin-right:.5em}\
.board{stroke:var(--soft);stroke-width:1;stroke-dasharray:4 3}";
/// Drawn diameter of a hole whose diameter is not known, mm.
const UNKNOWN_MM: f64 = 0.8;
/// With more holes than this, their numbers are not drawn beside them.
const MOST_NUMBERS: usize = 60;

/// The content of the page.
#[derive(Debug)]
pub struct Board<'a> {
    /// Name of the file.
    pub name: &'a str,
    /// What is drilled, tool by tool.
    pub parts: &'a [Part],
    /// Where holes may be.
    pub table: Table,
    /// Steps of travel of X and Y in the order of the file, if the order was changed.
    pub file_travel_steps: Option<u64>,
    /// What became of it on the machine.
    pub operation: Option<&'a Operation>,
}

/// The page: one self-contained file.
pub fn html(board: &Board<'_>) -> String {
    let line = "Drill for circuit boards: X, then Y, then down and up";
    let mut page = frame::open(board.name, board.name, line, COLOURS);
    frame::figures(&mut page, figures(board));
    page.push_str("<section><h2>Board</h2>\n");
    picture(&mut page, board);
    page.push_str(
        "<p>The numbers give the order. Point at a hole for its position. The lines are the path \
         of each tool, X before Y: from zero, and dotted back to zero. \
         The dashed frame is the extent of the board, the red one the table.</p></section>\n",
    );
    table(&mut page, board);
    if let Some(operation) = board.operation {
        operation::section(&mut page, operation);
    }
    frame::close(page, None)
}

fn mm(steps: u64) -> String {
    format!("{:.1} mm", steps as f64 / f64::from(STEPS_PER_MM))
}

fn figures(board: &Board<'_>) -> Vec<(&'static str, String)> {
    let holes: usize = board.parts.iter().map(Part::holes).sum();
    let travel: u64 = board.parts.iter().map(travel_steps).sum();
    let time: f64 = board
        .parts
        .iter()
        .map(|part| {
            let last = part.stops().last().map_or([0; 2], |stop| stop.at);
            seconds(part, [0; 2]).iter().sum::<f64>() + travel_s(last, [0; 2])
        })
        .sum();
    let mut figures = vec![
        ("Holes", holes.to_string()),
        ("Tools", board.parts.len().to_string()),
    ];
    if let Some([[x, y], [to_x, to_y]]) = extent(board.parts) {
        let size = format!("{:.2} x {:.2} mm", to_mm(to_x - x), to_mm(to_y - y));
        figures.push(("Extent of the holes", size));
    }
    figures.push(("Travel in X and Y", mm(travel)));
    if let Some(file) = board.file_travel_steps {
        let less = 100.0 * (1.0 - travel as f64 / file.max(1) as f64);
        figures.push((
            "In the file's order",
            format!("{}, so {less:.0} % are saved", mm(file)),
        ));
    }
    figures.push(("Time without tool changes", spoken(time)));
    figures
}

fn extent(parts: &[Part]) -> Option<[[u16; 2]; 2]> {
    let places = parts
        .iter()
        .flat_map(|part| part.stops().map(|stop| stop.at));
    places.map(|at| [at, at]).reduce(|[low, high], [at, _]| {
        [
            [low[0].min(at[0]), low[1].min(at[1])],
            [high[0].max(at[0]), high[1].max(at[1])],
        ]
    })
}

fn to_mm(steps: u16) -> f64 {
    f64::from(steps) / f64::from(STEPS_PER_MM)
}

/// Draws the route of each tool from zero over its holes and, dotted, back.
fn routes(page: &mut String, board: &Board<'_>, y_of: impl Fn(u16) -> f64) {
    for (place, part) in board.parts.iter().enumerate() {
        let _ = write!(
            page,
            "<path class=\"way\" style=\"stroke:var(--t{})\" d=\"M0 {:.3}",
            place % 6,
            y_of(0)
        );
        let mut last = [0; 2];
        for stop in part.stops() {
            let [x, y] = stop.at;
            let _ = write!(page, "H{:.3}V{:.3}", to_mm(x), y_of(y));
            last = stop.at;
        }
        let _ = writeln!(
            page,
            "\"/>\n<path class=\"way back\" style=\"stroke:var(--t{})\" d=\"M{:.3} \
             {:.3}H0V{:.3}\"/>",
            place % 6,
            to_mm(last[0]),
            y_of(last[1]),
            y_of(0)
        );
    }
}

/// Draws the holes, with numbers of this size.
fn holes(page: &mut String, board: &Board<'_>, y_of: impl Fn(u16) -> f64, size: f64) {
    let count: usize = board.parts.iter().map(Part::holes).sum();
    let every = count.div_ceil(MOST_NUMBERS).max(1);
    let mut number = 0;
    for (place, part) in board.parts.iter().enumerate() {
        let diameter = part.diameter.map_or(UNKNOWN_MM, |nm| nm.0 as f64 / 1e6);
        let _ = writeln!(
            page,
            "<g class=\"hole\" style=\"fill:var(--t{})\">",
            place % 6
        );
        for stop in part.places() {
            number += 1;
            let ([x, y], [x_mm, y_mm]) = (stop.at, stop.at.map(millimetres));
            let _ = writeln!(
                page,
                "<circle cx=\"{:.3}\" cy=\"{:.3}\" r=\"{:.3}\"><title>{number}: {x_mm}, {y_mm} mm, \
                 {}</title></circle>",
                to_mm(x),
                y_of(y),
                diameter / 2.0,
                escape(&part.name())
            );
            if number % every == 1 || every == 1 || number == count {
                let _ = writeln!(
                    page,
                    "<text x=\"{:.3}\" y=\"{:.3}\" style=\"font-size:{size:.3}px\">{number}</text>",
                    to_mm(x) + 0.6 * diameter,
                    y_of(y) - 0.6 * diameter
                );
            }
        }
        page.push_str("</g>\n");
    }
}

fn picture(page: &mut String, board: &Board<'_>) {
    let Some([low, high]) = extent(board.parts) else {
        page.push_str("<p>No hole.</p>\n");
        return;
    };
    let is_bounded = board.table != Table::UNBOUNDED;
    // The board fills the picture. Of a large table, only the corner at zero is visible.
    let (right, up) = (1.05 * to_mm(high[0]) + 1.0, 1.05 * to_mm(high[1]) + 1.0);
    let margin = 0.03 * right.max(up) + 1.0;
    let (width, height) = (right + 2.0 * margin, up + 2.0 * margin);
    let y_of = |y: u16| up - to_mm(y);
    let _ = writeln!(
        page,
        "<svg viewBox=\"{:.3} {:.3} {width:.3} {height:.3}\" role=\"img\" aria-label=\"holes and \
         the path between them\">",
        -margin, -margin
    );
    if is_bounded {
        let _ = writeln!(
            page,
            "<rect class=\"area\" x=\"0\" y=\"{:.3}\" width=\"{:.3}\" height=\"{:.3}\"/>",
            y_of(board.table.y),
            to_mm(board.table.x),
            to_mm(board.table.y)
        );
    }
    let _ = writeln!(
        page,
        "<rect class=\"board\" x=\"{:.3}\" y=\"{:.3}\" width=\"{:.3}\" height=\"{:.3}\"/>",
        to_mm(low[0]),
        y_of(high[1]),
        to_mm(high[0]) - to_mm(low[0]),
        to_mm(high[1]) - to_mm(low[1])
    );
    routes(page, board, y_of);
    let size = 0.012 * width;
    scale_bar(page, [width, up + 0.5 * margin, 0.3 * margin, size]);
    holes(page, board, y_of, size);
    page.push_str("</svg>\n");
}

/// A bar of a round length below zero: width of the picture, position, height and size of the
/// letters, mm.
fn scale_bar(page: &mut String, [width, y, height, size]: [f64; 4]) {
    let mut length = 0.1;
    while 10.0 * length < 0.4 * width {
        length *= 10.0;
    }
    let _ = writeln!(
        page,
        "<path class=\"thin\" d=\"M0 {y:.3}v{height:.3}h{length}v-{height:.3}\"/>\
         <text x=\"{:.3}\" y=\"{:.3}\" style=\"font-size:{size:.3}px\">{length} mm</text>",
        length + 0.5 * size,
        y + height
    );
}

fn table(page: &mut String, board: &Board<'_>) {
    page.push_str(
        "<section><h2>Tools</h2><div \
         class=\"scroll\" tabindex=\"0\">\
         <table><tr><th>Tool</th><th>Diameter</th><th>Holes</th><th>Bytes</th>\
         <th>Travel</th><th>Time</th></tr>\n",
    );
    for (place, part) in board.parts.iter().enumerate() {
        let diameter = part
            .diameter
            .map_or("unknown".to_owned(), |nm| format!("{nm} mm"));
        let _ = writeln!(
            page,
            "<tr><td><span class=\"swatch\" \
             style=\"background:var(--t{})\"></span>T{}</td><td>{diameter}</td><td>{}</td><td>{}\
             </td>\
             <td>{}</td><td>{}</td></tr>",
            place % 6,
            part.tool,
            part.holes(),
            part.bytes().len(),
            mm(travel_steps(part)),
            spoken(seconds(part, [0; 2]).iter().sum())
        );
    }
    page.push_str("</table></div></section>\n");
}
