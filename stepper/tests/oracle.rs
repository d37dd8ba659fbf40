//! The published step tables of all drivers, state by state and in both directions.

use husillo_stepper::{CoilDriver, Driver, Levels, Mode, Sequencer};
use serde_json::Value;

fn tables() -> Value {
    serde_json::from_str(include_str!("data/stepper_tables.json")).unwrap()
}

fn bit(row: &Value, name: &str) -> u8 {
    row[name].as_u64().unwrap() as u8
}

/// The levels of one row of the PBL3717A and A3988 tables.
fn bridge_levels(row: &Value) -> u8 {
    ["PhA", "I0A", "I1A", "PhB", "I0B", "I1B"]
        .iter()
        .enumerate()
        .map(|(at, name)| bit(row, name) << at)
        .sum()
}

/// The levels of one state of the L297.
fn l297_levels(row: &Value) -> u8 {
    let coils = row["ABCD"].as_str().unwrap().bytes().enumerate();
    let coils: u8 = coils.map(|(at, digit)| (digit - b'0') << at).sum();
    coils | bit(row, "INH1") << 4 | bit(row, "INH2") << 5 | bit(row, "home") << 6
}

/// Walks the table twice forward and twice back, from the sequencer's present state, which is the
/// first row.
fn assert_walk(mut motor: Sequencer, expected: &[u8], what: &str) {
    let n = expected.len();
    assert_eq!(motor.levels().0, expected[0], "{what}: first");
    for i in 1..=2 * n {
        assert_eq!(motor.step(1).0, expected[i % n], "{what}: row {i} forward");
    }
    for i in (0..2 * n).rev() {
        assert_eq!(motor.step(-1).0, expected[i % n], "{what}: row {i} back");
    }
    assert_eq!(motor.step(0).0, expected[0], "{what}: standing");
}

fn assert_bridges(table: &Value, driver: Driver, mode: Mode, sixteenth: u8) {
    let rows = table.as_array().unwrap();
    let mut motor = Sequencer::new(driver, mode).unwrap();
    motor.restore(sixteenth);
    let expected: Vec<u8> = rows.iter().map(bridge_levels).collect();
    assert_walk(motor, &expected, &format!("{driver:?} {mode:?}"));
    for row in rows {
        let [a, b] = driver
            .currents(Levels(bridge_levels(row)))
            .map(|current| f64::from(current) / 1000.0);
        let angle = b.atan2(a).to_degrees().rem_euclid(360.0);
        assert!(
            (angle - row["angle"].as_f64().unwrap()).abs() < 0.03,
            "{row}: {angle}"
        );
        assert!(
            (a.hypot(b) - row["torque"].as_f64().unwrap()).abs() < 0.001,
            "{row}"
        );
    }
}

#[test]
fn pbl3717a_walks_its_tables() {
    let table = &tables()["PBL3717A"];
    assert_bridges(&table["full"], Driver::Pbl3717a, Mode::Full, 14);
    assert_bridges(&table["half"], Driver::Pbl3717a, Mode::Half, 14);
    assert_bridges(&table["quarter_60"], Driver::Pbl3717a, Mode::Quarter, 2);
    assert_bridges(&table["quarter_20"], Driver::Pbl3717a, Mode::QuarterLow, 2);
}

#[test]
fn a3988_walks_its_tables() {
    let table = &tables()["A3988"];
    assert_bridges(&table["full"], Driver::A3988, Mode::Full, 2);
    assert_bridges(&table["half"], Driver::A3988, Mode::Half, 2);
    assert_bridges(&table["quarter"], Driver::A3988, Mode::Quarter, 2);
}

#[test]
fn l297_walks_its_states_in_every_mode() {
    let table = &tables()["L297"];
    let states = table["master"].as_array().unwrap();
    for (order, mode) in [
        ("half_step_order", Mode::Half),
        ("normal_two_phase_order", Mode::Full),
        ("wave_one_phase_order", Mode::Wave),
    ] {
        let order = table[order].as_array().unwrap().iter();
        let expected: Vec<u8> = order
            .map(|state| l297_levels(&states[state.as_u64().unwrap() as usize - 1]))
            .collect();
        assert_walk(
            Sequencer::new(Driver::L297, mode).unwrap(),
            &expected,
            &format!("L297 {mode:?}"),
        );
    }
    for state in states {
        let expected = ["I1", "I2"].map(|name| state[name].as_i64().unwrap() as i16 * 1000);
        assert_eq!(
            Driver::L297.currents(Levels(l297_levels(state))),
            expected,
            "{state}"
        );
    }
}

#[test]
fn l297_full_step_adds_two_to_any_state() {
    let states: Vec<u8> = tables()["L297"]["master"]
        .as_array()
        .unwrap()
        .iter()
        .map(l297_levels)
        .collect();
    for from in 0..8 {
        for mode in [Mode::Full, Mode::Wave] {
            let mut motor = Sequencer::new(Driver::L297, Mode::Half).unwrap();
            for _ in 0..from {
                motor.step(1);
            }
            motor.set_mode(mode).unwrap();
            assert_eq!(
                motor.levels().0,
                states[from],
                "changing the mode moves nothing"
            );
            assert_eq!(motor.step(1).0, states[(from + 2) % 8]);
            assert_eq!(motor.step(-1).0, states[from]);
            assert_eq!(motor.step(-1).0, states[(from + 6) % 8]);
            assert_eq!(
                motor.reset().0 & 0x4F,
                if mode == Mode::Full { 0x4A } else { 0x08 }
            );
        }
    }
}

#[test]
fn l297_enable_low_takes_everything_low() {
    let mut motor = Sequencer::new(Driver::L297, Mode::Half).unwrap();
    for _ in 0..8 {
        let held = motor.step(1);
        assert_eq!(motor.set_enabled(false).0 & 0x3F, 0);
        assert_eq!(motor.set_enabled(true), held);
    }
}

#[test]
fn micromill_controller_walks_its_own_combination() {
    let table = &tables()["thesis_PIC_combination"];
    let states = |key: &str| -> Vec<u8> {
        let text = table[key].as_str().unwrap();
        let order = text.rsplit(": ").next().unwrap().split(',');
        order
            .map(|state| {
                let bits = &table["state_bits"][state];
                bits[0].as_u64().unwrap() as u8 | (bits[1].as_u64().unwrap() as u8) << 1
            })
            .collect()
    };
    let motor = Sequencer::new(Driver::PhasePair, Mode::Full).unwrap();
    assert_walk(motor, &states("y_plus"), "y");
    assert_walk(motor.reversed(), &states("y_minus"), "y reversed");
    assert_walk(motor.reversed(), &states("x_plus"), "x");
    assert_walk(motor, &states("x_minus"), "x reversed");
}

#[test]
fn unipolar_walks_the_drill_nibbles() {
    let table = &tables()["UNIMAT_68HC11"];
    let nibbles = |key: &str| -> Vec<u8> {
        table[key]
            .as_array()
            .unwrap()
            .iter()
            .map(|n| n.as_u64().unwrap() as u8)
            .collect()
    };
    let motor = Sequencer::new(Driver::Unipolar, Mode::Full).unwrap();
    assert_eq!(
        u64::from(motor.levels().0),
        table["power_on"].as_u64().unwrap()
    );
    assert_walk(motor, &nibbles("nibble_positive"), "positive");
    assert_walk(motor.reversed(), &nibbles("nibble_negative"), "negative");
}
