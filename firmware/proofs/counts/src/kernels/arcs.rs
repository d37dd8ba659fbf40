//! Full circles with a radius of 1000 steps around a centre on the grid. Each has four changes of
//! quadrant in about 6000 events.

use core::hint::black_box;

use husillo_interp::{
    Arc, ArcDda, ArcMove, DirectSearch, DirectSearchPrinted, Direction, Rim, Staircase,
    TimedDirectSearch,
};

use crate::{Count, walk};

/// The circle.
pub const CIRCLE: ArcMove = ArcMove {
    from: [1000, 0],
    to: [1000, 0],
    centre: [0, 0],
    fraction_bits: 0,
    direction: Direction::CounterClockwise,
    turns: 0,
    rim: Rim::Spiral,
};

#[inline(never)]
pub fn all(count: Count<'_>) {
    if let Ok(search) = DirectSearch::new(&CIRCLE) {
        walk(count, "direct_search", &search);
        timed(count, &TimedDirectSearch::new(search, 10_000));
    }
    if let Ok(search) = DirectSearchPrinted::new(&CIRCLE) {
        walk(count, "direct_search_printed", &search);
    }
    // A centre with fractions of a step, which needs the general arc.
    let between = ArcMove {
        fraction_bits: 16,
        ..CIRCLE
    };
    if let Ok(arc) = Arc::new(&between) {
        walk(count, "arc_32_bits", &arc);
    }
    if let Ok(arc) = Arc::wide(&between) {
        walk(count, "arc_64_bits", &arc);
    }
    if let Ok(arc) = Staircase::new(&CIRCLE) {
        walk(count, "staircase", &arc);
    }
    if let Ok(arc) = Staircase::printed(&CIRCLE) {
        walk(count, "staircase_printed", &arc);
    }
    if let Ok(arc) = ArcDda::new(&CIRCLE) {
        walk(count, "arc_dda", &arc);
    }
    if let Ok(arc) = ArcDda::printed(&CIRCLE) {
        walk(count, "arc_dda_printed", &arc);
    }
}

fn timed(count: Count<'_>, search: &TimedDirectSearch) {
    let events = search.clone().map(|_| 1).sum();
    count("direct_search_timed", events, &mut || {
        for event in black_box(search.clone()) {
            black_box((event.step.axes, event.step.negative, event.wait_ticks));
        }
    });
}
