//! The microfactory: the current of a motor at different rates, and what it determines.

mod coils;
mod current;
mod heat;
mod rates;

pub use coils::Coils;
pub use current::{consumption, current};
pub use heat::{other_systems, temperatures};
pub use rates::rates;

/// A reading of table 4.3.
#[derive(Clone, Copy, Debug)]
struct Reading {
    clock_hz: f64,
    amperes: f64,
}

/// Table 4.3: current of the motor of X over the rate of CLOCK. A cycle of a phase has four pulses.
const READINGS: [Reading; 30] = {
    const TABLE: [[f64; 2]; 30] = [
        [40.4, 0.95],
        [42.84, 0.95],
        [50.84, 0.85],
        [61.0, 0.83],
        [76.28, 0.81],
        [87.2, 0.8],
        [101.68, 0.77],
        [122.04, 0.78],
        [135.6, 0.76],
        [152.4, 0.73],
        [157.36, 0.72],
        [181.28, 0.69],
        [203.24, 0.67],
        [221.72, 0.64],
        [243.92, 0.61],
        [271.0, 0.59],
        [286.96, 0.57],
        [304.88, 0.54],
        [325.2, 0.52],
        [348.4, 0.49],
        [375.24, 0.47],
        [406.0, 0.43],
        [423.6, 0.41],
        [434.0, 0.41],
        [437.6, 0.41],
        [465.6, 0.41],
        [472.8, 0.4],
        [488.4, 0.39],
        [512.8, 0.39],
        [524.8, 0.39],
    ];
    let mut readings = [Reading {
        clock_hz: 0.0,
        amperes: 0.0,
    }; 30];
    let mut index = 0;
    while index < TABLE.len() {
        let [clock_hz, amperes] = TABLE[index];
        readings[index] = Reading { clock_hz, amperes };
        index += 1;
    }
    readings
};

/// Pulses of CLOCK per electrical cycle.
const PULSES: f64 = 4.0;
