//! What is counted.

use core::hint::black_box;

use husillo_backlash::{Backlash, Compensator, Flank};
use husillo_gcode::{Block, Dialect, Modal};
use husillo_interp::{Arc, ArcMove, Direction, Line, Rim};
use husillo_machine::{Axis, Config, Machine, Scale};
use husillo_planner::Timer;
use husillo_stepper::{CoilDriver, Driver, Mode, Sequencer};

/// Takes a name, a number of turns and what to do that many times.
type Report<'a> = &'a mut dyn FnMut(&str, u32, &mut dyn FnMut(u32));

/// Hands every kernel to `report`.
pub fn all(report: Report<'_>) {
    report("empty_loop", 1000, &mut |turns| {
        for _ in 0..turns {
            black_box(());
        }
    });
    lines(report);
    arcs(report);
    timer(report);
    text(report);
    motors(report);
    machine(report);
}

fn motors(report: Report<'_>) {
    report("sequencer_step", 1000, &mut |turns| {
        let Ok(mut motor) = black_box(Sequencer::new(Driver::A3988, Mode::Half)) else {
            return;
        };
        for _ in 0..turns {
            black_box(motor.step(black_box(1)));
        }
    });
    report("compensator_straight_on", 1000, &mut |turns| {
        let axis = Backlash::new(1457, Flank::Positive);
        let mut stage = black_box(Compensator::new([axis, axis, axis]));
        for _ in 0..turns {
            black_box(stage.before(black_box(&[1, 1, 0]), black_box([10, 20, 30])));
        }
    });
    report("compensator_reversal", 1000, &mut |turns| {
        let axis = Backlash::new(1457, Flank::Positive);
        let mut stage = black_box(Compensator::new([axis, axis, axis]));
        let mut delta = [1_i8, 1, 0];
        for _ in 0..turns {
            delta[0] = -delta[0];
            black_box(stage.before(black_box(&delta), black_box([10, 20, 30])));
        }
    });
}

fn lines(report: Report<'_>) {
    report("line_3_axes", 1000, &mut |turns| {
        let mut line = black_box(Line::new([1_000_000, -500_000, 7]));
        for _ in 0..turns {
            black_box(line.next());
        }
    });
    report("line_6_axes", 1000, &mut |turns| {
        let mut line = black_box(Line::new([1_000_000, -500_000, 7, 333_333, 0, 999_999]));
        for _ in 0..turns {
            black_box(line.next());
        }
    });
}

/// Set up once for both lengths: its dry pass walks the whole arc.
fn arcs(report: Report<'_>) {
    let circle = ArcMove {
        from: [500, 0],
        to: [500, 0],
        centre: [0, 0],
        fraction_bits: 16,
        direction: Direction::CounterClockwise,
        turns: 0,
        rim: Rim::Spiral,
    };
    let narrow = Arc::new(&circle);
    let wide = Arc::wide(&circle);
    for (name, arc) in [("arc_32_bits", &narrow), ("arc_64_bits", &wide)] {
        let Ok(arc) = arc else {
            return;
        };
        report(name, 1000, &mut |turns| {
            let mut arc = black_box(arc.clone());
            for _ in 0..turns {
                black_box(arc.next());
            }
        });
    }
}

fn timer(report: Report<'_>) {
    report("timer_wait", 1000, &mut |turns| {
        let mut timer = black_box(Timer::new(123_456_789, 1 << 34, 1 << 25));
        for _ in 0..turns {
            black_box(timer.wait(black_box(12_345_678)));
        }
    });
}

fn text(report: Report<'_>) {
    let dialect = Dialect::RS274;
    let modal = Modal::<3>::new(dialect);
    report("parse_and_plan", 50, &mut |turns| {
        for _ in 0..turns {
            let Ok(block) = Block::parse(black_box(b"G1 X12.345 Y-6.789 F600"), &dialect) else {
                return;
            };
            let _ = black_box(black_box(&modal).plan(&block));
        }
    });
}

/// The whole chain below the text: path, take-up, timer.
fn machine(report: Report<'_>) {
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
    };
    for (name, text) in [
        ("machine_line_event", b"G1 X12.345 Y6.789 F60".as_slice()),
        ("machine_arc_event", b"G3 X0 Y0 I-0.15 J0 F60"),
    ] {
        // Set up once: an arc is walked when it begins.
        let mut machine = Machine::<3>::new(config);
        let taken = machine.line(text);
        assert!(taken.is_ok(), "the line means a move");
        machine.next_event();
        report(name, 1000, &mut |turns| {
            let mut machine = machine.clone();
            for _ in 0..turns {
                black_box(machine.next_event());
            }
        });
    }
}
