//! Text to moves, and the whole chain below the text: path, take-up, timer.

use core::hint::black_box;

use husillo_backlash::Backlash;
use husillo_gcode::{Block, Dialect, Modal};
use husillo_interp::Path;
use husillo_machine::{Axis, Config, Machine, Scale};

use crate::Count;

const LINES: u32 = 50;
const EVENTS: u32 = 1000;

pub fn all(count: Count<'_>) {
    text(count);
    machine(count);
}

#[inline(never)]
fn text(count: Count<'_>) {
    let dialect = Dialect::RS274;
    let modal = Modal::<3>::new(dialect);
    count("parse_and_plan", LINES, &mut || {
        for _ in 0..LINES {
            let Ok(block) = Block::parse(black_box(b"G1 X12.345 Y-6.789 F600"), &dialect) else {
                return;
            };
            let _ = black_box(black_box(&modal).plan(&block));
        }
    });
}

#[inline(never)]
fn machine(count: Count<'_>) {
    let Some(scale) = Scale::new(140, 1) else {
        return;
    };
    let axis = Axis {
        scale,
        travel: None,
        max_rate_hz: 170,
        lash_steps: 1457,
        ramp: None,
    };
    let config = Config {
        axes: [axis; 3],
        timer_hz: 1_000_000,
        dialect: Dialect::RS274,
        arc_tolerance: None,
        rapid: None,
        top_feed: None,
        corner_deviation: None,
        spindle_counts: None,
    };
    for (name, text) in [
        ("machine_line_event", b"G1 X12.345 Y6.789 F60".as_slice()),
        ("machine_arc_event", b"G3 X0 Y0 I-0.15 J0 F60"),
    ] {
        // With a queue of four moves it fits the RAM of a microbit. An arc is walked here, when it begins.
        let mut machine = Machine::<3, Path<3>, Backlash, 4>::new(config);
        let taken = machine.line(text);
        assert!(taken.is_ok(), "the line means a move");
        machine.next_event();
        count(name, EVENTS, &mut || {
            for _ in 0..EVENTS {
                black_box(machine.next_event());
            }
        });
    }
}
