//! Drill files.

use super::{Answer, Failed};
use crate::diagnostics::Findings;
use crate::holes::{self, Setup, listing};
use husillo_holes::{Metric, Work};
use serde::Deserialize;

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
///
/// # Errors
///
/// The depth is out of range, or the file has errors and a depth is given.
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
