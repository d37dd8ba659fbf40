//! Continues a program in the middle: the remaining lines, from the present position of the mill.

use super::Translated;
use super::position::position;
use husillo_machine::Config;
use husillo_transports::micromill::{Line, Point, State};

/// The unit of coordinates, nm.
const UNIT_NM: i64 = 10;
/// Largest distance at which the mill counts as on a line, nm: half a diagonal of two steps, and
/// the rounding of the program to steps.
const ON_LINE_NM: i64 = 300;
/// Largest distance at which the mill counts as on an arc, nm. It is the distance that the
/// controller accepts between an arc and its start.
const ON_ARC_NM: f64 = 5_000.0;

/// A position between two lines of the program, nm from the zero of the part. `None`: no line has
/// moved this axis.
type Place = [Option<i64>; 3];

impl Translated {
    /// Leaves out the lines before line `number` of the program. The mill must be at the start of
    /// that line, or on its path where a stop has left it. If the spindle turns at that point, the
    /// line that starts it comes first. Tools are not requested again.
    ///
    /// # Errors
    ///
    /// Returns a sentence if the program ends before this line, if the mill is not homed or is
    /// elsewhere, or if the zero of the part is set before this line.
    pub fn resumed_at(
        mut self,
        number: usize,
        state: &State,
        config: &Config<3>,
    ) -> Result<Self, String> {
        if !state.is_homed {
            return Err(
                "the mill is not homed, so it cannot go on: home it, then move it to the \
                        start of that line"
                    .into(),
            );
        }
        let zero = state.axes.map(|axis| i64::from(axis.zero_nm));
        let begin = self.lines.partition_point(|(line, _)| *line < number);
        let rest = self.lines.split_off(begin);
        let Some((first, _)) = rest.first() else {
            let last = self.lines.last().map_or(0, |(line, _)| *line);
            return Err(format!(
                "no line {number}: the last one of the mill is {last}"
            ));
        };
        let mut place = [None; 3];
        let mut spindle = None;
        for (line, one) in &self.lines {
            match one {
                Line::Zero => {
                    return Err(format!(
                        "line {line} sets the zero of the part: begin before it, or at its start"
                    ));
                }
                Line::Spindle { .. } => spindle = Some((*line, *one)),
                Line::SpindleOff | Line::End => spindle = None,
                _ => place = end(one, place, zero),
            }
        }
        let mut at = position(state, config).map(|nm| nm.0);
        at.iter_mut().zip(zero).for_each(|(at, zero)| *at -= zero);
        let begin_of_rest = place;
        let mut left_out = None;
        for (index, (line, one)) in rest.iter().enumerate() {
            if line != first {
                break;
            }
            if is_at(place, at) || is_on(one, place, at, zero) {
                left_out = Some(index);
                break;
            }
            place = end(one, place, zero);
        }
        let Some(left_out) = left_out else {
            return Err(elsewhere(*first, begin_of_rest, at));
        };
        self.lines = spindle.into_iter().collect();
        self.lines.extend(rest.into_iter().skip(left_out));
        Ok(self)
    }
}

fn elsewhere(line: usize, place: Place, at: [i64; 3]) -> String {
    let text = |at: [Option<i64>; 3]| {
        let axes = ["X", "Y", "Z"].into_iter().zip(at);
        let words: Vec<_> = axes
            .filter_map(|(letter, nm)| Some(format!("{letter}{}", nm? as f64 / 1e6)))
            .collect();
        words.join(" ")
    };
    format!(
        "line {line} begins at {} mm from the zero of the part, and the mill stands at {}: move it \
         there first, for example by `send -`",
        text(place),
        text(at.map(Some))
    )
}

/// The position at which a line ends.
fn end(line: &Line, place: Place, zero: [i64; 3]) -> Place {
    let [x, y, z] = place;
    let nm = |units: Option<i32>, before| units.map_or(before, |units| Some(in_nm(units)));
    match *line {
        Line::Rapid(Point::Z(z)) | Line::Linear(Point::Z(z), _) => [x, y, Some(in_nm(z))],
        Line::Rapid(Point::Xy([to_x, to_y])) | Line::Linear(Point::Xy([to_x, to_y]), _) => {
            [nm(to_x, x), nm(to_y, y), z]
        }
        Line::Arc { to: [x, y], .. } => [Some(in_nm(x)), Some(in_nm(y)), z],
        Line::MachineZero { z: true } => [x, y, Some(-zero[2])],
        Line::MachineZero { z: false } => [Some(-zero[0]), Some(-zero[1]), z],
        _ => place,
    }
}

fn in_nm(units: i32) -> i64 {
    i64::from(units) * UNIT_NM
}

/// Whether the mill is at a position, as far as that position is known.
fn is_at(place: Place, at: [i64; 3]) -> bool {
    let pairs = place.into_iter().zip(at);
    pairs
        .into_iter()
        .all(|(place, at)| place.is_none_or(|place| place.abs_diff(at) <= ON_LINE_NM as u64))
}

