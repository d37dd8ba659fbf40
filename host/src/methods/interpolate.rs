//! `husillo interpolate`: makes one move on the bare integer grid, and measures its error.

use crate::cli::{ArcShape, LineShape, Output, Turning};
use crate::methods::curve::Curve;
use crate::methods::method::{self, AXES, Shape};
use husillo_interp::{ArcMove, Direction, Rim};
use serde::Serialize;
use std::io::{self, Write};

/// The results of a move.
#[derive(Debug, Serialize)]
pub struct Walk {
    iterations: usize,
    moving: usize,
    max_error_blu: f64,
    rms_error_blu: f64,
    end: Vec<i64>,
    steps: Steps,
}

/// The steps: one character per iteration for two axes, one string per iteration for more.
#[derive(Debug, Serialize)]
#[serde(untagged)]
enum Steps {
    Code(String),
    Signs(Vec<String>),
}

impl Walk {
    /// Prints the walk.
    ///
    /// # Errors
    ///
    /// Standard output is closed.
    pub fn print(&self, format: Output) -> io::Result<()> {
        let mut out = crate::console::stdout();
        if format == Output::Json {
            return writeln!(
                out,
                "{}",
                serde_json::to_string(self).map_err(io::Error::other)?
            );
        }
        let end: Vec<String> = self.end.iter().map(i64::to_string).collect();
        writeln!(out, "iterations     {}", self.iterations)?;
        writeln!(out, "moving         {}", self.moving)?;
        writeln!(out, "largest error  {:.5} BLU", self.max_error_blu)?;
        writeln!(out, "RMS error      {:.5} BLU", self.rms_error_blu)?;
        writeln!(out, "end            {}", end.join(","))?;
        match &self.steps {
            Steps::Code(code) => writeln!(out, "steps          {code}"),
            Steps::Signs(signs) => writeln!(out, "steps          {}", signs.join(" ")),
        }
    }
}

/// Makes a line.
///
/// # Errors
///
/// A message about a wrong argument.
pub fn line(shape: &LineShape) -> Result<Walk, String> {
    let method = method::by_name(&method::LINES, &shape.method, "lines")?;
    let to = integers(&shape.to, "--to")?;
    if !(2..=AXES).contains(&to.len()) {
        return Err(format!(
            "--to has {} axes; two to six are possible",
            to.len()
        ));
    }
    let mut delta = [0; AXES];
    delta[..to.len()].copy_from_slice(&to);
    let curve = Curve::line([0.0; AXES], delta.map(f64::from));
    let mut at = [0; AXES];
    let mut record = Record::default();
    let (events, _) = method.events(&Shape::Line(delta))?;
    for step in events {
        let delta = step.deltas::<AXES>();
        for (at, delta) in at.iter_mut().zip(delta) {
            *at += i64::from(delta);
        }
        record.add(&delta[..to.len()], curve.distance(&at.map(|at| at as f64)));
    }
    Ok(record.finish(at[..to.len()].to_vec()))
}

/// Makes an arc.
///
/// # Errors
///
/// A message about a wrong argument.
pub fn arc(shape: &ArcShape) -> Result<Walk, String> {
    let method = method::by_name(&method::ARCS, &shape.method, "arcs")?;
    if shape.centre_bits > 16 {
        return Err("--centre-bits is at most 16".to_owned());
    }
    let bits = shape.centre_bits;
    let (from, to) = (pair(&shape.from, "--from")?, pair(&shape.to, "--to")?);
    let centre: Vec<i64> = shape
        .centre
        .split(',')
        .map(|text| scaled(text, bits))
        .collect::<Result<_, _>>()?;
    let centre: [i64; 2] = centre
        .try_into()
        .map_err(|_| "--centre takes X,Y".to_owned())?;
    let from_centre =
        |p: [i32; 2]| [0, 1].map(|axis| (i128::from(p[axis]) << bits) - i128::from(centre[axis]));
    let square = |[x, y]: [i128; 2]| x * x + y * y;
    let rim = match shape.radius_squared {
        None => Rim::Spiral,
        Some(radius_squared) => {
            let residue = |p| {
                let square_of_radius = i128::try_from(radius_squared).map_err(|_| TOO_LARGE)?;
                let residue = (square(from_centre(p)) - square_of_radius) >> bits;
                i64::try_from(residue).map_err(|_| TOO_LARGE)
            };
            Rim::Nominal {
                start: residue(from)?,
                end: residue(to)?,
            }
        }
    };
    let direction = match shape.direction {
        Turning::Cw => Direction::Clockwise,
        Turning::Ccw => Direction::CounterClockwise,
    };
    let turns = shape.turns;
    let (events, _) = method.events(&Shape::Arc(ArcMove {
        from,
        to,
        centre,
        fraction_bits: bits,
        direction,
        turns,
        rim,
    }))?;
    let one = f64::from(1_u32 << bits);
    let radius = |p: [i32; 2]| {
        let [x, y] = from_centre(p);
        (x as f64).hypot(y as f64) / one
    };
    let band = match shape.radius_squared {
        Some(radius_squared) => [(radius_squared as f64).sqrt() / one; 2],
        None => [radius(from).min(radius(to)), radius(from).max(radius(to))],
    };
    let mut at = from;
    let mut record = Record::default();
    for step in events {
        let delta = step.deltas::<2>();
        for (at, delta) in at.iter_mut().zip(delta) {
            *at = at.wrapping_add(i32::from(delta));
        }
        let r = radius(at);
        record.add(&delta, (r - band[1]).max(band[0] - r).max(0.0));
    }
    Ok(record.finish(at.map(i64::from).to_vec()))
}

