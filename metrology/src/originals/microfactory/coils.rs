//! The coil model that fits the measured currents.

use super::{PULSES, READINGS};
use crate::least_squares::least_squares;
use husillo_sim::Winding;

/// Current of a motor with its bridges.
///
/// The current of the windings falls with the rate, because their inductance delays it. In
/// addition, the bridges take a constant current for the bases of their transistors and for the
/// logic.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coils {
    /// Current through the resistance of the windings alone, A.
    pub still_a: f64,
    /// Time constant of a winding, s.
    pub time_constant_s: f64,
    /// Current of the bridges, A. It is the same at every rate.
    pub bridges_a: f64,
}

/// Bounds of the time constant, s.
const BOUNDS_S: [f64; 2] = [0.2e-3, 10e-3];

impl Coils {
    /// The coils of the original. They minimise the sum of squares of the relative errors of table
    /// 4.3.
    #[must_use]
    pub fn fitted() -> Self {
        let (time_constant_s, [still_a, bridges_a]) = fit(|share, _| [share, 1.0], [true; 2]);
        Self {
            still_a,
            time_constant_s,
            bridges_a,
        }
    }

    /// The current of the windings at a rate of CLOCK, A.
    #[must_use]
    pub fn windings_a(&self, clock_hz: f64) -> f64 {
        self.still_a * share(self.time_constant_s, clock_hz)
    }

    /// The whole current at a rate of CLOCK, A.
    #[must_use]
    pub fn amperes(&self, clock_hz: f64) -> f64 {
        self.windings_a(clock_hz) + self.bridges_a
    }
}

/// Supply current of a winding, divided by the current through its resistance alone.
pub fn share(time_constant_s: f64, clock_hz: f64) -> f64 {
    let winding = Winding {
        resistance_ohm: 1.0,
        inductance_h: time_constant_s,
        supply_v: 1.0,
        chopper: None,
    };
    winding.current(clock_hz / PULSES).supply_a
}

/// Fits a sum of terms to table 4.3. `terms` computes the terms from a share of the current and a
/// rate of CLOCK. The factors of the terms in `free` are fitted. Returns the best time constant and
/// the factors.
fn fit<const N: usize>(terms: impl Fn(f64, f64) -> [f64; N], free: [bool; N]) -> (f64, [f64; N]) {
    let factors = |time_constant_s: f64| {
        let rows = READINGS.iter().map(|reading| {
            let share = share(time_constant_s, reading.clock_hz);
            let terms = terms(share, reading.clock_hz);
            (terms.map(|term| term / reading.amperes), 1.0)
        });
        let factors = least_squares(rows.clone(), free).unwrap_or([0.0; N]);
        let squares = rows.map(|(row, wanted)| {
            let made: f64 = row.iter().zip(factors).map(|(a, b)| a * b).sum();
            (made - wanted).powi(2)
        });
        (squares.sum::<f64>(), factors)
    };
    // Golden section: the error has one minimum between the bounds.
    let golden = (5_f64.sqrt() - 1.0) / 2.0;
    let [mut low, mut high] = BOUNDS_S;
    for _ in 0..60 {
        let [left, right] = [high - golden * (high - low), low + golden * (high - low)];
        if factors(left).0 < factors(right).0 {
            high = right;
        } else {
            low = left;
        }
    }
    let best_s = f64::midpoint(low, high);
    (best_s, factors(best_s).1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    /// Root mean square and largest of the relative errors.
    fn errors(amperes: impl Fn(f64) -> f64) -> [f64; 2] {
        let off = READINGS.map(|reading| amperes(reading.clock_hz) / reading.amperes - 1.0);
        let squares: f64 = off.iter().map(|off| off * off).sum();
        let most = off.iter().fold(0.0, |most: f64, off| most.max(off.abs()));
        [(squares / 30.0).sqrt(), most]
    }

    #[test]
    fn the_current_is_within_three_percent_of_the_table() {
        let coils = Coils::fitted();
        let [rms, most] = errors(|clock_hz| coils.amperes(clock_hz));
        assert!(rms < 0.03 && most < 0.08, "{rms} {most} {coils:?}");
        assert!(coils.bridges_a > 0.15, "{coils:?}");
    }

    /// Neither the windings alone nor a voltage that the rotor induces explains the table.
    #[test]
    fn other_models_are_worse() {
        let (tau, [still]) = fit(|share, _| [share], [true]);
        let [rms, most] = errors(|clock_hz| still * share(tau, clock_hz));
        assert!(rms > 0.039 && most > 0.099, "{rms} {most}");
        // A voltage in proportion to the rate, in phase with the current.
        let induced = |tau: f64, clock_hz: f64| {
            let cycle_hz = clock_hz / PULSES;
            -cycle_hz / 1.0_f64.hypot(TAU * cycle_hz * tau)
        };
        let constant = Coils::fitted().time_constant_s;
        let terms = |share, clock_hz| [share, induced(constant, clock_hz)];
        let (_, [_, volts]) = fit(terms, [true; 2]);
        assert!(volts < 0.0, "a voltage that drives the current: {volts}");
    }
}
