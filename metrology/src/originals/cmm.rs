//! The measuring machine: the repeatability of positions and touches. The original states one
//! number for each.

use super::{Parameter, Row, Table};
use crate::error::Error;
use crate::heads::{Head, Line, Machine};
use crate::simulated::{Contact, SimulatedNetwork, SimulatedPort, one_axis};
use husillo_probe::UnitVector;
use husillo_transports::nmc::Gains;

/// The stated repeatability of positions and of touches, in counts, in both directions.
const STATED_COUNTS: f64 = 1.0;
/// The gains of the original. It does not state the other settings of its modules.
const GAINS: Gains = Gains {
    proportional: 100,
    integral: 0,
    derivative: 10_000,
    integration_limit: 0,
    output_limit: 255,
    current_limit: 0,
    error_limit: 4000,
    rate_divisor: 1,
    dead_band: 0,
    step_multiplier: None,
};
/// The dead band, of 255. It is just below the output of 15 that overcomes the stiction of the
/// simulated motor.
const DEAD_BAND: u8 = 14;
/// Distance from a goal at which a move with these gains may end, counts. It is more than the
/// distance at which friction holds the simulated motor.
const NEAR: u32 = 30;
/// Lengths of the moves, counts. They are repeated in both directions.
const MOVES: [i64; 10] = [1, 2, 5, 13, 40, 99, 250, 777, 1200, 2503];
/// Position of the face, counts.
const FACE: i64 = 1000;
/// Distances from which the face is touched, counts.
const FROM: [i64; 8] = [150, 163, 201, 250, 333, 418, 505, 777];
/// The axis is at rest after this number of equal readings.
const AT_REST: u32 = 20;
/// How often each distance and each move is repeated.
const TIMES: usize = 3;

type SimulatedHead = Head<SimulatedPort>;

/// Repeats positions and touches on the simulated axis, with the gains of the original and with
/// those of today.
///
/// # Errors
///
/// The simulated machine reports a failure.
pub fn repeatability() -> Result<Table, String> {
    let today = one_axis();
    let said = |error: Error| error.to_string();
    let with = |dead_band| {
        let mut machine = one_axis();
        machine.axes[0].gains = Gains { dead_band, ..GAINS };
        machine.axes[0].in_position = NEAR;
        machine
    };
    let original = with(DEAD_BAND);
    let positions = |machine: &Machine| farthest(machine).map_err(said);
    let touches = |machine: &Machine| touched(machine).map_err(said);
    let plain = positions(&with(0))?;
    let row = |name, rebuilt, today| {
        Row::new(name, "counts", STATED_COUNTS, STATED_COUNTS)
            .rebuilt(rebuilt)
            .today(today, 0.0)
    };
    Ok(Table {
        number: "results",
        title: "repeatability of positions and touches",
        spread: "1 count: the original states only that nothing was farther away",
        rows: vec![
            row(
                "positions, largest deviation",
                positions(&original)?,
                positions(&today)?,
            ),
            row(
                "touches, half of the range",
                touches(&original)?,
                touches(&today)?,
            ),
        ],
        parameters: vec![
            Parameter::new("gains", "P 100, I 0, D 10000".into(), "the original"),
            Parameter::new(
                "dead band",
                format!("{DEAD_BAND} of 255"),
                "fitted: just below the stiction of the simulated motor; not stated by the \
                original",
            ),
            Parameter::new(
                "trials",
                format!(
                    "{} moves, {} touches",
                    2 * TIMES * MOVES.len(),
                    2 * TIMES * FROM.len()
                ),
                "ours: the original states no distances, speeds and numbers of trials",
            ),
        ],
        notes: vec![format!(
            "With the stated gains and without a dead band, friction stops the simulated motor up \
             to {plain} counts from its goal. So the motor of the original had less friction, or \
             its modules had more settings than stated. Its friction is not stated either. The \
             gains of today need no dead band; with them the axis rests within a count."
        )],
    })
}

fn start(machine: &Machine, faces: &[String]) -> Result<SimulatedHead, Error> {
    // All contacts are of module 1, which exists.
    let faces: Vec<Contact> = faces.iter().filter_map(|face| face.parse().ok()).collect();
    let network =
        SimulatedNetwork::new(&[4], &faces, None).unwrap_or_else(|why| unreachable!("{why}"));
    Head::start(Line::new(SimulatedPort::new(network)), machine, 1)
}

/// Returns the position at which the axis comes to rest, counts.
fn position(head: &mut SimulatedHead) -> Result<i64, Error> {
    let mut last = head.status(0)?.readings.position;
    let mut same = 0;
    while same < AT_REST {
        let now = head.status(0)?.readings.position;
        same = if now == last { same + 1 } else { 0 };
        last = now;
    }
    Ok(last.into())
}

/// Moves back and forth and returns the largest distance from a goal, counts.
fn farthest(machine: &Machine) -> Result<f64, Error> {
    let mut head = start(machine, &[])?;
    let mut farthest = 0;
    for _ in 0..TIMES {
        for length in MOVES {
            for goal in [length, 0] {
                head.go_to([goal, 0, 0])?;
                farthest = farthest.max((position(&mut head)? - goal).abs());
            }
        }
    }
    Ok(farthest as f64)
}

/// Touches both faces from several distances. Returns half of the larger range of the latched
/// positions, counts.
fn touched(machine: &Machine) -> Result<f64, Error> {
    let faces = [format!("1:{FACE}"), format!("1:..-{FACE}")];
    let mut head = start(machine, &faces)?;
    let mut range = 0;
    for side in [1, -1] {
        let along = UnitVector::new([side, 0, 0]).ok_or(Error::NotTouching)?;
        let mut latched = Vec::new();
        for _ in 0..TIMES {
            for from in FROM {
                head.go_to([side * (FACE - from), 0, 0])?;
                latched.push(head.touch(&along, 1000)?.touch.position[0]);
            }
        }
        let [low, high] = [latched.iter().min(), latched.iter().max()];
        range = range.max(high.unwrap_or(&0) - low.unwrap_or(&0));
        head.go_to([0; 3])?;
    }
    Ok(range as f64 / 2.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_repeat_within_a_count() {
        let table = repeatability().unwrap();
        assert_eq!(table.counts(), [2, 2], "{table:?}");
        assert!(
            table.rows.iter().all(|row| row.today <= Some(1.0)),
            "{table:?}"
        );
        assert!(farthest(&one_axis()).unwrap() <= 1.0);
        let mut plain = one_axis();
        plain.axes[0].gains = GAINS;
        plain.axes[0].in_position = NEAR;
        // Without the dead band the axis stops far from its goals.
        assert!(farthest(&plain).unwrap() > 5.0);
    }
}
