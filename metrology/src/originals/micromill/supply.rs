//! Current of the whole micro mill at different supply voltages.

use crate::originals::{Parameter, Row, Table};
use husillo_sim::Winding;

/// Supply in V, and the current of the whole system with its motors energised, A.
const READINGS: [(f64, f64); 4] = [(8.0, 0.9), (10.0, 1.1), (12.0, 1.3), (14.0, 1.5)];
/// Windings of its motors: 29 ohm and 18 mH.
const RESISTANCE_OHM: f64 = 29.0;
const INDUCTANCE_H: f64 = 18e-3;
/// Number of windings with current.
const WINDINGS: f64 = 3.0;
/// Half of the last digit of a current, A.
const DIGIT_A: f64 = 0.05;
/// Electrical cycles per second of a motor at rest: so few that the inductance has no effect.
const AT_REST_HZ: f64 = 0.01;

/// The supply currents.
#[must_use]
pub fn supply() -> Table {
    let windings_a = |supply_v| {
        let winding = Winding {
            resistance_ohm: RESISTANCE_OHM,
            inductance_h: INDUCTANCE_H,
            supply_v,
            chopper: None,
        };
        WINDINGS * winding.current(AT_REST_HZ).supply_a
    };
    let rest = READINGS.map(|(volts, amperes)| amperes - windings_a(volts));
    let electronics_a = rest.iter().sum::<f64>() / READINGS.len() as f64;
    let rows = READINGS.map(|(volts, amperes)| {
        Row::new(format!("at {volts} V"), "A", amperes, DIGIT_A)
            .rebuilt(electronics_a + windings_a(volts))
    });
    Table {
        number: "supply",
        title: "current of the whole mill over its supply, motors energised",
        spread: "half of the last digit, 0.05 A",
        rows: rows.into(),
        parameters: vec![
            Parameter::new("winding", format!("{RESISTANCE_OHM} ohm"), "the original"),
            Parameter::new(
                "windings with current",
                format!("{WINDINGS}"),
                "fitted: the whole number that leaves least",
            ),
            Parameter::new(
                "electronics",
                format!("{electronics_a:.3} A"),
                "fitted: the mean of what the windings leave",
            ),
        ],
        notes: vec![
            "Full steps have current in both windings of each of three motors. Unexplained: only \
             three windings had current. At 14 V each takes 0.48 A, more than the 0.42 A of the \
             chopper in the machine file, which follows a circuit of the data sheet: the choppers \
             of the original were set higher."
                .into(),
        ],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn three_windings_and_the_electronics_take_the_current() {
        let table = supply();
        assert_eq!(table.counts(), [4, 4]);
        assert!(table.rms("A").unwrap() < 0.02);
    }
}
