//! Comparisons of interpolators, and drill files.

use crate::calls::listed;
use crate::message::{Answer, Failed};
use crate::options::Options;
use husillo_holes::{Metric, Work};
use husillo_interp::{ArcMove, Direction, Rim};
use husillo_methods::method::AXES;
use husillo_methods::{Comparer, Move, Weights};
use husillo_simulator::diagnostics::Findings;
use husillo_simulator::holes::{self, Setup, listing};
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
    listed("husillo.compare/1", &body)
}

/// How a drill file is read.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Holes {
    #[serde(default = "unnamed")]
    name: String,
    /// Holes in an order with short ways.
    #[serde(default)]
    shortest: bool,
    /// Depth of the holes in mm: the program in G-code is made as well.
    depth_mm: Option<f64>,
}

fn unnamed() -> String {
    "board.drl".to_owned()
}

/// The holes of a drill file. The data is the program in G-code.
pub fn holes(of: &Holes, text: &[u8]) -> Result<Answer, Failed> {
    let mut findings = Findings::new(1000);
    let mut board = holes::read(text, &of.name, &Setup::default(), &mut findings);
    if of.shortest {
        board.sort_shortest(Metric::Straight);
    }
    let mut answer = Answer::default();
    listing::print_json(&board, &findings, &mut answer.text)?;
    if let Some(depth) = of.depth_mm {
        let depth_nm = (depth * 1e6).round();
        if !(1.0..=1e9).contains(&depth_nm) {
            return Err(format!("a depth of {depth} mm is not above 0 and below 1 m").into());
        }
        if findings.errors > 0 {
            return Err(Failed::refused(&of.name, &findings));
        }
        let work = Work::to_depth(depth_nm as i64);
        work.check(&board).map_err(|error| error.to_string())?;
        work.write(&board, &of.name, &mut answer.data)?;
    }
    Ok(answer)
}
