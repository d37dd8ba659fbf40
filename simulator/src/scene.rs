//! The scene of the viewer: a program with its moves, their times and what was measured on them.
//! `docs/scene.md` describes the format.

mod columns;
mod gathered;

use columns::Columns;
use flate2::Compression;
use flate2::write::ZlibEncoder;
use husillo_sim::observers::AXES;
use husillo_sim::observers::deviation::Deviation;
use husillo_sim::observers::recording::{Recording, Shape};
use husillo_sim::observers::speed::{Band, Speed};
use serde::Serialize;
use std::io::Write;

/// Version of the format.
pub const VERSION: u32 = 1;

/// A scene.
#[derive(Debug)]
pub struct Scene<'a> {
    /// What is not a column.
    pub header: Header,
    /// Line of each move, from 1; 0 where it is not a line of the program.
    pub lines: Vec<u32>,
    /// The moves.
    pub recording: &'a Recording,
    /// Distances from the programmed path.
    pub deviation: &'a Deviation,
    /// Speeds over time.
    pub speed: &'a Speed,
}

/// What is not a column.
#[derive(Debug, Serialize)]
pub struct Header {
    /// The program.
    pub program: Program,
    /// The machine.
    pub machine: Machine,
    /// Diameter of the tool, nm.
    pub tool_diameter_nm: Option<u64>,
    /// Errors and warnings of the check.
    pub findings: Vec<Finding>,
    /// Timer ticks per second.
    pub ticks_per_second: u32,
}

/// The text of a program.
#[derive(Debug, Serialize)]
pub struct Program {
    /// Its name.
    pub name: String,
    /// Its text, as it was written.
    pub text: String,
}

/// The machine that runs it.
#[derive(Debug, Serialize)]
pub struct Machine {
    /// Its name.
    pub name: String,
    /// Its title.
    pub title: String,
    /// Its axes.
    pub axes: Vec<Axis>,
    /// Numbers of the axes to the right and up in the view from above.
    pub view: [usize; 2],
}

/// An axis.
#[derive(Debug, Serialize)]
pub struct Axis {
    /// Its letter.
    pub letter: char,
    /// Nanometres per step; of a rotary axis millionths of a degree.
    pub step_nm: f64,
    /// Its limits, nm of the machine frame.
    pub travel_nm: Option<[i64; 2]>,
    /// Position of work zero, nm of the machine frame.
    pub zero_nm: i64,
}

/// An error or a warning.
#[derive(Debug, Serialize)]
pub struct Finding {
    /// Its code, such as `W0601`.
    pub code: String,
    /// `error` or `warning`.
    pub severity: String,
    /// What is wrong.
    pub message: String,
    /// What to do about it.
    pub help: Option<String>,
    /// Its line, from 1; 0 for the whole program.
    pub line: usize,
    /// Its first column, from 1.
    pub column: usize,
}

/// The whole header, with what belongs to the columns.
#[derive(Serialize)]
struct Whole<'a> {
    version: u32,
    #[serde(flatten)]
    header: &'a Header,
    is_whole: bool,
    sample_ticks: u64,
    deviation_ticks: u64,
    chart_seconds: f64,
    columns: &'a [(String, usize)],
}