/// Whether the mill is on the path of a line.
fn is_on(line: &Line, from: Place, at: [i64; 3], zero: [i64; 3]) -> bool {
    let here = |axis: usize| from[axis].unwrap_or(at[axis]) as f64;
    let [x, y, z] = at.map(|nm| nm as f64);
    if let Line::Arc { centre, .. } = *line {
        let [i, j] = centre.map(|units| in_nm(units) as f64);
        let radius = (here(0) - i).hypot(here(1) - j);
        let is_level = (here(2) - z).abs() <= ON_LINE_NM as f64;
        return is_level && ((x - i).hypot(y - j) - radius).abs() <= ON_ARC_NM;
    }
    let to = end(line, from, zero);
    if to == from {
        return false;
    }
    let from = [here(0), here(1), here(2)];
    let to = [0, 1, 2].map(|axis| to[axis].map_or(from[axis], |nm| nm as f64));
    let ray = [0, 1, 2].map(|axis| to[axis] - from[axis]);
    let offset = [x - from[0], y - from[1], z - from[2]];
    let dot = |a: [f64; 3], b: [f64; 3]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let length_2 = dot(ray, ray);
    // A path without length is only its start.
    let part = match length_2 > 0.0 {
        true => (dot(offset, ray) / length_2).clamp(0.0, 1.0),
        false => 0.0,
    };
    let aside = [0, 1, 2].map(|axis| offset[axis] - part * ray[axis]);
    dot(aside, aside).sqrt() <= ON_LINE_NM as f64
}

#[cfg(test)]
mod tests {
    use super::*;
    use husillo_controllers::MicromillConfig;
    use husillo_transports::micromill::AxisState;

    const SPINDLE: Line = Line::Spindle {
        clockwise: true,
        rpm: 1000,
    };

    fn xy(x: i32, y: i32) -> Line {
        Line::Linear(Point::Xy([Some(x), Some(y)]), 8)
    }

    /// A square of 0.14 mm, 1000 steps, at a depth of 0.014 mm; then an arc of the same radius
    /// about its corner.
    fn program() -> Translated {
        let arc = Line::Arc {
            clockwise: false,
            to: [0, 14_000],
            centre: [0, 0],
            feed: 8,
        };
        let lines = [
            (1, SPINDLE),
            (2, Line::Rapid(Point::Z(-1400))),
            (3, xy(14_000, 0)),
            (4, xy(14_000, 14_000)),
            (5, xy(0, 14_000)),
            (6, xy(0, 0)),
            (7, xy(14_000, 0)),
            (8, arc),
            (9, Line::End),
        ];
        Translated {
            lines: lines.to_vec(),
            ..Translated::default()
        }
    }

    /// A homed mill. Its position is in steps from the zero of the part. That zero is at 140 um in
    /// each axis.
    fn at(steps: [i32; 3]) -> State {
        State {
            axes: steps.map(|steps| AxisState {
                load_steps: steps + 1000,
                ahead_steps: 0,
                backlash_steps: 0,
                zero_nm: 140_000,
            }),
            is_homed: true,
        }
    }

    fn resumed(number: usize, steps: [i32; 3]) -> Result<Vec<(usize, Line)>, String> {
        let config = &MicromillConfig::MICROMILL.machine;
        let resumed = program().resumed_at(number, &at(steps), config);
        resumed.map(|made| made.lines)
    }

    #[test]
    fn the_rest_begins_at_the_start_or_on_the_path() {
        let rest = |from: usize| {
            let mut lines = vec![(1, SPINDLE)];
            lines.extend(
                program()
                    .lines
                    .into_iter()
                    .filter(|(line, _)| *line >= from),
            );
            Ok(lines)
        };
        // At the start of a line, within it, and one step beside it.
        for y in [0, 1, 500, 999, 1000] {
            assert_eq!(resumed(4, [1000, y, -100]), rest(4), "{y}");
            assert_eq!(resumed(4, [999, y, -100]), rest(4), "{y}");
        }
        // On the arc: 600, 800, 1000.
        for (x, y) in [(1000, 0), (800, 600), (600, 800)] {
            assert_eq!(resumed(8, [x, y, -100]), rest(8), "{x} {y}");
        }
        // While the tool moves down.
        assert_eq!(resumed(2, [0, 0, -40]), rest(2));
    }

    #[test]
    fn elsewhere_nothing_begins() {
        for (line, steps) in [
            (4, [1000, 500, -90]),
            (4, [990, 500, -100]),
            (4, [1000, 1010, -100]),
            (8, [700, 600, -100]),
            (8, [800, 600, 0]),
            (6, [1000, 0, -100]),
        ] {
            let refused = resumed(line, steps).unwrap_err();
            let begin = format!("line {line} begins at X");
            assert!(refused.starts_with(&begin), "{refused}");
        }
        let refused = resumed(4, [0, 0, 0]).unwrap_err();
        assert_eq!(
            refused,
            "line 4 begins at X0.14 Y0 Z-0.014 mm from the zero of the part, and the mill stands \
             at X0 Y0 Z0: move it there first, for example by `send -`"
        );
        let refused = resumed(10, [0; 3]).unwrap_err();
        assert_eq!(refused, "no line 10: the last one of the mill is 9");
    }

    #[test]
    fn what_cannot_be_skipped_is_said() {
        let config = &MicromillConfig::MICROMILL.machine;
        let mut made = program();
        made.lines.insert(2, (2, Line::Zero));
        let refused = made.resumed_at(4, &at([1000, 0, -100]), config);
        assert!(refused.unwrap_err().contains("sets the zero of the part"));
        let lost = State {
            is_homed: false,
            ..at([1000, 0, -100])
        };
        let refused = program().resumed_at(4, &lost, config);
        assert!(refused.unwrap_err().contains("not homed"));
    }
}
