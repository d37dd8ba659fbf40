//! Whole circles.

use std::hint::black_box;

use husillo_interp::{Arc, ArcMove, DirectSearch, Direction, Rim, Step};
use line_drawing::BresenhamCircle;

use crate::race::{Candidate, race};

const RADIUS: i32 = 1000;

const CIRCLE: ArcMove = ArcMove {
    from: [RADIUS, 0],
    to: [RADIUS, 0],
    centre: [0, 0],
    fraction_bits: 0,
    direction: Direction::CounterClockwise,
    turns: 0,
    rim: Rim::Spiral,
};

/// Largest distance from the circle, and largest distance between successive points.
fn cells(points: &[[i32; 2]]) -> Vec<String> {
    let distance = |[x, y]: [i32; 2]| f64::from(x).hypot(f64::from(y));
    let off = points
        .iter()
        .map(|point| (distance(*point) - f64::from(RADIUS)).abs());
    let leaps = points
        .iter()
        .zip(points.iter().skip(1))
        .map(|([x, y], [next_x, next_y])| distance([next_x - x, next_y - y]));
    vec![
        format!("{:.3}", off.fold(0.0, f64::max)),
        format!("{:.0}", leaps.fold(0.0, f64::max)),
        points.len().to_string(),
    ]
}

fn points(steps: impl Iterator<Item = Step>) -> Vec<[i32; 2]> {
    let mut at = CIRCLE.from;
    let points = steps.map(|step| {
        for (at, delta) in at.iter_mut().zip(step.deltas::<2>()) {
            *at += i32::from(delta);
        }
        at
    });
    points.collect()
}

fn walk(path: impl Iterator<Item = Step>) -> u64 {
    let mut events = 0;
    for step in path {
        black_box((step.axes, step.negative));
        events += 1;
    }
    events
}

pub fn whole() {
    let search = DirectSearch::new(&CIRCLE).expect("a circle");
    let arc = Arc::new(&CIRCLE).expect("a circle");
    let peer: Vec<[i32; 2]> = BresenhamCircle::new(0, 0, RADIUS)
        .map(|(x, y)| [x, y])
        .collect();
    let candidates = vec![
        Candidate {
            name: "husillo `DirectSearch`",
            cells: cells(&points(search.clone())),
            run: Box::new({
                let search = search.clone();
                move || walk(black_box(search.clone()))
            }),
        },
        Candidate {
            name: "the same including set-up",
            cells: cells(&points(search)),
            run: Box::new(|| DirectSearch::new(black_box(&CIRCLE)).map_or(0, walk)),
        },
        Candidate {
            name: "husillo `Arc`: any centre, any ends",
            cells: cells(&points(arc.clone())),
            run: Box::new(move || walk(black_box(arc.clone()))),
        },
        Candidate {
            name: "line_drawing `BresenhamCircle`",
            cells: cells(&peer),
            run: Box::new(|| {
                let mut events = 0;
                for point in BresenhamCircle::new(0, 0, black_box(RADIUS)) {
                    black_box(point);
                    events += 1;
                }
                events
            }),
        },
    ];
    let columns = [
        "largest distance from the circle, BLU",
        "longest jump, BLU",
        "points",
    ];
    race("circle, radius 1000", "per event", &columns, candidates);
}