impl Scene<'_> {
    /// The scene as an element of a page.
    pub fn element(&self) -> String {
        let text = self.text();
        format!("<script type=\"application/x-husillo-scene\" id=\"scene\">{text}</script>\n")
    }

    /// The compressed scene in base64, which is the content of the element.
    pub fn text(&self) -> String {
        base64(&self.packed())
    }

    /// The compressed scene.
    fn packed(&self) -> Vec<u8> {
        let mut out = ZlibEncoder::new(Vec::new(), Compression::best());
        // Memory takes every byte.
        let _ = out.write_all(&self.bytes());
        out.finish().unwrap_or_default()
    }

    /// The scene without compression, for a viewer in the same program.
    pub fn bytes(&self) -> Vec<u8> {
        let mut columns = Columns::default();
        self.moves(&mut columns);
        self.samples(&mut columns);
        let chart_seconds = self.charts(&mut columns);
        let whole = Whole {
            version: VERSION,
            header: &self.header,
            is_whole: self.recording.is_whole,
            sample_ticks: self.recording.samples.interval,
            deviation_ticks: self.deviation.over_time.columns().1,
            chart_seconds,
            columns: columns.names(),
        };
        // The header has only strings and numbers.
        let header = serde_json::to_vec(&whole).unwrap_or_default();
        let length = (header.len() as u32).to_le_bytes();
        [&length[..], &header, columns.bytes()].concat()
    }

    fn axes(&self) -> usize {
        self.header.machine.axes.len().min(AXES)
    }

    fn moves(&self, columns: &mut Columns) {
        let moves = &self.recording.moves;
        columns.add("move.line", self.lines.iter().map(|line| i64::from(*line)));
        columns.add("move.kind", moves.iter().map(|of| of.kind as i64));
        for axis in 0..self.axes() {
            columns.add(
                format!("move.to.{axis}"),
                moves.iter().map(|of| of.to[axis]),
            );
        }
        columns.add("move.begin", moves.iter().map(|of| of.ticks[0] as i64));
        columns.add(
            "move.ticks",
            moves.iter().map(|of| (of.ticks[1] - of.ticks[0]) as i64),
        );
        columns.add("move.feed", moves.iter().map(|of| of.feed as i64));
        columns.add("move.rpm", moves.iter().map(|of| of.milli_rpm as i64));
        let deviations = self.deviation.of_moves.iter().take(moves.len());
        columns.add("move.deviation", deviations.map(|square| root(*square)));
        self.jumps(columns);
        self.shapes(columns);
        let stands = &self.recording.stands;
        columns.add("stand.begin", stands.iter().map(|stand| stand.begin as i64));
        columns.add("stand.move", stands.iter().map(|stand| stand.after as i64));
        let axis = |axis: Option<usize>| axis.map_or(-1, |axis| axis as i64);
        columns.add("stand.axis", stands.iter().map(|stand| axis(stand.axis)));
        for part in 0..3 {
            columns.add(
                format!("stand.at.{part}"),
                stands.iter().map(|stand| stand.at[part].round() as i64),
            );
        }
    }

    /// The starts of moves that do not begin where the move before ends.
    fn jumps(&self, columns: &mut Columns) {
        let mut last = None;
        let mut jumps = Vec::new();
        for (index, of) in self.recording.moves.iter().enumerate() {
            if last != Some(of.from) {
                jumps.push((index as i64, of.from));
            }
            last = Some(of.to);
        }
        columns.add("jump.move", jumps.iter().map(|(index, _)| *index));
        for axis in 0..self.axes() {
            columns.add(
                format!("jump.from.{axis}"),
                jumps.iter().map(|(_, from)| from[axis]),
            );
        }
    }

    fn shapes(&self, columns: &mut Columns) {
        let mut arcs = Vec::new();
        let mut points = Vec::new();
        for (index, of) in (0_i64..).zip(&self.recording.moves) {
            match &of.shape {
                Shape::Line => {}
                Shape::Arc {
                    plane: [right, up],
                    centre: [x, y],
                    turns,
                } => {
                    arcs.push([index, *right as i64, *up as i64, *x, *y, i64::from(*turns)]);
                }
                Shape::Curve(all) => points.extend(all.iter().map(|[x, y, z]| [index, *x, *y, *z])),
            }
        }
        let names = ["move", "right", "up", "centre.0", "centre.1", "turns"];
        for (part, name) in names.iter().enumerate() {
            columns.add(format!("arc.{name}"), arcs.iter().map(|arc| arc[part]));
        }
        for (part, name) in ["move", "at.0", "at.1", "at.2"].iter().enumerate() {
            columns.add(
                format!("curve.{name}"),
                points.iter().map(|point| point[part]),
            );
        }
    }

    fn samples(&self, columns: &mut Columns) {
        let samples = &self.recording.samples.all;
        for axis in 0..self.axes() {
            columns.add(
                format!("sample.tool.{axis}"),
                samples.iter().map(|sample| i64::from(sample.tool[axis])),
            );
            columns.add(
                format!("sample.lag.{axis}"),
                samples
                    .iter()
                    .map(|sample| i64::from(sample.sent[axis]) - i64::from(sample.tool[axis])),
            );
        }
        let (largest, _) = self.deviation.over_time.columns();
        columns.add(
            "deviation.largest",
            largest.iter().map(|square| root(*square)),
        );
    }

    /// Returns the seconds per column.
    fn charts(&self, columns: &mut Columns) -> f64 {
        let (charts, seconds) = self.speed.columns();
        let mut band = |name: &str, of: fn(&husillo_sim::observers::speed::Column) -> Band| {
            let is_there = |band: &Band| i64::from(!band.is_empty());
            let whole = |band: Band, value: f32| match band.is_empty() {
                true => 0,
                false => value.round() as i64,
            };
            columns.add(
                format!("{name}.is_there"),
                charts.iter().map(|at| is_there(&of(at))),
            );
            columns.add(
                format!("{name}.low"),
                charts.iter().map(|at| whole(of(at), of(at).low)),
            );
            columns.add(
                format!("{name}.high"),
                charts.iter().map(|at| whole(of(at), of(at).high)),
            );
        };
        band("rapid", |at| at.rapid);
        band("feed", |at| at.feed);
        band("programmed", |at| at.programmed);
        band("acceleration", |at| at.acceleration);
        band("jerk", |at| at.jerk);
        seconds
    }
}

/// The root of a square, as a whole number.
fn root(square: f32) -> i64 {
    square.sqrt().round() as i64
}

/// Bytes as base64 with padding.
///
/// # Source
///
/// RFC 4648, section 4.
fn base64(bytes: &[u8]) -> String {
    const DIGITS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut text = String::with_capacity(bytes.len().div_ceil(3) * 4);
    for group in bytes.chunks(3) {
        let byte = |index: usize| u32::from(group.get(index).copied().unwrap_or(0));
        let bits = byte(0) << 16 | byte(1) << 8 | byte(2);
        for digit in 0..4 {
            text.push(match digit <= group.len() {
                true => char::from(DIGITS[(bits >> (18 - 6 * digit) & 63) as usize]),
                false => '=',
            });
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn base64_has_the_vectors_of_its_standard() {
        let texts = ["", "f", "fo", "foo", "foob", "fooba", "foobar"];
        let expected = [
            "", "Zg==", "Zm8=", "Zm9v", "Zm9vYg==", "Zm9vYmE=", "Zm9vYmFy",
        ];
        assert_eq!(texts.map(|text| base64(text.as_bytes())), expected);
    }
}
