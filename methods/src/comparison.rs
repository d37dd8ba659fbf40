//! Runs all methods on one move, or on every feed move of a program.

use crate::curve::Curve;
use crate::decision::{self, Points, Weights};
use crate::method::{self, AXES, Method, Shape};
use crate::trial::{Speed, Tally};
use husillo_interp::{ArcMove, Direction, Rim};
use serde::Serialize;

/// The results of one method.
#[derive(Clone, Debug, Serialize)]
pub struct Row {
    /// Its name.
    pub method: &'static str,
    /// `line` or `arc`.
    pub shape: &'static str,
    /// Number of moves.
    pub moves: u64,
    /// Passes of its loop.
    pub iterations: u64,
    /// Passes with a step.
    pub moving: u64,
    /// Largest distance from the exact curve after a pass, steps.
    pub max_error_blu: f64,
    /// Root mean square of the distance, steps.
    pub rms_error_blu: f64,
    /// Speed if every pass takes the same time.
    #[serde(flatten)]
    pub equal_time: Speed,
    /// Speed if every event takes the time of its own path.
    pub vector_feed: Option<Speed>,
    /// Most additions and subtractions per event, by the method alone.
    pub additions: u32,
    /// Most sign tests per event, by the method alone.
    pub tests: u32,
    /// Instructions per event.
    pub instructions: Instructions,
    /// Its points in the decision matrix.
    pub points: Points,
    /// Position of the largest error.
    #[serde(skip)]
    pub worst_at: [f64; 2],
}

/// Instructions per event, from the counts that the check of the firmware keeps.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Instructions {
    /// On a Cortex-M0.
    pub cortex_m0: Option<f64>,
    /// On a Cortex-M4F.
    pub cortex_m4f: Option<f64>,
    /// On a 32-bit RISC-V.
    pub riscv: Option<f64>,
}

/// One move and its exact curve.
#[derive(Clone, Debug)]
pub struct Move {
    /// The move on the grid.
    pub shape: Shape,
    /// The move with its centre rounded to a whole step, for methods without fractional centres.
    pub rounded: Option<Shape>,
    /// The exact curve.
    pub curve: Curve,
}

impl Move {
    /// A line from zero. `None` if it has no step.
    pub fn line(delta: [i32; AXES]) -> Option<Self> {
        (delta != [0; AXES]).then(|| Self {
            shape: Shape::Line(delta),
            rounded: None,
            curve: Curve::line([0.0; AXES], delta.map(f64::from)),
        })
    }

    /// An arc, with its exact curve.
    pub fn arc(arc: ArcMove) -> Self {
        Self {
            rounded: None,
            curve: Curve::of(&arc, None),
            shape: Shape::Arc(arc),
        }
    }

    /// A full circle about zero, of a radius in steps.
    pub fn circle(radius: i32, direction: Direction) -> Self {
        Self::arc(ArcMove {
            from: [radius, 0],
            to: [radius, 0],
            centre: [0; 2],
            fraction_bits: 0,
            direction,
            turns: 0,
            rim: Rim::Spiral,
        })
    }

    /// Returns the move in the form that a method accepts.
    fn shape_for(&self, method: &Method) -> &Shape {
        match &self.rounded {
            Some(rounded) if !method.takes_fractions() => rounded,
            _ => &self.shape,
        }
    }
}

/// The results of a comparison.
#[derive(Debug)]
pub struct Comparison {
    /// The subject of the comparison, one line.
    pub title: String,
    /// Rows of lines, then rows of arcs.
    pub rows: Vec<Row>,
    /// The move, if there was only one.
    pub one: Option<Move>,
    /// Weights of the matrix.
    pub weights: Weights,
    /// Moves that could not be made, one line per cause.
    pub notes: Vec<String>,
}