const TOO_LARGE: &str = "--radius-squared does not fit these points";

#[derive(Default)]
struct Record {
    steps: Vec<Vec<i8>>,
    moving: usize,
    largest: f64,
    sum_of_squares: f64,
}

impl Record {
    fn add(&mut self, delta: &[i8], error: f64) {
        self.steps.push(delta.to_vec());
        self.moving += usize::from(delta.iter().any(|d| *d != 0));
        self.largest = self.largest.max(error);
        self.sum_of_squares += error * error;
    }

    fn finish(self, end: Vec<i64>) -> Walk {
        let steps = if end.len() == 2 {
            Steps::Code(self.steps.iter().map(|delta| code(delta)).collect())
        } else {
            Steps::Signs(self.steps.iter().map(|delta| signs(delta)).collect())
        };
        let count = self.steps.len();
        Walk {
            iterations: count,
            moving: self.moving,
            max_error_blu: self.largest,
            rms_error_blu: (self.sum_of_squares / count.max(1) as f64).sqrt(),
            end,
            steps,
        }
    }
}

/// The code of a step: 3 (dx + 1) + dy + 1. `0` is (-1, -1), `4` is (0, 0), `8` is (+1, +1).
fn code(delta: &[i8]) -> char {
    let digit = delta.iter().fold(0, |code, d| code * 3 + (d + 1) as u8);
    char::from(b'0' + digit)
}

fn signs(delta: &[i8]) -> String {
    delta
        .iter()
        .map(|d| ['-', '0', '+'][(d + 1) as usize])
        .collect()
}

/// Reads two whole numbers. `name` is the option, for messages.
///
/// # Errors
///
/// The text is not two whole numbers.
pub fn pair(text: &str, name: &str) -> Result<[i32; 2], String> {
    <[i32; 2]>::try_from(integers(text, name)?).map_err(|_| format!("{name} takes X,Y"))
}

/// Reads whole numbers, separated by commas. `name` is the option, for messages.
///
/// # Errors
///
/// A message about the first part that is not a whole number.
pub fn integers(text: &str, name: &str) -> Result<Vec<i32>, String> {
    text.split(',')
        .map(|number| {
            number
                .trim()
                .parse()
                .map_err(|_| format!("{name}: `{number}` is not a whole number of steps"))
        })
        .collect()
}

/// Reads a decimal number in units of 2^-bits.
///
/// # Errors
///
/// The text is not a decimal number of at most 28 digits, or not a multiple of 2^-bits.
pub fn scaled(text: &str, bits: u8) -> Result<i64, String> {
    let wrong = || format!("--centre: `{text}` is not a decimal number");
    let text = text.trim();
    let (negative, body) = match text.strip_prefix('-') {
        Some(rest) => (true, rest),
        None => (false, text.strip_prefix('+').unwrap_or(text)),
    };
    let (whole, part) = body.split_once('.').unwrap_or((body, ""));
    let digits = format!("{whole}{part}");
    if digits.is_empty() || digits.len() > 28 || !digits.bytes().all(|b| b.is_ascii_digit()) {
        return Err(wrong());
    }
    // 28 digits are below 2^94, so 16 more bits fit.
    let value = digits.parse::<i128>().map_err(|_| wrong())? << bits;
    let power = 10_i128.pow(u32::try_from(part.len()).map_err(|_| wrong())?);
    if value % power != 0 {
        return Err(format!("--centre: {text} is not a multiple of 2^-{bits}"));
    }
    let value = i64::try_from(value / power).map_err(|_| wrong())?;
    Ok(if negative { -value } else { value })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn centres_are_exact() {
        assert_eq!(scaled("-3.5", 1), Ok(-7));
        assert_eq!(scaled("0.0625", 4), Ok(1));
        assert!(scaled("0.1", 16).is_err());
        assert!(scaled("1.2.3", 4).is_err());
    }

    #[test]
    fn a_circle_of_thirty_steps_has_the_known_errors() {
        for (method, iterations, moving, largest) in [
            ("direct-search", 168, 168, 0.453),
            ("direct-search-printed", 168, 168, 0.453),
            ("dda-printed", 188, 180, 0.887),
            ("staircase-printed", 240, 240, 0.983),
        ] {
            let shape = ArcShape {
                from: "30,0".to_owned(),
                to: "30,0".to_owned(),
                centre: "0,0".to_owned(),
                direction: Turning::Ccw,
                centre_bits: 16,
                radius_squared: None,
                turns: 0,
                method: method.to_owned(),
                format: Output::Json,
            };
            let walk = arc(&shape).unwrap();
            assert_eq!(
                (walk.iterations, walk.moving),
                (iterations, moving),
                "{method}"
            );
            assert_eq!(walk.end, [30, 0]);
            assert!((walk.max_error_blu - largest).abs() < 5e-4, "{method}");
        }
    }
}
