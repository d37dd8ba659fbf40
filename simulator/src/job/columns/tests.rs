//! Batches against the list of `husillo steps`.

use super::*;
use crate::diagnostics::Findings;
use crate::job::{Job, Options, Text};
use crate::machines::machine_file::MachineFile;
use std::cell::RefCell;
use std::rc::Rc;

const PROGRAM: &str = "G21 G90 F60\nG0 X1 Y1\nG1 X2\n\nG4 P0.25\nG2 X0 Y1 I-1 J0\nG1 X1\nM2\n";

/// The batches of the program, and its steps as CSV.
fn batches(size: usize) -> (Vec<Columns>, String) {
    let machine = MachineFile::built_in("micromill").unwrap();
    let mut job = Job::new(Text::new("p.nc", PROGRAM.as_bytes()), machine, None).unwrap();
    job.place(Some("X5Y5Z-5".parse().unwrap())).unwrap();
    let mut facts = job.check(&mut Findings::new(10)).unwrap();
    let lines = std::mem::take(&mut facts.origins).into_lines();
    let start = job.engine(true).unwrap().position_steps();
    let passed = Rc::new(RefCell::new(Vec::new()));
    let all = Rc::clone(&passed);
    let observer = Batches::new(3, size, start, lines, move |batch| {
        all.borrow_mut().push(batch);
        Ok(())
    });
    let options = Options {
        observer: Some(Box::new(observer)),
        ..Options::default()
    };
    job.simulate(&mut facts, options, || {}).unwrap();
    let mut csv = Vec::new();
    job.write_steps(true, false, &mut csv).unwrap();
    let batches = passed.borrow().clone();
    (batches, String::from_utf8(csv).unwrap())
}

fn joined(batches: &[Columns]) -> Columns {
    let mut all = Columns::default();
    for batch in batches {
        all.wait_ticks.extend(&batch.wait_ticks);
        all.kind.extend(&batch.kind);
        all.line.extend(&batch.line);
        all.delta.extend(&batch.delta);
        all.commanded.extend(&batch.commanded);
        all.tool.extend(&batch.tool);
    }
    all
}

#[test]
fn the_columns_are_the_list_of_steps() {
    let (batches, csv) = batches(1000);
    assert!(batches.len() > 3);
    assert!(
        batches[..batches.len() - 1]
            .iter()
            .all(|batch| batch.len() == 1000)
    );
    let all = joined(&batches);
    let mut count = 0;
    for ((row, delta), (wait, kind)) in (csv.lines().skip(1))
        .zip(all.delta.chunks(3))
        .zip(all.wait_ticks.iter().zip(&all.kind))
    {
        count += usize::from(*kind != Kind::Wait as u8);
        let [x, y, z] = [delta[0], delta[1], delta[2]];
        assert_eq!(row, format!("{count},{wait},{x},{y},{z}"));
    }
    assert_eq!(csv.lines().count() - 1, all.len());
}

#[test]
fn the_size_of_a_batch_changes_nothing() {
    let (whole, _) = batches(usize::MAX);
    assert_eq!(whole.len(), 1);
    let (small, _) = batches(7);
    assert_eq!(joined(&small), whole[0]);
}

#[test]
fn entries_have_the_lines_of_their_moves_and_the_positions_after_them() {
    let (whole, _) = batches(usize::MAX);
    let all = &whole[0];
    let mut lines = all.line.clone();
    lines.dedup();
    assert_eq!(lines, [2, 3, 0, 6, 7]);
    let waits = all.kind.iter().zip(&all.line);
    assert!(waits.clone().any(|(kind, line)| *kind == 0 && *line == 0));
    // Without a map of backlash, the controller moves with each step that is no take-up.
    let mut at =
        [5_000_000, 5_000_000, -5_000_000].map(|nm: i32| (f64::from(nm) / 140.0).round() as i32);
    for (index, kind) in all.kind.iter().enumerate() {
        if *kind != Kind::TakeUp as u8 {
            let delta = &all.delta[3 * index..];
            at.iter_mut()
                .zip(delta)
                .for_each(|(at, delta)| *at += i32::from(*delta));
        }
        assert_eq!(all.commanded[3 * index..3 * index + 3], at);
    }
    // The tool ends where the controller is: nothing is lost.
    assert_eq!(all.tool[all.tool.len() - 3..], at);
    assert!(all.kind.contains(&(Kind::TakeUp as u8)));
}

#[test]
fn a_run_ends_where_a_batch_is_refused() {
    let machine = MachineFile::built_in("free").unwrap();
    let mut job = Job::new(Text::new("p.nc", PROGRAM.as_bytes()), machine, None).unwrap();
    let mut facts = job.check(&mut Findings::new(10)).unwrap();
    let observer = Batches::new(3, 10, [0; AXES], Lines::default(), |_| {
        Err(io::Error::other("enough"))
    });
    let options = Options {
        observer: Some(Box::new(observer)),
        ..Options::default()
    };
    let ended = job.simulate(&mut facts, options, || {}).unwrap_err();
    assert!(ended.to_string().contains("enough"));
}
