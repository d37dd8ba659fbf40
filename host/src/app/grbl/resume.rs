//! A program from one of its lines on, with the modes and at the position of the lines before.

use super::Numbered;
use crate::app::job::{Job, whole};
use crate::console::stop::stops_asked;
use crate::console::typed::typed_line;
use husillo_clients::grbl::Sender;
use husillo_gcode::{Distance, FeedMode, Modal, Motion, Nm, Plane, SpindleDirection, Units};
use husillo_sim::observers::AXES;
use husillo_simulator::diagnostics::Findings;
use husillo_simulator::programs::program;
use husillo_simulator::programs::source::Source;
use std::io::Cursor;

/// The lines from line `from` on. Before them come lines that raise the tool, go to the start of
/// line `from`, switch on what was on, lower the tool at the feed, and restore the modes.
pub(super) fn from(
    job: &Job,
    lines: Numbered,
    from: usize,
    sender: &mut Sender,
) -> Result<Numbered, String> {
    let rest: Vec<_> = lines
        .into_iter()
        .skip_while(|(line, _)| *line < from)
        .collect();
    if rest.is_empty() {
        return Err(format!("--from {from}: the program has no command there"));
    }
    let (modal, highest) = before(job, from)?;
    let session = sender.session();
    session.fresh_status()?;
    session.expect_work_zero()?;
    let present = session.work_position().and_then(|at| at.get(2).copied());
    let high = Nm(highest.0.max(present.unwrap_or(i64::MIN)));
    // A line with a code needs no motion of the lines before.
    let has_code = rest
        .first()
        .is_some_and(|(_, line)| line.contains(['G', 'g']));
    let begin = approach(&modal, high, has_code).map_err(|why| format!("--from {from}: {why}"))?;
    let begin = begin.into_iter().map(|line| (from, line));
    Ok(begin.chain(rest).collect())
}

/// Asks the operator.
pub(super) fn is_wanted(lines: &[(usize, String)], from: usize) -> bool {
    let before = stops_asked();
    eprintln!("before line {from}, where the lines before it end:");
    for (_, line) in lines.iter().take_while(|(number, _)| *number == from) {
        eprintln!("  {line}");
    }
    eprintln!("Enter sends these and goes on (or q to end)");
    typed_line(before).is_some_and(|answer| !answer.trim().eq_ignore_ascii_case("q"))
}

/// The state after the lines before `from`, and the highest Z of their moves.
fn before(job: &Job, from: usize) -> Result<(Modal<AXES>, Nm), String> {
    let text = match &job.input {
        Some(input) => Ok(input.to_vec()),
        None => whole(&job.file),
    };
    let text = text.map_err(|_| "the program cannot be read again".to_owned())?;
    let head: Vec<u8> = text
        .split_inclusive(|byte| *byte == b'\n')
        .take(from - 1)
        .flatten()
        .copied()
        .collect();
    let mut highest = Nm(0);
    let mut source = Source::from_reader(Box::new(Cursor::new(head)));
    let modal = program::walk(
        &mut source,
        job.name(),
        job.start,
        // The check has reported the errors of the program.
        &mut Findings::new(0),
        |_, _, at, _| {
            highest = highest.max(at[2]);
            Ok(())
        },
    );
    Ok((modal.map_err(|error| error.to_string())?, highest))
}

fn approach(modal: &Modal<AXES>, high: Nm, has_code: bool) -> Result<Vec<String>, &'static str> {
    if [modal.work_offset(), modal.tool_length()] != [[Nm(0); AXES]; 2] {
        return Err("the lines before move the work zero or set a tool length: begin at line 1");
    }
    let [x, y, z, ..] = modal.work_position();
    let mut lines = vec![
        format!("G21 G90 G94 G17 G{}", 54 + modal.work_system()),
        format!("G0 Z{high}"),
        format!("G0 X{x} Y{y}"),
    ];
    let (direction, milli_rpm) = modal.spindle();
    let speed = milli_rpm / 1000;
    match direction {
        SpindleDirection::Clockwise => lines.push(format!("M3 S{speed}")),
        SpindleDirection::CounterClockwise => lines.push(format!("M4 S{speed}")),
        _ => lines.push(format!("S{speed}")),
    }
    let (mist, flood) = modal.coolant();
    lines.extend(mist.then(|| "M7".to_owned()));
    lines.extend(flood.then(|| "M8".to_owned()));
    match modal
        .feed()
        .filter(|_| modal.feed_mode() == FeedMode::PerMinute)
    {
        Some(feed) => lines.push(format!("G1 Z{z} F{feed}")),
        None => lines.push(format!("G0 Z{z}")),
    }
    let plane = match modal.plane() {
        Plane::Xy => "G17",
        Plane::Zx => "G18",
        Plane::Yz => "G19",
    };
    let units = match modal.units() {
        Units::Inches => "G20",
        _ => "G21",
    };
    let distance = match modal.distance() {
        Distance::Absolute => "G90",
        Distance::Incremental => "G91",
    };
    let feed = match modal.feed_mode() {
        FeedMode::InverseTime => "G93",
        _ => "G94",
    };
    let motion = match modal.motion() {
        None => "G80",
        Some(Motion::Rapid) => "G0",
        Some(Motion::Linear) => "G1",
        Some(_) if has_code => "G1",
        Some(_) => {
            return Err(
                "the motion of the lines before is not G0 or G1: name a line with its own code",
            );
        }
    };
    lines.push(format!("{plane} {units} {distance} {feed} {motion}"));
    Ok(lines)
}
