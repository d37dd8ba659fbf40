//! Tables 4.3 and 4.5: currents.

use super::{Coils, READINGS};
use crate::originals::{Parameter, Row, Table};

/// Relative spread of a current.
const SPREAD: f64 = 0.08;
/// Rate of CLOCK in the temperature test, Hz.
pub const TEST_HZ: f64 = 304.0;
/// Half of the last digit of a current that is printed with one decimal, A.
pub const DIGIT_A: f64 = 0.05;

/// Table 4.3: current over the rate.
#[must_use]
pub fn current() -> Table {
    let coils = Coils::fitted();
    let rows: Vec<Row> = READINGS
        .iter()
        .map(|reading| {
            let name = format!("CLOCK {:.1} Hz", reading.clock_hz);
            let spread = SPREAD * reading.amperes;
            Row::new(name, "A", reading.amperes, spread).rebuilt(coils.amperes(reading.clock_hz))
        })
        .collect();
    let notes = notes(&rows);
    Table {
        number: "4.3",
        title: "current of the X motor over the rate of CLOCK",
        spread: "the original states none; 8 % of the value is asked of the model, and 3 % of all \
                 values (RMS)",
        rows,
        parameters: parameters(&coils),
        notes,
    }
}

/// The parameters of the coil model.
pub fn parameters(coils: &Coils) -> Vec<Parameter> {
    const FITTED: &str = "fitted to the 30 currents of table 4.3";
    vec![
        Parameter::new(
            "current of the windings at rest",
            format!("{:.3} A", coils.still_a),
            FITTED,
        ),
        Parameter::new(
            "time constant of a winding",
            format!("{:.2} ms", 1e3 * coils.time_constant_s),
            FITTED,
        ),
        Parameter::new(
            "current of the bridges at any rate",
            format!("{:.3} A", coils.bridges_a),
            FITTED,
        ),
    ]
}

fn notes(rows: &[Row]) -> Vec<String> {
    let off = |row: &Row| 100.0 * row.unexplained().unwrap_or(0.0) / row.measured;
    let squares: f64 = rows.iter().map(|row| off(row).powi(2)).sum();
    let rms = (squares / rows.len() as f64).sqrt();
    let outliers = rows.iter().filter(|row| off(row).abs() > 1.5 * rms);
    let outliers: Vec<String> = outliers
        .map(|row| format!("{} {:+.1} %", row.name, off(row)))
        .collect();
    vec![
        format!(
            "Relative error: {rms:.2} % RMS. Beyond one and a half of it: {}.",
            outliers.join(", ")
        ),
        "No smooth model falls by 11 % between 42.8 and 50.8 Hz and by 2 % between 50.8 and 61 Hz: \
         the first two currents may have been read in another range."
            .into(),
        "Windings alone leave 4.0 % and up to 10 %. A voltage induced by the rotor does not help: \
         the fit makes it negative. The constant current has other support: at 304 Hz, tables 4.2 \
         and 4.5 have 0.3 A for the motor alone, and this table 0.54 A."
            .into(),
    ]
}

/// Table 4.5: consumption of three systems, at rest and in the temperature test.
#[must_use]
pub fn consumption() -> Table {
    let coils = Coils::fitted();
    let data = |name: &str, amperes| Row::new(name, "A", amperes, DIGIT_A);
    Table {
        number: "4.5",
        title: "consumption of three systems",
        spread: "half of the last digit, 0.05 A",
        rows: vec![
            data("DSP: at rest", 0.5),
            data("DSP: in the test", 0.8).rebuilt(0.5 + coils.windings_a(TEST_HZ)),
            data("PIC: at rest", 0.4),
            data("PIC: in the test", 0.84),
            data("G/M code: at rest", 0.24),
            data("G/M code: in the test", 0.67),
        ],
        parameters: parameters(&coils),
        notes: vec![
            "In the test: the measured current at rest and the current of the windings at 304 Hz."
                .into(),
            "The supplies and bridges of the other two systems are not described well enough for a \
             model: the PIC has an L298 at 10 V."
                .into(),
        ],
    }
}
