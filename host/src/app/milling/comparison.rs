//! What a micro mill reports, compared with its strings on a simulated machine.

use super::super::job::Job;
use super::super::{ERRORS, Failure, OK};
use crate::console::reporter::Reporter;
use crate::micromill;
use husillo_backlash::{BacklashModel, Play};
use husillo_clients::micromill::{self as client, Sent, Translated};
use husillo_gcode::Dialect;
use husillo_machine::{Config, Event};
use husillo_sim::observers::AXES;
use husillo_sim::text::grouped;
use husillo_simulator::programs::feeder;
use husillo_simulator::programs::setup::{self, Engine};
use husillo_simulator::programs::source::Source;
use husillo_simulator::simulation::work_piece::WorkPiece;
use husillo_transports::micromill::State;
use serde_json::json;
use std::fmt;
use std::io;

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
    out: &mut Reporter<'_>,
) -> Result<u8, Failure> {
    let expected = expected(job, micromill::text(&made.lines), start)?;
    out.text(format_args!("Lines      {} made", sent.lines));
    if start.is_none() {
        out.text(
            "State      unknown: the controller does not report position, work zero and backlash; \
             compared with a start at machine zero",
        );
    }
    let steps = Steps::new(every, &expected.steps, sent);
    let position = Position::new(&expected.end, start, sent);
    out.text(&steps);
    if let Some(position) = &position {
        out.text(position);
    }
    let is_well = steps.is_same() && position.as_ref().is_none_or(Position::is_same);
    out.object(&json!({
        "kind": "made",
        "lines": sent.lines,
        "steps_expected": steps.expected,
        "steps_reported": steps.reported,
        "first_different_step": steps.different,
        "position_steps": position.as_ref().map(|position| position.reported),
        "expected_position_steps": position.as_ref().map(|position| position.expected),
        "is_as_simulated": is_well,
    }));
    Ok(if is_well { OK } else { ERRORS })
}

/// The reported steps and those of the simulator.
struct Steps {
    expected: u64,
    reported: u64,
    /// One step in this number is reported; 0: none.
    every: u16,
    /// Number of the first step that differs, from 1.
    different: Option<usize>,
}

impl Steps {
    fn new(every: u16, expected: &[(u8, bool)], sent: &Sent) -> Self {
        let pairs = sent.steps.iter().zip(expected);
        let different = pairs.into_iter().position(|(ours, theirs)| ours != theirs);
        Self {
            expected: expected.len() as u64,
            reported: sent.steps.len() as u64 * u64::from(every.max(1)),
            every,
            different: different.filter(|_| every == 1).map(|place| place + 1),
        }
    }

    /// Whether no report differs.
    fn is_same(&self) -> bool {
        self.every != 1 || (self.different.is_none() && self.reported == self.expected)
    }
}

impl fmt::Display for Steps {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (count, reported) = (grouped(self.expected), grouped(self.reported));
        match self.different {
            _ if self.every != 1 => write!(f, "Steps      about {reported} reported of {count}"),
            Some(step) => {
                let step = grouped(step as u64);
                write!(f, "Steps      step {step} is not the simulator's")
            }
            None if self.is_same() => write!(f, "Steps      {count}, each as in the simulator"),
            None => write!(
                f,
                "Steps      {reported} reported, {count} in the simulator"
            ),
        }
    }
}

/// Where the mill and the simulator end, in steps from machine zero.
struct Position {
    reported: [i32; 3],
    expected: [i32; 3],
    is_homed: bool,
}

impl Position {
    /// `None`: before homing, positions count from where the mill was switched on.
    fn new(expected: &[i32; AXES], start: Option<State>, sent: &Sent) -> Option<Self> {
        start.filter(|start| start.is_homed)?;
        let end = sent.state?;
        let [x, y, z, ..] = *expected;
        Some(Self {
            reported: end.axes.map(|axis| axis.load_steps),
            expected: [x, y, z],
            is_homed: end.is_homed,
        })
    }

    fn is_same(&self) -> bool {
        self.is_homed && self.reported == self.expected
    }
}

impl fmt::Display for Position {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [x, y, z] = self.reported;
        if self.is_same() {
            return write!(f, "Position   x {x} y {y} z {z} steps from machine zero");
        }
        let [to_x, to_y, to_z] = self.expected;
        write!(
            f,
            "Position   x {x} y {y} z {z} steps, in the simulator x {to_x} y {to_y} z {to_z}"
        )
    }
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
        Some(axis) => Play::at(axis.backlash_steps, axis.ahead_steps, axis.load_steps),
        None => Play::at(0, 0, 0),
    });
    let mut machine = Engine::<Play>::with_backlash(config, plays);
    let at = client::position(&start, &setup::first_three(&config));
    machine
        .place(setup::padded(client::work_zero(&start)), setup::padded(at))
        .map_err(|error| error.to_string())?;
    run(machine, text)
}

fn run<L: BacklashModel<AXES> + 'static>(
    mut machine: Engine<L>,
    text: String,
) -> Result<Expected, Failure> {
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
