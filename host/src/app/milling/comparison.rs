//! What a micro mill reports, compared with its strings on a simulated machine.

use super::super::job::Job;
use super::super::{ERRORS, Failure, OK};
use crate::micromill;
use crate::programs::feeder;
use crate::programs::setup::{self, Engine};
use crate::programs::source::Source;
use crate::simulation::work_piece::WorkPiece;
use husillo_backlash::{Lash, Play};
use husillo_clients::micromill::{self as client, Sent, Translated};
use husillo_gcode::Dialect;
use husillo_machine::{Config, Event};
use husillo_sim::observers::AXES;
use husillo_transports::micromill::State;
use std::io::{self, Write};

/// What the simulated machine makes of the strings.
struct Expected {
    /// Axis, and whether forward, in the order in which a controller reports the steps.
    steps: Vec<(u8, bool)>,
    /// Positions of the loads at the end, in steps from machine zero.
    end: [i32; AXES],
}

/// Prints the comparison. Returns the exit status. The mill began in the state `start`, where it
/// reports that.
pub(super) fn compared(
    job: &Job,
    every: u16,
    made: &Translated,
    start: Option<State>,
    sent: &Sent,
    out: &mut dyn Write,
) -> Result<u8, Failure> {
    let expected = expected(job, micromill::text(&made.lines), start)?;
    writeln!(out, "Lines      {} made", sent.lines)?;
    if start.is_none() {
        writeln!(
            out,
            "State      unknown: the controller does not report position, work zero and backlash; \
             compared with a start at machine zero"
        )?;
    }
    let is_same = steps(every, &expected.steps, sent, out)?;
    let is_there = position(&expected.end, start, sent, out)?;
    Ok(if is_same && is_there { OK } else { ERRORS })
}

/// Whether the reported steps are those of the simulator.
fn steps(
    every: u16,
    expected: &[(u8, bool)],
    sent: &Sent,
    out: &mut dyn Write,
) -> io::Result<bool> {
    let (count, reported) = (expected.len(), sent.steps.len());
    if every != 1 {
        let reported = reported as u64 * u64::from(every.max(1));
        writeln!(out, "Steps      about {reported} reported of {count}")?;
        return Ok(true);
    }
    let differs = (sent.steps.iter().zip(expected)).position(|(ours, theirs)| ours != theirs);
    if let Some(place) = differs {
        let step = place + 1;
        writeln!(out, "Steps      step {step} is not the simulator's")?;
        return Ok(false);
    }
    if reported != count {
        writeln!(
            out,
            "Steps      {reported} reported, {count} in the simulator"
        )?;
        return Ok(false);
    }
    writeln!(out, "Steps      {count}, each as in the simulator")?;
    Ok(true)
}

/// Whether the mill ends where the simulator does.
fn position(
    expected: &[i32; AXES],
    start: Option<State>,
    sent: &Sent,
    out: &mut dyn Write,
) -> io::Result<bool> {
    // Before homing, positions count from where the mill was switched on.
    let (Some(_), Some(end)) = (start.filter(|start| start.is_homed), sent.state) else {
        return Ok(true);
    };
    let [x, y, z] = end.axes.map(|axis| axis.load_steps);
    let [to_x, to_y, to_z, ..] = expected;
    if [x, y, z] == [*to_x, *to_y, *to_z] && end.is_homed {
        writeln!(out, "Position   x {x} y {y} z {z} steps from machine zero")?;
        return Ok(true);
    }
    writeln!(
        out,
        "Position   x {x} y {y} z {z} steps, in the simulator x {to_x} y {to_y} z {to_z}"
    )?;
    Ok(false)
}

/// The strings on a simulated machine in the state `start`, or at machine zero with the backlash of
/// the machine file.
fn expected(job: &Job, text: String, start: Option<State>) -> Result<Expected, Failure> {
    let config = Config {
        dialect: Dialect::MICROMILL,
        ..job.config
    };
    let Some(start) = start else {
        return run(setup::with_maps(config, setup::maps(&job.machine)?), text);
    };
    let plays = std::array::from_fn(|axis| match start.axes.get(axis) {
        Some(axis) => Play::at(axis.lash_steps, axis.ahead_steps, axis.load_steps),
        None => Play::at(0, 0, 0),
    });
    let mut machine = Engine::<Play>::with_lash(config, plays);
    let at = client::position(&start, &setup::first_three(&config));
    machine
        .place(setup::padded(client::work_zero(&start)), setup::padded(at))
        .map_err(|error| error.to_string())?;
    run(machine, text)
}

fn run<L: Lash<AXES> + 'static>(mut machine: Engine<L>, text: String) -> Result<Expected, Failure> {
    let mut source = Source::from_reader(Box::new(io::Cursor::new(text.into_bytes())));
    let mut steps = Vec::new();
    feeder::feed(
        &mut source,
        &mut machine,
        &WorkPiece::default(),
        |_, event| {
            if let Event::Step(step) = event {
                for (axis, delta) in (0..3).zip(step.delta) {
                    if delta != 0 {
                        steps.push((axis, delta > 0));
                    }
                }
            }
            Ok(())
        },
    )?;
    Ok(Expected {
        steps,
        end: machine.position_steps(),
    })
}