/// Runs the methods and sums their results over all moves.
#[derive(Debug)]
pub struct Comparer {
    only: Option<Vec<String>>,
    tallies: Vec<(&'static Method, bool, Tally)>,
    notes: Vec<(String, u64)>,
}

impl Comparer {
    /// Creates a comparison of all methods, or of `only` some: their names, separated by commas.
    ///
    /// # Errors
    ///
    /// A name is unknown.
    pub fn new(only: Option<&str>) -> Result<Self, String> {
        let only: Option<Vec<String>> = only.map(|names| {
            names
                .split(',')
                .map(|name| name.trim().to_owned())
                .collect()
        });
        for name in only.iter().flatten() {
            if method::by_name(&method::LINES, name, "lines").is_err() {
                method::by_name(&method::ARCS, name, "arcs")?;
            }
        }
        Ok(Self {
            only,
            tallies: Vec::new(),
            notes: Vec::new(),
        })
    }

    /// Makes a move of a program with every method. Leaves out a move that not all of them can
    /// make, because sums over different moves cannot be compared.
    pub fn add_common(&mut self, one: &Move) {
        let unable = method::of(&one.shape)
            .iter()
            .filter(|method| self.is_wanted(method))
            .find_map(|method| Some((method, method.events(one.shape_for(method)).err()?)));
        match unable {
            Some((method, why)) => self.note(format!("left out, {} cannot: {why}", method.name)),
            None => self.add(one),
        }
    }

    fn is_wanted(&self, method: &Method) -> bool {
        self.only
            .as_ref()
            .is_none_or(|only| only.iter().any(|name| name == method.name))
    }

    /// Makes a move with every method that can.
    pub fn add(&mut self, one: &Move) {
        let is_arc = matches!(one.shape, Shape::Arc(_));
        for method in method::of(&one.shape) {
            if !self.is_wanted(method) {
                continue;
            }
            let known = self
                .tallies
                .iter()
                .position(|(of, arc, _)| of.name == method.name && *arc == is_arc);
            let index = known.unwrap_or_else(|| {
                self.tallies.push((method, is_arc, Tally::default()));
                self.tallies.len() - 1
            });
            if let Err(reason) =
                self.tallies[index]
                    .2
                    .walk(method, one.shape_for(method), &one.curve)
            {
                self.note(format!("{}: {reason}", method.name));
            }
        }
    }

    /// Notes a move that could not be made. Equal notes are counted.
    pub fn note(&mut self, note: String) {
        match self.notes.iter_mut().find(|(known, _)| *known == note) {
            Some((_, count)) => *count += 1,
            None => self.notes.push((note, 1)),
        }
    }

    /// Finishes the comparison and rates the methods. Rows of lines come first.
    pub fn finish(self, title: String, one: Option<Move>, weights: Weights) -> Comparison {
        let mut rows: Vec<Row> = Vec::new();
        for shape in ["line", "arc"] {
            let mut group: Vec<Row> = self
                .tallies
                .iter()
                .filter(|(_, is_arc, tally)| *is_arc == (shape == "arc") && tally.moves > 0)
                .map(|(method, _, tally)| row(method, shape, tally))
                .collect();
            decision::rate(&mut group, weights);
            rows.append(&mut group);
        }
        Comparison {
            title,
            rows,
            one,
            weights,
            notes: self
                .notes
                .into_iter()
                .map(|(note, count)| match count {
                    1 => note,
                    _ => format!("{note} ({count} times)"),
                })
                .collect(),
        }
    }
}

fn row(method: &Method, shape: &'static str, tally: &Tally) -> Row {
    let [cortex_m0, cortex_m4f, riscv] = method.instructions(tally.is_between);
    Row {
        method: method.name,
        shape,
        moves: tally.moves,
        iterations: tally.iterations,
        moving: tally.moving,
        max_error_blu: tally.max_error_blu,
        rms_error_blu: tally.rms_error_blu(),
        equal_time: tally.equal_time(),
        vector_feed: tally.vector_feed(),
        additions: method.operations[0],
        tests: method.operations[1],
        instructions: Instructions {
            cortex_m0,
            cortex_m4f,
            riscv,
        },
        points: Points::default(),
        worst_at: tally.worst_at,
    }
}
