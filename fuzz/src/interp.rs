//! Any line and any arc.

use husillo_interp::{Arc, ArcMove, Direction, Helix, Interpolator, Line, Rim};

use crate::bytes::Bytes;

/// Longest walk in events.
const MOST_EVENTS: u32 = 100_000;

/// Lines and arcs with any numbers. Each ends exactly at its end point, with the announced number
/// of events and the announced sweep. Every event moves something, by one step per axis.
pub fn interp(data: &[u8]) {
    let mut bytes = Bytes::new(data);
    let chosen = bytes.byte();
    if chosen & 1 == 0 {
        check_line([bytes.i32(), bytes.i32(), bytes.i32(), bytes.i32()]);
        return;
    }
    let fraction_bits = bytes.byte() % 32;
    let from = [bytes.i32(), bytes.i32()];
    let to = [bytes.i32(), bytes.i32()];
    let offset = [bytes.i32(), bytes.i32()].map(i64::from);
    // Half of the centres are near the start; otherwise most arcs would be refused.
    let centre = [0, 1].map(|axis| {
        let near = if chosen & 2 == 0 {
            i64::from(from[axis]) << fraction_bits.min(30)
        } else {
            0
        };
        near + offset[axis]
    });
    let rim = if chosen & 4 == 0 {
        Rim::Spiral
    } else {
        Rim::Nominal {
            start: i64::from(bytes.i32()),
            end: i64::from(bytes.i32()),
        }
    };
    let direction = if chosen & 8 == 0 {
        Direction::Clockwise
    } else {
        Direction::CounterClockwise
    };
    let turns = u32::from(chosen >> 6);
    let along = [0, 0, bytes.i32()];
    check_arc(
        &ArcMove {
            from,
            to,
            centre,
            fraction_bits,
            direction,
            turns,
            rim,
        },
        along,
    );
}

fn check_line(delta: [i32; 4]) {
    let line = Line::new(delta);
    let events = line.events();
    assert_eq!(
        events,
        delta.map(i32::unsigned_abs).into_iter().max().unwrap_or(0)
    );
    if events > MOST_EVENTS {
        line.take(1000).for_each(|step| assert!(step.axes != 0));
        return;
    }
    let mut at = [0_i32; 4];
    for step in line {
        assert_eq!(step.sweep, 1);
        assert!(step.axes != 0);
        for (at, delta) in at.iter_mut().zip(step.deltas::<4>()) {
            *at += i32::from(delta);
        }
    }
    assert_eq!(at, delta, "a line ends at its end");
}

fn check_arc(arc: &ArcMove, along: [i32; 3]) {
    // The dry pass of the set-up walks every event, so a larger arc would only be slow.
    let far = [arc.from, arc.to]
        .iter()
        .flatten()
        .any(|at| at.unsigned_abs() > MOST_EVENTS / 16);
    if far
        || arc
            .centre
            .iter()
            .any(|at| at.unsigned_abs() >> arc.fraction_bits > u64::from(MOST_EVENTS / 16))
    {
        return;
    }
    let Ok(flat) = Arc::new(arc) else {
        return;
    };
    let mut at = arc.from;
    let mut sweep = 0_u64;
    let mut events = 0_u32;
    for step in flat.clone() {
        assert!(step.axes != 0 && step.negative & !step.axes == 0);
        assert!(step.sweep <= flat.largest_sweep());
        sweep += u64::from(step.sweep);
        events += 1;
        for (at, delta) in at.iter_mut().zip(step.deltas::<2>()) {
            *at += i32::from(delta);
        }
    }
    assert_eq!(at, arc.to, "an arc ends at its end");
    assert_eq!((events, sweep), (flat.events(), flat.total_sweep()));
    check_helix(
        arc,
        flat.total_sweep(),
        along,
        [arc.to[0] - arc.from[0], arc.to[1] - arc.from[1]],
    );
}

fn check_helix(arc: &ArcMove, sweep: u64, along: [i32; 3], [dx, dy]: [i32; 2]) {
    if along[2].unsigned_abs() > MOST_EVENTS {
        return;
    }
    let Ok(helix) = Helix::new(arc, [0, 1], along) else {
        return;
    };
    let promised = helix.total_sweep();
    let (mut at, mut swept) = ([0_i32; 3], 0_u64);
    for step in helix {
        assert!(step.axes != 0);
        swept += u64::from(step.sweep);
        for (at, delta) in at.iter_mut().zip(step.deltas::<3>()) {
            *at += i32::from(delta);
        }
    }
    assert_eq!(at, [dx, dy, along[2]], "a helix ends at its end");
    assert_eq!(swept, promised);
    assert!(
        swept >= sweep,
        "the events between share the sweep of the plane, in a finer unit if need be"
    );
}
