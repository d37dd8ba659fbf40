//! The drill: holes of a board, and the steps and times that the description states. It has no
//! measured tables, only an accuracy that boards need.

use super::{Parameter, Row, Table};
use husillo_controllers::{Drill, DrillConfig, DrillEvent};
use husillo_sim::{DrillRig, DrilledHole};
use husillo_transports::drill::{END_OF_PROGRAM, MEMORY_BYTES, Record, Table as Records};

/// Distance of the pins of a chip, nm.
const PITCH_NM: i64 = 2_540_000;
/// Distance of its two rows, nm.
const ROWS_NM: i64 = 7_620_000;
/// Position of the first of its 16 pins, nm. It is at the far end of the table, where errors are
/// largest.
const FIRST_NM: [i64; 2] = [200_000_000, 35_000_000];
/// The accuracy that boards need, um: a thousandth of an inch.
const NEEDED_UM: f64 = 25.4;
/// Steps per mm: 200 steps per turn, a speed-raising gear of 0.53499, a screw of 1 mm.
const TRUE_STEPS_PER_MM: f64 = 200.0 * 0.53499;
/// Distance between the sensors of Z: 35 mm at 107 steps per mm.
const STROKE: u16 = 3745;
/// Distance from the upper sensor to the board, steps.
const BOARD: u16 = 3000;

/// The result of the simulated drill.
struct Made {
    holes: Vec<DrilledHole>,
    /// Time of each stroke of Z, down and up, s.
    strokes_s: Vec<f64>,
    /// Steps that X moves off its switch if homing begins on the switch.
    back_off_steps: i32,
}

/// Drills a chip with the original controller on its simulated mechanics.
///
/// # Errors
///
/// The simulated drill refuses the program, or drills another number of holes.
pub fn holes() -> Result<Table, String> {
    let wanted: Vec<[i64; 2]> = (0..16_i64)
        .map(|pin| {
            let (column, row) = (pin % 8, pin / 8);
            [FIRST_NM[0] + column * PITCH_NM, FIRST_NM[1] + row * ROWS_NM]
        })
        .collect();
    let made = drilled(&wanted)?;
    let mut rows = Vec::new();
    for (pin, (wanted, hole)) in wanted.iter().zip(&made.holes).enumerate() {
        for (axis, letter) in ["X", "Y"].into_iter().enumerate() {
            let at_mm = f64::from(hole.at[axis]) / TRUE_STEPS_PER_MM;
            let off_um = at_mm * 1e3 - wanted[axis] as f64 / 1e3;
            let name = format!("pin {}: error of {letter}", pin + 1);
            rows.push(Row::new(name, "um", 0.0, NEEDED_UM).rebuilt(off_um));
        }
    }
    let stroke_s = made.strokes_s.iter().copied().fold(0.0, f64::max);
    rows.push(Row::new("step", "nm", 9345.0, 1.0).rebuilt(1e6 / TRUE_STEPS_PER_MM));
    rows.push(
        Row::new("off a closed switch, 42E hex steps", "mm", 5.0, 0.1)
            .rebuilt(f64::from(made.back_off_steps) / TRUE_STEPS_PER_MM),
    );
    rows.push(Row::new("Z down and up, 35 mm", "s", 15.0, 1.0).rebuilt(stroke_s));
    Ok(Table {
        number: "holes",
        title: "holes of a chip of 16 pins at the far end of the table, and stated steps and times",
        spread: "holes: 25.4 um, a thousandth of an inch, which boards need; the step: its last \
                 digit; 0.1 mm; 1 s",
        rows,
        parameters: vec![
            Parameter::new(
                "steps",
                format!("{TRUE_STEPS_PER_MM:.3} per mm"),
                "200 steps, gear 0.53499, screw 1 mm; the controller calculates with 107",
            ),
            Parameter::new(
                "rate",
                format!("{} Hz", DrillConfig::ORIGINAL.rate_hz[2]),
                "the original: about 250 Hz",
            ),
        ],
        notes: vec![
            "No hole was measured on the original: 0 is what was wanted. Backlash and lost steps \
             are not stated, so these errors are only those of whole steps and of the gear."
                .into(),
            "Outside: a comment says that 42E hex steps are 5 mm; 1070 steps are 10 mm.".into(),
            "Outside: 35 mm of Z need 15 s in each direction if its motor steps like the others, \
             not down and up. What the gear of Z, 1:24, changes is not stated."
                .into(),
        ],
    })
}

fn drilled(wanted: &[[i64; 2]]) -> Result<Made, String> {
    let mut drill = Drill::<MEMORY_BYTES>::new(DrillConfig::ORIGINAL);
    // At first X is on its switch.
    let mut rig = DrillRig::new([0, 100, 50], STROKE, BOARD, 0);
    let mut strokes_s = Vec::new();
    let back_off_steps = run(&mut drill, &mut rig, &mut strokes_s);
    let mut program = vec![b'c', b'b'];
    for at in wanted {
        let records = Records::DRILL.hole(*at).map_err(|why| why.to_string())?;
        program.extend(records.into_iter().flat_map(Record::to_bytes));
    }
    program.extend([END_OF_PROGRAM, b'e']);
    for byte in program {
        drill.push(byte);
        run(&mut drill, &mut rig, &mut strokes_s);
    }
    let holes = rig.holes().to_vec();
    if holes.len() != wanted.len() {
        let (made, wanted) = (holes.len(), wanted.len());
        return Err(format!("{made} holes instead of {wanted}"));
    }
    Ok(Made {
        holes,
        strokes_s,
        back_off_steps,
    })
}

/// Carries out events until the controller waits for a byte. Returns the farthest position of X,
/// steps.
fn run(drill: &mut Drill<MEMORY_BYTES>, rig: &mut DrillRig, strokes_s: &mut Vec<f64>) -> i32 {
    /// Ticks per second of the controller.
    const TICKS_PER_S: f64 = DrillConfig::ORIGINAL.timer_hz as f64;
    let (mut left_at, mut farthest) = (None, 0);
    loop {
        while drill.transmit().is_some() {}
        let event = drill.next_event(&rig.inputs());
        if event == DrillEvent::Idle {
            return farthest;
        }
        let [_, _, before] = rig.place();
        let ticks = rig.ticks();
        rig.apply(&event);
        let [x, _, z] = rig.place();
        farthest = farthest.max(x);
        match (before, z) {
            (0, 1..) => left_at = Some(ticks),
            (1.., 0) => {
                let since = left_at.take();
                let stroke = since.map(|since| (rig.ticks() - since) as f64 / TICKS_PER_S);
                strokes_s.extend(stroke);
            }
            _ => {}
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_hole_is_within_a_thousandth_of_an_inch() {
        let table = holes().unwrap();
        assert_eq!(table.rows.len(), 2 * 16 + 3);
        for row in &table.rows[..32] {
            // Half of a step, and the gear: 0.002 of 107 steps in each of 218 mm.
            assert!(row.unexplained().unwrap().abs() < 9.0, "{row:?}");
        }
        let far = &table.rows[14];
        assert!(far.rebuilt.unwrap() != 0.0, "{far:?}");
        let outside = table
            .rows
            .iter()
            .filter(|row| row.is_within() == Some(false));
        let outside: Vec<&str> = outside.map(|row| row.name.as_str()).collect();
        assert_eq!(
            outside,
            ["off a closed switch, 42E hex steps", "Z down and up, 35 mm"]
        );
    }
}
