//! Tables 7 to 12 of the micro mill: interpolators, phase sequences, the power chip.

use crate::originals::{Parameter, Row, Table};
use husillo_interp::Direction;
use husillo_methods::{Comparer, Move, Weights};
use husillo_stepper::{CoilDriver, Driver, FULL_CURRENT, Mode, Sequencer};

/// Radius of the circle, steps. The original prints um, but its numbers of iterations are those of
/// 30 steps.
const RADIUS: i32 = 30;
/// Length of a step as the original prints it, nm.
const STEP_NM: f64 = 140.0;
/// Table 8: weights of simulation, error, iterations, time.
const WEIGHTS: [f64; 4] = [3.0, 3.0, 3.0, 1.0];
/// The weights of table 8, and where they are from.
const SAYS: &str = "the original";

/// An interpolator of table 7.
struct Interpolator {
    name: &'static str,
    /// Its name in `husillo compare`.
    method: &'static str,
    iterations: f64,
    error_nm: f64,
    /// Time of an iteration on the controller, us.
    time_us: f64,
    /// Mark of the simulation, which was given by eye.
    by_eye: f64,
    /// Points of table 9.
    points: f64,
}

const INTERPOLATORS: [Interpolator; 3] = [
    Interpolator {
        name: "staircase",
        method: "staircase-printed",
        iterations: 240.0,
        error_nm: 140.0,
        time_us: 3.2,
        by_eye: 6.0,
        points: 72.1,
    },
    Interpolator {
        name: "DDA",
        method: "dda-printed",
        iterations: 188.0,
        error_nm: 140.0,
        time_us: 6.8,
        by_eye: 8.0,
        points: 84.4,
    },
    Interpolator {
        name: "direct search",
        method: "direct-search-printed",
        iterations: 168.0,
        error_nm: 70.0,
        time_us: 8.6,
        by_eye: 9.0,
        points: 90.5,
    },
];

/// Iterations and largest error in nm of each interpolator on the circle.
fn walked() -> Result<[(f64, f64); 3], String> {
    let names = INTERPOLATORS.map(|one| one.method).join(",");
    let mut comparer = Comparer::new(Some(&names))?;
    comparer.add(&Move::circle(RADIUS, Direction::CounterClockwise));
    let rows = comparer.finish(String::new(), None, Weights(WEIGHTS)).rows;
    let of = |one: &Interpolator| {
        let row = rows.iter().find(|row| row.method == one.method);
        let row = row.ok_or_else(|| format!("{} makes no circle", one.method))?;
        Ok::<_, String>((row.iterations as f64, STEP_NM * row.max_error_blu))
    };
    let [a, b, c] = &INTERPOLATORS;
    Ok([of(a)?, of(b)?, of(c)?])
}

/// Table 7: iterations, errors and times of the interpolators.
///
/// # Errors
///
/// A method refuses its circle.
pub fn interpolators() -> Result<Table, String> {
    let mut rows = Vec::new();
    for (one, (iterations, error_nm)) in INTERPOLATORS.iter().zip(walked()?) {
        let name = |what: &str| format!("{}: {what}", one.name);
        rows.push(Row::new(name("iterations"), "passes", one.iterations, 0.0).rebuilt(iterations));
        rows.push(Row::new(name("largest error"), "nm", one.error_nm, 20.0).rebuilt(error_nm));
        rows.push(Row::new(name("time"), "us", one.time_us, 0.1));
    }
    Ok(Table {
        number: "7",
        title: "interpolators on a circle",
        spread: "iterations: none; errors: 20 nm, as the original states bounds, which a circle of \
                 this radius does not reach; times: their last digit",
        rows,
        parameters: vec![Parameter::new(
            "radius",
            format!("{RADIUS} steps"),
            "the counts of the original; it prints 30 um",
        )],
        notes: vec![
            "The times are those of its controller, and how they were measured is not stated. \
             `husillo compare` has the instructions of three other processors."
                .into(),
        ],
    })
}

