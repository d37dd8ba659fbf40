//! Comparisons of interpolators.

use super::{Answer, Failed, Options};
use husillo_interp::{ArcMove, Direction, Rim};
use husillo_methods::method::AXES;
use husillo_methods::{Comparer, Move, Weights};
use serde::Deserialize;
use serde_json::json;

/// What is compared.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Compared {
    /// The moves of a program. Without it there is one move.
    program: Option<Options>,
    one: Option<One>,
    /// Weights of error, speed, instructions and additions, as `3,3,3,1`.
    weights: Option<String>,
    /// Only methods with this in their name.
    only: Option<String>,
}

/// One move, in steps.
#[derive(Debug, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
enum One {
    /// Its end, by axis.
    Line(Vec<i32>),
    Circle {
        radius: i32,
        clockwise: bool,
    },
    Arc {
        from: [i32; 2],
        to: [i32; 2],
        centre: [i32; 2],
        clockwise: bool,
    },
}

const fn direction(clockwise: bool) -> Direction {
    match clockwise {
        true => Direction::Clockwise,
        false => Direction::CounterClockwise,
    }
}

impl One {
    fn made(&self) -> Result<(Move, String), Failed> {
        Ok(match self {
            Self::Line(to) => {
                let mut end = [0; AXES];
                if to.len() > end.len() {
                    return Err(format!("a line has at most {AXES} axes").into());
                }
                end[..to.len()].copy_from_slice(to);
                let line = Move::line(end).ok_or("the end is the start of the line".to_owned())?;
                (line, format!("Line to {to:?}"))
            }
            Self::Circle { radius, clockwise } => (
                Move::circle(*radius, direction(*clockwise)),
                format!("Circle of radius {radius}"),
            ),
            Self::Arc {
                from,
                to,
                centre,
                clockwise,
            } => {
                let arc = ArcMove {
                    from: *from,
                    to: *to,
                    centre: centre.map(i64::from),
                    fraction_bits: 0,
                    direction: direction(*clockwise),
                    turns: 0,
                    rim: Rim::Spiral,
                };
                (Move::arc(arc), format!("Arc from {from:?} to {to:?}"))
            }
        })
    }
}

/// Compares the methods for one move, or for the moves of a program.
///
/// # Errors
///
/// There is nothing to compare, or the program has errors.
pub fn compare(of: &Compared, program: &[u8]) -> Result<Answer, Failed> {
    let weights = of.weights.as_deref().unwrap_or("3,3,3,1");
    let weights = Weights::parse(weights).ok_or_else(|| {
        format!("weights: `{weights}` is not four numbers from 0 up, one of them above 0")
    })?;
    let mut comparer = Comparer::new(of.only.as_deref())?;
    let comparison = match (&of.program, &of.one) {
        (_, Some(one)) => {
            let (one, title) = one.made()?;
            comparer.add(&one);
            comparer.finish(title, Some(one), weights)
        }
        (Some(options), None) => {
            let job = options.job(program)?;
            let mut findings = options.findings();
            job.compare(&mut comparer, &mut findings)?;
            if findings.errors > 0 {
                return Err(Failed::refused(job.name(), &findings));
            }
            let title = format!("{} on {}", job.name(), job.machine.title);
            comparer.finish(title, None, weights)
        }
        (None, None) => return Err("neither a program nor a move".to_owned().into()),
    };
    let body = json!({
        "title": comparison.title,
        "methods": comparison.rows,
        "notes": comparison.notes,
    });
    Answer::listed("husillo.compare/1", &body)
}
