//! Straight lines.

use std::hint::black_box;

use husillo_interp::Line;
use line_drawing::{Bresenham, Bresenham3d, WalkGrid};

use crate::race::{Candidate, race};

const LINES: usize = 64;
const COLUMNS: [&str; 3] = [
    "largest distance from the line, BLU",
    "surplus events",
    "ends missed",
];

/// The same lines in every run: all directions, up to 10 000 steps per axis.
fn deltas<const N: usize>() -> Vec<[i32; N]> {
    let mut state = 0x2545_f491_4f6c_dd1d_u64;
    let mut next = || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state >> 32) as i32 % 10_000
    };
    (0..LINES).map(|_| [(); N].map(|()| next())).collect()
}

/// Largest distance of a point from the line from 0 to `delta`.
fn farthest<const N: usize>(delta: &[i32; N], points: &[[i32; N]]) -> f64 {
    let dot = |a: &[i32; N], b: &[i32; N]| -> f64 {
        let products = a.iter().zip(b).map(|(a, b)| i64::from(*a) * i64::from(*b));
        products.sum::<i64>() as f64
    };
    let length = dot(delta, delta);
    let squares = points.iter().map(|point| {
        let along = dot(point, delta);
        // All integers are below 2^53 up to here, so this is exact.
        (dot(point, point) * length - along * along) / length
    });
    squares.fold(0.0, f64::max).sqrt()
}

/// Accuracy of the visited points. Most crates begin with the point 0, which is not an event.
fn cells<const N: usize>(points: impl Fn(&[i32; N]) -> Vec<[i32; N]>) -> Vec<String> {
    let (mut error, mut surplus, mut missed) = (0.0_f64, 0_i64, 0);
    for delta in &deltas::<N>() {
        let mut visited = points(delta);
        if visited.first() == Some(&[0; N]) {
            visited.remove(0);
        }
        let needed = delta.iter().map(|part| part.unsigned_abs()).max();
        surplus += visited.len() as i64 - i64::from(needed.unwrap_or(0));
        missed += i32::from(visited.last() != Some(delta));
        error = error.max(farthest(delta, &visited));
    }
    vec![
        format!("{error:.3}"),
        surplus.to_string(),
        format!("{missed} of {LINES}"),
    ]
}

fn ours<const N: usize>(delta: &[i32; N]) -> Vec<[i32; N]> {
    let mut at = [0; N];
    let points = Line::new(*delta).map(|step| {
        let deltas = step.deltas::<N>();
        for (at, delta) in at.iter_mut().zip(deltas) {
            *at += i32::from(delta);
        }
        at
    });
    points.collect()
}

/// Runs `walk` over all lines and counts the events.
fn job<'a, const N: usize>(walk: impl Fn([i32; N]) -> u64 + 'a) -> Box<dyn FnMut() -> u64 + 'a> {
    let deltas = deltas::<N>();
    Box::new(move || deltas.iter().map(|delta| walk(black_box(*delta))).sum())
}

fn events<const N: usize>(delta: [i32; N]) -> u64 {
    let longest = delta.iter().map(|part| part.unsigned_abs()).max();
    longest.unwrap_or(0).into()
}

fn masks<const N: usize>() -> Box<dyn FnMut() -> u64> {
    job(|delta: [i32; N]| {
        for step in Line::new(delta) {
            black_box((step.axes, step.negative));
        }
        events(delta)
    })
}

fn signed<const N: usize>() -> Box<dyn FnMut() -> u64> {
    job(|delta: [i32; N]| {
        let mut at = [0_i32; N];
        for step in Line::new(delta) {
            for (at, delta) in at.iter_mut().zip(step.deltas::<N>()) {
                *at += i32::from(delta);
            }
            black_box(at);
        }
        events(delta)
    })
}

pub fn two_axes() {
    let peer = |[x, y]: [i32; 2]| Bresenham::new((0, 0), (x, y));
    let old = |[x, y]: [i32; 2]| bresenham::Bresenham::new((0, 0), (x as isize, y as isize));
    let grid = |[x, y]: [i32; 2]| WalkGrid::new((0, 0), (x, y));
    let candidates = vec![
        Candidate {
            name: "husillo `Line`, masks of axes",
            cells: cells(ours::<2>),
            run: masks::<2>(),
        },
        Candidate {
            name: "husillo `Line`, added up to points",
            cells: cells(ours::<2>),
            run: signed::<2>(),
        },
        Candidate {
            name: "line_drawing `Bresenham`",
            cells: cells(|delta| peer(*delta).map(|(x, y)| [x, y]).collect()),
            run: job(move |delta| {
                for point in peer(delta) {
                    black_box(point);
                }
                events(delta)
            }),
        },
        Candidate {
            name: "bresenham",
            cells: cells(|delta| {
                let points = old(*delta).map(|(x, y)| [x as i32, y as i32]);
                points.collect()
            }),
            run: job(move |delta| {
                for point in old(delta) {
                    black_box(point);
                }
                events(delta)
            }),
        },
        Candidate {
            name: "line_drawing `WalkGrid`, one axis at a time",
            cells: cells(|delta| grid(*delta).map(|(x, y)| [x, y]).collect()),
            run: job(move |delta| {
                for point in grid(delta) {
                    black_box(point);
                }
                // It makes this many events.
                delta
                    .iter()
                    .map(|part| u64::from(part.unsigned_abs()))
                    .sum()
            }),
        },
    ];
    race("line, 2 axes", "per event", &COLUMNS, candidates);
}

pub fn three_axes() {
    let peer = |[x, y, z]: [i32; 3]| Bresenham3d::new((0, 0, 0), (x, y, z));
    let candidates = vec![
        Candidate {
            name: "husillo `Line`, masks of axes",
            cells: cells(ours::<3>),
            run: masks::<3>(),
        },
        Candidate {
            name: "husillo `Line`, added up to points",
            cells: cells(ours::<3>),
            run: signed::<3>(),
        },
        Candidate {
            name: "line_drawing `Bresenham3d`",
            cells: cells(|delta| peer(*delta).map(|(x, y, z)| [x, y, z]).collect()),
            run: job(move |delta| {
                for point in peer(delta) {
                    black_box(point);
                }
                events(delta)
            }),
        },
    ];
    race("line, 3 axes", "per event", &COLUMNS, candidates);
}
