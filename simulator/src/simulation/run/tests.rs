//! The recorded speed of moves that follow the spindle.

use super::*;
use crate::programs::feeder;
use crate::programs::setup;
use crate::programs::source::Source;
use crate::simulation::work_piece::WorkPiece;
use husillo_gcode::Dialect;
use husillo_sim::observers::speed::{Band, Column};
use std::io::Cursor;

/// The columns of a program on the built-in lathe.
fn columns(program: &str) -> Vec<Column> {
    let file = MachineFile::built_in("lathe").unwrap();
    let mut run = Run::new(&file, false, None).unwrap();
    let mut machine = setup::with_maps(
        setup::config(&file, Dialect::LATHE).unwrap(),
        setup::maps(&file).unwrap(),
    );
    let text = Cursor::new(program.to_owned().into_bytes());
    let mut source = Source::from_reader(Box::new(text));
    feeder::feed(
        &mut source,
        &mut machine,
        &WorkPiece::default(),
        |machine, event| run.event(machine, event),
    )
    .unwrap();
    run.finish().unwrap();
    run.observers.speed.columns().0.to_vec()
}

/// Largest value in mm/min.
fn largest(columns: &[Column], band: fn(&Column) -> Band) -> f64 {
    let highest = columns.iter().map(|column| band(column).high);
    f64::from(highest.fold(0.0, f32::max)) * 60e-6
}

/// Each pass of a thread is a feed at the lead times the turns per minute. This holds for a single
/// pass and for those of a cycle.
#[test]
fn a_pass_of_a_thread_is_a_feed() {
    const THREAD: &str = include_str!("../../../../examples/thread.nc");
    let on = "G21 G90 G18 G8 M3 S600\nG0 X10 Z5\nG4 P1\n";
    let cycle = format!("{on}G76 P1.5 Z-20 I-1 J0.3 R1 K0.9 Q29.5 H1 E0 L0\nM30\n");
    let slower = format!("{on}S300\nG4 P1\nG33 Z-20 K1.5\nM30\n");
    // The machine makes all rapids of the cycle.
    for (program, expected) in [(THREAD, 900.0), (&cycle, 900.0), (&slower, 450.0)] {
        let columns = columns(program);
        let programmed = largest(&columns, |column| column.programmed);
        assert!((programmed - expected).abs() < 1e-3, "{programmed}");
        let feed = largest(&columns, |column| column.feed);
        assert!((feed / expected - 1.0).abs() < 0.05, "{feed}");
        // Only the columns at the ends of a pass may also show a rapid.
        let is_cut = |column: &&Column| column.programmed.high * 60e-6 > 0.9 * expected as f32;
        let cut: Vec<_> = columns.iter().filter(is_cut).collect();
        assert!(cut.len() > 20, "{}", cut.len());
        let rapids = cut.iter().filter(|column| !column.rapid.is_empty());
        assert!(
            rapids.clone().count() < cut.len() / 10,
            "{}",
            rapids.count()
        );
    }
}

/// The same holds for a feed per turn.
#[test]
fn a_feed_per_turn_has_a_programmed_speed() {
    let columns = columns("G21 G90 G18 G8 M3 S600\nG4 P1\nG95 G1 Z-5 F0.2\nM30\n");
    let programmed = largest(&columns, |column| column.programmed);
    assert!((programmed - 120.0).abs() < 1e-3, "{programmed}");
    let feed = largest(&columns, |column| column.feed);
    assert!((feed / 120.0 - 1.0).abs() < 0.05, "{feed}");
}
