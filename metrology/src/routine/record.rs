//! Recording: a routine is written while its statements are carried out.

use super::failure::Failure;
use super::feature::Feature;
use super::mistake::Wrong;
use super::parser::Parser;
use super::runner::Runner;
use super::statement::{Order, Statement};
use super::words::words;
use crate::heads::Approach;
use std::io::{self, BufRead, Write};

/// A line that is not part of the recording.
#[derive(Debug)]
pub struct Refused {
    /// Number of the line, from 1.
    pub line: usize,
    /// The line as typed.
    pub text: String,
    /// The reason.
    pub why: Refusal,
}

/// Why a line is not part of the recording.
#[derive(Debug)]
pub enum Refusal {
    /// It is not understood.
    Wrong(Wrong),
    /// It was not carried out.
    Failed(Failure),
}

/// Carries out lines as they arrive, and writes those that succeed. Moves are written with their
/// end points. Calls `each` with every feature. A line that is wrong or fails is not written. Then
/// `refuse` is called with it.
///
/// Returns the number of refused lines.
///
/// # Errors
///
/// Reading, writing or `each` fails.
pub fn record(
    input: &mut dyn BufRead,
    routine: &mut dyn Write,
    runner: &mut Runner<'_>,
    mut each: impl FnMut(&Feature) -> io::Result<()>,
    mut refuse: impl FnMut(&Refused),
) -> io::Result<usize> {
    let mut parser = Parser::new();
    let mut refused = 0;
    let mut text = String::new();
    let mut pending = PendingMoves::default();
    for number in 1.. {
        text.clear();
        if input.read_line(&mut text)? == 0 {
            break;
        }
        let line = text.trim_end();
        if matches!(line.trim(), "end" | "quit") {
            break;
        }
        match carry_out(&mut parser, runner, number, line) {
            Ok(done) => {
                if let Some(feature) = done.is_feature.then(|| runner.features.last()).flatten() {
                    each(feature)?;
                }
                match done.moved {
                    Some(moved) => pending.push(moved, routine)?,
                    None => {
                        pending.flush(routine)?;
                        writeln!(routine, "{}", done.text)?;
                    }
                }
            }
            Err(why) => {
                refused += 1;
                refuse(&Refused {
                    line: number,
                    text: line.to_owned(),
                    why,
                });
            }
        }
        routine.flush()?;
    }
    pending.flush(routine)?;
    routine.flush()?;
    Ok(refused)
}

/// A line that succeeded.
struct Done {
    /// Its text in the routine.
    text: String,
    /// A move that was made.
    moved: Option<Moved>,
    is_feature: bool,
}

fn carry_out(
    parser: &mut Parser,
    runner: &mut Runner<'_>,
    number: usize,
    line: &str,
) -> Result<Done, Refusal> {
    let mut done = Done {
        text: line.to_owned(),
        moved: None,
        is_feature: false,
    };
    let before = parser.clone();
    let Some(statement) = parser.line(number, line).map_err(Refusal::Wrong)? else {
        return Ok(done);
    };
    let tried = try_statement(&statement, runner, &mut done);
    if tried.is_err() {
        // This makes its name free again.
        *parser = before;
    }
    tried.map_err(Refusal::Failed)?;
    Ok(done)
}

fn try_statement(
    statement: &Statement,
    runner: &mut Runner<'_>,
    done: &mut Done,
) -> Result<(), Failure> {
    let here = runner.site.position()?;
    match &statement.order {
        Order::GoTo(place, approach) => {
            let to = runner.site.place(*place)?;
            done.moved = Some(Moved::new(here, to, *approach));
        }
        Order::Jog(displacement, approach) => {
            let to = std::array::from_fn(|axis| here[axis] + displacement[axis]);
            done.moved = Some(Moved::new(here, to, *approach));
        }
        Order::Measure(task) => {
            done.is_feature = true;
            if task.keyword == "touch" {
                done.text = named(&done.text, &task.name);
            }
        }
        _ => {}
    }
    runner.run(statement)?;
    Ok(())
}

/// The line of a touch with its name inserted.
fn named(line: &str, name: &str) -> String {
    let all = words(line);
    let is_named = all
        .get(1)
        .is_some_and(|word| word.text.eq_ignore_ascii_case(name));
    match all.first() {
        Some(keyword) if !is_named => {
            let (head, rest) = line.split_at(keyword.span.end);
            format!("{head} {name}{rest}")
        }
        _ => line.to_owned(),
    }
}

/// A straight move.
#[derive(Clone, Copy)]
struct Moved {
    /// Its start, nm.
    from: [i64; 3],
    /// Its end, nm.
    to: [i64; 3],
    /// Its approach, if its line states one.
    approach: Option<Approach>,
}

impl Moved {
    const fn new(from: [i64; 3], to: [i64; 3], approach: Option<Approach>) -> Self {
        Self { from, to, approach }
    }
}

/// Moves that are not written yet. Moves in the same direction become one.
#[derive(Default)]
struct PendingMoves {
    last: Option<Moved>,
}

impl PendingMoves {
    fn push(&mut self, next: Moved, routine: &mut dyn Write) -> io::Result<()> {
        match &mut self.last {
            Some(last)
                if last.approach == next.approach && is_onward(last.from, last.to, next.to) =>
            {
                last.to = next.to;
            }
            _ => {
                self.flush(routine)?;
                self.last = Some(next);
            }
        }
        Ok(())
    }

    fn flush(&mut self, routine: &mut dyn Write) -> io::Result<()> {
        let Some(Moved { to, approach, .. }) = self.last.take() else {
            return Ok(());
        };
        // The unit is written, as the routine may use another one.
        let [x, y, z] = to.map(super::dimension::number);
        let approach = match approach {
            None => "",
            Some(Approach::Guarded) => " guarded",
            Some(Approach::Rapid) => " rapid",
        };
        writeln!(routine, "goto x {x} mm y {y} mm z {z} mm{approach}")
    }
}

/// Whether a move continues a previous one along the same single axis. Other moves stay separate,
/// as their corners may lead around an obstacle.
fn is_onward(start: [i64; 3], end: [i64; 3], to: [i64; 3]) -> bool {
    let step = |from: [i64; 3], to: [i64; 3]| -> Vec<(usize, i64)> {
        let steps = (0..3).map(|axis| (axis, (to[axis] - from[axis])));
        // The position of an axis at rest may vary by a few counts.
        let steps = steps.filter(|(_, displacement)| displacement.abs() > 10_000);
        steps
            .map(|(axis, displacement)| (axis, displacement.signum()))
            .collect()
    };
    let (first, second) = (step(start, end), step(end, to));
    first.len() == 1 && first == second
}
