//! A program from one of its lines on, with the modes and at the position of the lines before.

use super::Numbered;
use crate::app::job::{Job, whole};
use crate::console::stop::stops_asked;
use crate::console::typed::typed_line;
use husillo_clients::grbl::Sender;
use husillo_gcode::{
    Command, Distance, FeedMode, Modal, Motion, Nm, Plane, SpindleDirection, Units,
};
use husillo_sim::observers::AXES;
use husillo_simulator::diagnostics::Findings;
use husillo_simulator::programs::program::{self, Meaning, Start};
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
    let (_, first) = rest
        .first()
        .ok_or_else(|| format!("--from {from}: the program has no command there"))?;
    let text = match &job.input {
        Some(input) => Ok(input.to_vec()),
        None => whole(&job.file),
    };
    let text = text.map_err(|_| "the program cannot be read again".to_owned())?;
    let before = Before::line(from, &text, "", job.name(), job.start)?;
    let session = sender.session();
    session.fresh_status()?;
    session.expect_work_zero()?;
    let present = session.work_position().and_then(|at| at.get(2).copied());
    let begin = before.approach(present.map(Nm), first);
    let begin = begin.map_err(|why| format!("--from {from}: {why}"))?;
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

/// The state of a program before one of its lines.
#[derive(Clone, Debug)]
pub struct Before {
    /// The modes and the position.
    pub modal: Modal<AXES>,
    /// The highest Z of the lines before, at least 0, in work coordinates.
    highest: Nm,
    /// The lines before do not move the work zero, and set no tool length.
    is_plain: bool,
}

impl Before {
    /// The state before line `from` of a text. `modes` is a line with the modes in which the
    /// program begins; empty for those of the start.
    ///
    /// # Errors
    ///
    /// The text cannot be read. Or the lines before have an error, because the program begins at
    /// another position than that of its check: an arc has no radius there.
    pub fn line(
        from: usize,
        text: &[u8],
        modes: &str,
        name: &str,
        start: Start,
    ) -> Result<Self, String> {
        let head = text.split_inclusive(|byte| *byte == b'\n');
        let head: Vec<u8> = head
            .take(from.saturating_sub(1))
            .flatten()
            .copied()
            .collect();
        let whole = [modes.as_bytes(), b"\n", &head].concat();
        let mut source = Source::from_reader(Box::new(Cursor::new(whole)));
        let mut highest = None;
        let mut findings = Findings::new(0);
        let each = |_: &Meaning<'_>, _: &Command<AXES>, at: [Nm; AXES], _: &mut Findings| {
            highest = highest.max(Some(at[2]));
            Ok(())
        };
        let modal = program::walk(&mut source, name, start, &mut findings, each);
        let modal = modal.map_err(|error| error.to_string())?;
        if findings.errors > 0 {
            return Err("the lines before have errors at the position of the machine".into());
        }
        // Machine coordinates less this are work coordinates.
        let zero = modal.position()[2].0 - modal.work_position()[2].0;
        let highest = highest.map_or(0, |Nm(high)| high - zero);
        let end = modal.work_position()[2];
        let own = start.frames.get(usize::from(modal.work_system()));
        let zero = own.copied().flatten().unwrap_or(start.zero);
        let is_plain = modal.work_offset() == zero && modal.tool_length() == [Nm(0); AXES];
        Ok(Self {
            is_plain,
            highest: Nm(highest).max(end).max(Nm(0)),
            modal,
        })
    }

    /// The lines that lead to this state: they raise the tool above all lines before and the
    /// present Z, go to the position, switch on what was on, lower the tool at the feed, and
    /// restore the modes. `next` is the line that follows.
    ///
    /// # Errors
    ///
    /// A sentence about a state that such lines cannot restore.
    pub fn approach(&self, present: Option<Nm>, next: &str) -> Result<Vec<String>, &'static str> {
        if !self.is_plain {
            return Err(
                "the lines before move the work zero or set a tool length: begin at line 1",
            );
        }
        // A line with a code needs no motion of the lines before.
        let has_code = next.contains(['G', 'g']);
        let high = present.map_or(self.highest, |present| self.highest.max(present));
        approach(&self.modal, high, has_code)
    }
}

fn approach(modal: &Modal<AXES>, high: Nm, has_code: bool) -> Result<Vec<String>, &'static str> {
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
    lines.push(modes(modal, has_code)?.join(" "));
    Ok(lines)
}

/// The codes of plane, units, distances, feeds and motion.
fn modes(modal: &Modal<AXES>, has_code: bool) -> Result<[&'static str; 5], &'static str> {
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
    Ok([plane, units, distance, feed, motion])
}
