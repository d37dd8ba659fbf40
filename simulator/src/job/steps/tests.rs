//! The kept entries against the engine and against the list of steps.

use super::*;
use crate::job::{Text, Zero};
use crate::machines::machine_file::MachineFile;
use crate::programs::setup;
use husillo_stepper::{Drive, Motors};

/// Lines, an arc, a helix, reversals and a dwell.
const PROGRAM: &str = "G21 G90 F600\nG0 X5 Y5\nG1 X6 Y5.5\nG4 P0.2\nG2 X7 Y6.5 I0.5 J0.5\n\
                       G3 X7 Y6.5 Z-0.5 I-0.4 J0.2\nG1 X5 Y5 Z0\nM2\n";

fn job(machine: &str) -> Job {
    let machine = MachineFile::built_in(machine).unwrap();
    let mut job = Job::new(Text::new("p.nc", PROGRAM.as_bytes()), machine, None).unwrap();
    job.place(Some(Zero::Fit)).unwrap();
    job
}

/// The machine after each event, from the engine itself.
fn expected(job: &Job) -> Vec<Instant> {
    let mut engine = job.engine(true).unwrap();
    let mut mechanics = Mechanics::new(&job.machine, false).unwrap();
    mechanics.start_at(engine.position_steps());
    let mut all = Vec::new();
    let (mut source, piece) = (job.open().unwrap(), job.piece());
    feeder::feed(&mut source, &mut engine, &piece, |engine, event| {
        match event {
            Event::Step(step) => mechanics.step(step),
            Event::Dwell { wait_ticks } => {
                mechanics.rest(*wait_ticks);
                return Ok(());
            }
            _ => return Ok(()),
        }
        all.push(Instant {
            event: mechanics.events(),
            ticks: mechanics.ticks(),
            commanded: engine.position_steps(),
            tool: mechanics.tool(),
            levels: mechanics.levels().each_ref().map(|levels| levels.0),
            is_take_up: engine.origin() == Origin::TakeUp,
        });
        Ok(())
    })
    .unwrap();
    all
}

/// In any order, with everything kept and with parts that are made again.
#[test]
fn every_step_is_that_of_the_engine() {
    for machine in ["micromill", "router", "free6"] {
        let expected = expected(&job(machine));
        assert!(expected.len() > 5_000, "{machine}: {}", expected.len());
        for kept in [KEPT, 3_000] {
            let mut steps = Steps::with_kept(job(machine), true, false, kept).unwrap();
            assert_eq!(steps.events(), expected.len() as u64);
            let strides = (0..expected.len()).step_by(977);
            let all = strides
                .clone()
                .chain(strides.rev())
                .chain([0, 1, 1023, 1024]);
            for index in all {
                let wanted = expected[index];
                assert_eq!(
                    steps.at(wanted.event).unwrap(),
                    Some(wanted),
                    "{machine} {index}"
                );
                let there = steps.at_ticks(wanted.ticks).unwrap();
                assert!(there.event >= wanted.event && there.ticks == wanted.ticks);
                let before = steps.at_ticks(wanted.ticks - 1).unwrap();
                assert!(before.event < wanted.event, "{machine} {index}");
            }
            let last = expected[expected.len() - 1];
            let end = steps.at_ticks(u64::MAX).unwrap();
            assert_eq!((end.event, end.tool), (last.event, last.tool));
            assert_eq!(steps.at(last.event + 1).unwrap(), None);
            let start = job(machine).engine(true).unwrap().position_steps();
            assert_eq!(steps.at(0).unwrap().unwrap().tool, start);
        }
    }
}

/// The columns are those of `husillo steps`.
#[test]
fn rows_are_the_list_of_steps() {
    let mut steps = Steps::with_kept(job("micromill"), true, false, 3_000).unwrap();
    let mut csv = Vec::new();
    steps.job().write_steps(true, false, &mut csv).unwrap();
    let csv = String::from_utf8(csv).unwrap();
    let (mut made, mut events, mut at) = (String::from("event,wait_ticks,dx,dy,dz\n"), 0, 0);
    while at < steps.entries() {
        let rows = steps.rows(at, 2_000).unwrap();
        assert!(!rows.wait_ticks.is_empty());
        for (wait, delta) in rows.wait_ticks.iter().zip(rows.delta.chunks(3)) {
            events += u32::from(delta != [0; 3]);
            made += &format!("{events},{wait},{},{},{}\n", delta[0], delta[1], delta[2]);
        }
        at += rows.wait_ticks.len() as u64;
    }
    assert_eq!(made, csv);
    assert_eq!(steps.rows(at, 10).unwrap(), Rows::default());
}

/// A mark for each 1024 entries is affordable.
#[test]
fn a_mark_is_small() {
    let motors: Motors<AXES, Drive> = setup::motors(&job("micromill").machine).unwrap();
    let bytes = size_of_val(&motors) + size_of::<Mechanics>();
    assert!(bytes < 4096, "{bytes}");
}
