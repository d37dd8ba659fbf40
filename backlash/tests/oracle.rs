//! The recorded traces: logical steps in, motor steps with take-up out, and the play model driven
//! by them.

use husillo_backlash::{Backlash, BacklashModel, Compensator, Flank};
use serde_json::Value;

/// One character an iteration: (dx + 1) * 3 + (dy + 1).
fn decode(text: &str) -> Vec<[i8; 2]> {
    text.bytes()
        .map(|c| (c - b'0') as i8)
        .map(|code| [code / 3 - 1, code % 3 - 1])
        .collect()
}

fn encode(steps: &[[i8; 2]]) -> String {
    steps
        .iter()
        .map(|[dx, dy]| char::from(b'0' + ((dx + 1) * 3 + dy + 1) as u8))
        .collect()
}

fn pair(value: &Value) -> [i32; 2] {
    [0, 1].map(|axis| value[axis].as_i64().unwrap() as i32)
}

fn flank(direction: i32) -> Flank {
    Flank::towards(direction as i8).unwrap_or_default()
}

/// The nut on the screw: y = clamp(y, m, m + backlash). The tables begin at 0 with their flank
/// closed.
struct Play {
    motor: [i32; 2],
    table: [i32; 2],
    backlash: [i32; 2],
}

impl Play {
    fn new(backlash: [i32; 2], last: [i32; 2]) -> Play {
        let motor = [0, 1].map(|axis| if last[axis] >= 0 { 0 } else { -backlash[axis] });
        Play {
            motor,
            table: [0, 0],
            backlash,
        }
    }

    fn step(&mut self, delta: [i8; 2]) {
        for (axis, delta) in delta.into_iter().enumerate() {
            self.motor[axis] += i32::from(delta);
            self.table[axis] =
                self.table[axis].clamp(self.motor[axis], self.motor[axis] + self.backlash[axis]);
        }
    }
}

/// The compensator's stream for a logical one; `load` is tracked as a machine does.
fn compensate<L: BacklashModel<2>>(
    logical: &[[i8; 2]],
    stage: &mut Compensator<2, L>,
) -> Vec<[i8; 2]> {
    let mut load = [0, 0];
    let mut motor = Vec::new();
    for &delta in logical {
        for (axis, owed) in stage.before(&delta, load).into_iter().enumerate() {
            let mut take_up = [0, 0];
            take_up[axis] = delta[axis];
            motor.extend((0..owed).map(|_| take_up));
        }
        motor.push(delta);
        load = [0, 1].map(|axis| load[axis] + i32::from(delta[axis]));
    }
    motor
}

#[test]
fn traces_are_reproduced_and_the_table_visits_every_logical_point() {
    let oracle: Value = serde_json::from_str(include_str!("data/backlash.json")).unwrap();
    let cases = oracle["cases"].as_array().unwrap();
    assert_eq!(cases.len(), 16);
    for case in cases {
        let name = case["name"].as_str().unwrap();
        let (backlash, last) = (pair(&case["B"]), pair(&case["last_dir"]));
        let logical = decode(case["logical"].as_str().unwrap());
        let axis = |axis: usize| Backlash::new(backlash[axis] as u32, flank(last[axis]));
        let motor = compensate(&logical, &mut Compensator::new([axis(0), axis(1)]));
        assert_eq!(encode(&motor), case["motor"].as_str().unwrap(), "{name}");
        assert_eq!(
            motor.len() as u64,
            case["motor_iters"].as_u64().unwrap(),
            "{name}"
        );

        // With compensation the table stands on the logical points, one after the other, and
        // nowhere else.
        let mut play = Play::new(backlash, last);
        let mut visited = vec![play.table];
        for &delta in &motor {
            play.step(delta);
            if visited.last() != Some(&play.table) {
                visited.push(play.table);
            }
        }
        let mut point = [0, 0];
        let mut points = vec![point];
        for delta in logical.iter().filter(|&&delta| delta != [0, 0]) {
            point = [0, 1].map(|axis| point[axis] + i32::from(delta[axis]));
            points.push(point);
        }
        assert_eq!(visited, points, "{name}");
        assert_eq!(play.table, pair(&case["table_end"]), "{name}");

        let mut play = Play::new(backlash, last);
        logical.iter().for_each(|&delta| play.step(delta));
        assert_eq!(
            play.table,
            pair(&case["table_end_without_compensation"]),
            "{name}"
        );
    }
}

#[test]
fn unknown_flank_is_not_compensated_first() {
    let unknown = Backlash::new(3, Flank::Unknown);
    let mut stage = Compensator::new([unknown, unknown]);
    let motor = compensate(&decode("1111777"), &mut stage);
    assert_eq!(encode(&motor), "1111777777");
}