/// Table 9: the marks of the interpolators by the rules of the original.
///
/// # Errors
///
/// A method refuses its circle.
pub fn marks() -> Result<Table, String> {
    let walked = walked()?;
    let fewest = walked
        .iter()
        .fold(f64::MAX, |fewest, one| fewest.min(one.0));
    let slowest = INTERPOLATORS
        .iter()
        .fold(0.0_f64, |most, one| most.max(one.time_us));
    let rows = INTERPOLATORS
        .iter()
        .zip(walked)
        .map(|(one, (iterations, error_nm))| {
            let marks = [
                one.by_eye,
                10.0 - error_nm / STEP_NM,
                10.0 - 0.1 * (100.0 * (iterations / fewest - 1.0)),
                (5.0 + 10.0 * (slowest - one.time_us) / slowest).min(10.0),
            ];
            let points = marks
                .iter()
                .zip(WEIGHTS)
                .map(|(mark, weight)| mark * weight);
            Row::new(one.name, "points", one.points, 1.0).rebuilt(points.sum())
        });
    Ok(Table {
        number: "9",
        title: "choice of the interpolator",
        spread: "1 point: the original rounds its marks",
        rows: rows.collect(),
        parameters: vec![
            Parameter::new("weights", "3, 3, 3, 1 (table 8)".into(), SAYS),
            Parameter::new("marks of the simulation", "6, 8, 9, by eye".into(), SAYS),
            Parameter::new("times", "3.2, 6.8, 8.6 us (table 7)".into(), SAYS),
            Parameter::new(
                "rules",
                "10 less 1 per 140 nm; 10 less 0.1 per hundredth of the fewest iterations; 5 and 1 \
                 per tenth of the slowest time, up to 10"
                    .into(),
                SAYS,
            ),
        ],
        notes: vec![
            "Errors and iterations are those of the circle that is walked here. The order is that \
             of the original: direct search, DDA, staircase."
                .into(),
        ],
    })
}

/// Share of the full current in a printed sequence: all, half, none.
type Phases = [i8; 2];

/// Table 10 as printed: A and B in halves of the full current, A' negative.
const SEQUENCES: [(&str, Mode, &[Phases]); 3] = [
    (
        "full step",
        Mode::Full,
        &[[2, -2], [2, 2], [-2, 2], [-2, -2]],
    ),
    (
        "half step",
        Mode::Half,
        &[
            [2, -2],
            [2, 0],
            [2, 2],
            [0, 2],
            [-2, 2],
            [-2, 0],
            [-2, -2],
            [0, -2],
        ],
    ),
    (
        "quarter step",
        Mode::Quarter,
        &[[2, 2], [1, 2], [0, 2], [-1, 2], [-2, 2], [2, 1], [-2, 0]],
    ),
];

/// Table 10: how many terms of each printed phase sequence agree with the sequencer.
///
/// # Errors
///
/// The chip does not have a mode.
pub fn sequences() -> Result<Table, String> {
    let mut rows = Vec::new();
    for (name, mode, printed) in SEQUENCES {
        let mut motor = Sequencer::new(Driver::Pbl3717a, mode).map_err(|why| why.to_string())?;
        let cycle: Vec<Phases> = (0..16)
            .map(|_| {
                let levels = motor.levels();
                motor.step(1);
                Driver::Pbl3717a.currents(levels).map(|current| {
                    let is_full = current.abs() == FULL_CURRENT;
                    current.signum() as i8 * if is_full { 2 } else { 1 }
                })
            })
            .collect();
        let agree = |from: usize| {
            let made = cycle.iter().cycle().skip(from);
            printed.iter().zip(made).filter(|(a, b)| a == b).count()
        };
        let most = (0..cycle.len()).map(agree).max().unwrap_or(0);
        rows.push(Row::new(name, "terms", printed.len() as f64, 0.0).rebuilt(most as f64));
    }
    Ok(Table {
        number: "10",
        title: "phase sequences of the PBL3717A",
        spread: "none",
        rows,
        parameters: vec![],
        notes: vec![
            "Outside: the sixth printed term of the quarter step is A(B/2), between A'B and A'. \
             There the current of A cannot be positive; A'(B/2) is meant."
                .into(),
        ],
    })
}

/// Table 12: the power chips by the marks and weights of the original.
pub fn power_chips() -> Table {
    // Weights of table 11: current, load voltage, means to build it, external parts.
    let weights = [3.0, 3.0, 3.0, 1.0];
    let chips = [
        ("PBL3717A", [10.0, 10.0, 10.0, 8.0], 97.0),
        ("A3988", [10.0, 9.0, 5.0, 10.0], 82.0),
    ];
    let rows = chips.map(|(name, marks, total)| {
        let points = weights
            .iter()
            .zip(marks)
            .map(|(weight, mark)| weight * mark);
        Row::new(name, "points", total, 0.5).rebuilt(points.sum())
    });
    Table {
        number: "12",
        title: "choice of the power chip",
        spread: "half a point",
        rows: rows.into(),
        parameters: vec![
            Parameter::new("weights", "3, 3, 3, 1 (table 11)".into(), SAYS),
            Parameter::new(
                "marks",
                "PBL3717A 10, 10, 10, 8; A3988 10, 9, 5, 10".into(),
                SAYS,
            ),
        ],
        notes: vec![
            "Outside: the mark 8 for external parts of the PBL3717A, with the weight 1, is printed \
             as 7 points. The choice is the same."
                .into(),
            "The marks are judgements of the original; no rules are stated that a simulation could \
             follow."
                .into(),
        ],
    }
}
