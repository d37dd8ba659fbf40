//! Sequences of short moves.

use crate::{
    checker::{check_axes, check_path},
    moves::{Move, polyline},
    runner::run,
};

const HZ: u32 = 32_000_000;

/// From the first event at top speed to the last one, no event takes more than a tick longer than
/// at constant speed.
fn assert_no_dip(moves: &[Move]) {
    let events = run::<32>(moves, HZ, &[]).events;
    let time = |event: &crate::runner::Event| {
        let top = f64::from(moves[event.of].stretch.top_nm_per_s);
        event.length_nm * f64::from(HZ) / top
    };
    let is_slow = |event: &crate::runner::Event| event.ticks as f64 > time(event) + 1.0;
    let first = events.iter().position(|event| !is_slow(event)).unwrap();
    let last = events.iter().rposition(|event| !is_slow(event)).unwrap();
    let top = f64::from(moves[0].stretch.top_nm_per_s);
    // The length of a ramp from 0 to top, and one event more.
    let ramp = top * top / (2.0 * moves[0].stretch.acceleration_nm_per_s2 as f64);
    let length =
        |range: &[crate::runner::Event]| range.iter().map(|event| event.length_nm).sum::<f64>();
    assert!(length(&events[..first]) < ramp + 2000.0);
    assert!(length(&events[last + 1..]) < ramp + 2000.0);
    let dip = events[first..=last].iter().find(|event| is_slow(event));
    assert!(dip.is_none(), "{dip:?}");
    check_path(moves, &events, HZ, 1.0, true);
    check_path(moves, &events, HZ, 20_000.0, true);
    check_axes(moves, &events, HZ, true);
}

#[test]
fn a_thousand_moves_on_a_line_never_slow_down() {
    let points: Vec<_> = (1..=1000)
        .map(|number| ([number * 20_000, number * 6_000], 10_000_000))
        .collect();
    assert_no_dip(&polyline(&points));
}

/// A circle of 3.2 mm radius in chords of 20 um.
#[test]
fn a_thousand_moves_round_a_circle_never_slow_down() {
    let radius = 20_000.0 * 1000.0 / std::f64::consts::TAU;
    let points: Vec<_> = (0..=1000)
        .map(|number| {
            let angle = f64::from(number) * std::f64::consts::TAU / 1000.0;
            (
                [(radius * angle.cos()) as i64, (radius * angle.sin()) as i64],
                10_000_000,
            )
        })
        .collect();
    // The first line goes from zero to the rim.
    let mut moves = polyline(&points);
    moves.remove(0);
    moves[0].stretch.entry_limit_nm_per_s = 0;
    assert_no_dip(&moves);
}
