//! Winding of a stepping motor with its bridge: current as a function of the step rate, and the
//! pull-out rate.

use std::f64::consts::{PI, TAU};

/// A winding, the supply of its bridge, and its current limit.
///
/// The bridge applies the supply as a square wave, as full steps with two phases on do. The current
/// is computed exactly from one switching point to the next. The voltage induced by the rotor
/// counts only in [`Winding::torque`].
#[derive(Copy, Clone, Debug, PartialEq)]
pub struct Winding {
    /// Resistance of winding and bridge, ohm; above 0.
    pub resistance_ohm: f64,
    /// Inductance, H; above 0.
    pub inductance_h: f64,
    /// Supply of the bridge, V; above 0.
    pub supply_v: f64,
    /// Current limiter; `None` if only the resistance limits the current.
    pub chopper: Option<Chopper>,
}

/// A chopper with a constant off time, such as the PBL3717A: at the peak current the winding is
/// shorted by its diodes for a fixed time.
#[derive(Copy, Clone, Debug, PartialEq)]
pub struct Chopper {
    /// Current at which it switches off, A; above 0.
    pub peak_a: f64,
    /// Off time, s; above 0.
    pub off_s: f64,
}

/// Current of a winding over one electrical cycle.
#[derive(Copy, Clone, Debug, PartialEq)]
pub struct Current {
    /// Largest magnitude, A.
    pub peak_a: f64,
    /// RMS current, A; it heats the winding.
    pub rms_a: f64,
    /// Mean net current from the supply, A, as an ammeter in its lead shows it.
    pub supply_a: f64,
}

/// Rotor constants of a two-phase motor.
#[derive(Copy, Clone, Debug, PartialEq)]
pub struct Rotor {
    /// Torque constant per phase at its best angle, N m/A; the same number is the induced voltage
    /// in V s/rad of the shaft.
    pub torque_nm_per_a: f64,
    /// Electrical cycles per turn of the shaft: a quarter of the full steps.
    pub cycles_per_turn: f64,
}

/// Number of half cycles after which the current counts as periodic. From one half cycle to the
/// next an error is multiplied by -e^(-h / tau). So it is at least halved in the mean of two. With
/// a chopper the current may never become periodic.
const SETTLING: usize = 60;

impl Winding {
    /// Time constant, s.
    #[must_use]
    pub fn time_constant_s(&self) -> f64 {
        self.inductance_h / self.resistance_ohm
    }

    /// The current at `cycle_hz` electrical cycles per second (full steps/s divided by four),
    /// above 0.
    ///
    /// Without a chopper the mean of the supply is V/R (1 - tanh(x)/x) with x = R/(4 f L), and the
    /// peak is V/R tanh(x).
    #[must_use]
    pub fn current(&self, cycle_hz: f64) -> Current {
        let half_s = 0.5 / cycle_hz;
        let mut start_a = 0.0;
        let mut cycle = Current {
            peak_a: 0.0,
            rms_a: 0.0,
            supply_a: 0.0,
        };
        for _ in 0..SETTLING {
            let (end_a, half) = self.half_cycle(-start_a, half_s);
            cycle = half;
            if (end_a - start_a).abs() < 1e-14 * (self.supply_v / self.resistance_ohm) {
                break;
            }
            start_a = f64::midpoint(start_a, end_a);
        }
        cycle
    }

    /// Computes half a cycle of forward voltage from an initial current. Returns the current at its
    /// end, and the means over it.
    fn half_cycle(&self, from_a: f64, half_s: f64) -> (f64, Current) {
        let (mut now_a, mut left_s) = (from_a, half_s);
        let (mut charge, mut squares, mut peak_a) = (0.0, 0.0, from_a.abs());
        while left_s > 0.0 {
            // Until the peak of the chopper, or the end of the half cycle.
            let limit_a = self.supply_v / self.resistance_ohm;
            let on_s = self.time_to(now_a).min(left_s);
            let (end_a, on_charge, on_squares) = self.towards(limit_a, now_a, on_s);
            charge += on_charge;
            squares += on_squares;
            now_a = end_a;
            peak_a = peak_a.max(now_a.abs());
            left_s -= on_s;
            let Some(chopper) = self.chopper else { break };
            let off_s = chopper.off_s.min(left_s);
            let (end_a, _, off_squares) = self.towards(0.0, now_a, off_s);
            squares += off_squares;
            now_a = end_a;
            left_s -= off_s;
        }
        let current = Current {
            peak_a,
            rms_a: (squares / half_s).sqrt(),
            supply_a: charge / half_s,
        };
        (now_a, current)
    }

    /// Time from a current to the peak of the chopper, s; infinite without a chopper or where the
    /// peak is never reached.
    fn time_to(&self, from_a: f64) -> f64 {
        let limit_a = self.supply_v / self.resistance_ohm;
        match self.chopper {
            Some(Chopper { peak_a, .. }) if peak_a < limit_a => {
                let ratio = (limit_a - from_a) / (limit_a - peak_a);
                (self.time_constant_s() * ratio.ln()).max(0.0)
            }
            _ => f64::INFINITY,
        }
    }

    /// Exponential approach to a final current for `time_s`. Returns the current then, and the
    /// integrals of the current and of its square.
    fn towards(&self, final_a: f64, from_a: f64, time_s: f64) -> (f64, f64, f64) {
        let tau = self.time_constant_s();
        let decay = (-time_s / tau).exp();
        let swing = from_a - final_a;
        let first = tau * (1.0 - decay);
        let second = tau / 2.0 * (1.0 - decay * decay);
        (
            final_a + swing * decay,
            final_a * time_s + swing * first,
            final_a * final_a * time_s + 2.0 * final_a * swing * first + swing * swing * second,
        )
    }

    /// The largest torque at `cycle_hz` electrical cycles per second that the rotor can follow, N
    /// m. A negative torque means that the motor brakes.
    ///
    /// The first harmonic of the square wave in two phases, V = 4/pi of the supply, acts against
    /// impedance and induced voltage: `T = K (V / Z - K w R / Z^2)` with `Z^2 = R^2 + (W L)^2`. W
    /// is the electrical angular speed, w that of the shaft. The torque is limited by the current
    /// of the chopper.
    ///
    /// # Source
    /// P. Acarnley, Stepping Motors, 4th ed., section 5.3.
    #[must_use]
    pub fn torque(&self, rotor: &Rotor, cycle_hz: f64) -> f64 {
        let electrical = TAU * cycle_hz;
        let shaft = electrical / rotor.cycles_per_turn;
        let reactance = electrical * self.inductance_h;
        let square = self.resistance_ohm * self.resistance_ohm + reactance * reactance;
        let harmonic_v = 4.0 / PI * self.supply_v;
        let induced = rotor.torque_nm_per_a * shaft * self.resistance_ohm / square;
        let pulled_a = harmonic_v / square.sqrt() - induced;
        let limited_a = self
            .chopper
            .map_or(f64::INFINITY, |chopper| 4.0 / PI * chopper.peak_a);
        rotor.torque_nm_per_a * pulled_a.min(limited_a)
    }

    /// The lowest rate in electrical cycles per second at which the motor no longer turns a load of
    /// `load_nm`. `None` if it never turns the load; infinite if it still turns it at 1 MHz.
    ///
    /// The rate is searched upwards in steps of 1 %, because the torque may rise above the load
    /// again. It is then bisected to 10^-12.
    #[must_use]
    pub fn pull_out_hz(&self, rotor: &Rotor, load_nm: f64) -> Option<f64> {
        let carries = |hz: f64| self.torque(rotor, hz) >= load_nm;
        if !carries(0.0) {
            return None;
        }
        let (mut low, mut high) = (0.0, 0.01);
        while carries(high) {
            if high > 1e6 {
                return Some(f64::INFINITY);
            }
            (low, high) = (high, high * 1.01);
        }
        for _ in 0..40 {
            let middle = f64::midpoint(low, high);
            if carries(middle) {
                low = middle;
            } else {
                high = middle;
            }
        }
        Some(low)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// A winding whose resistance alone limits the current to 1 A, with a time constant of 1.29 ms.
    const ONE_AMPERE: Winding = Winding {
        resistance_ohm: 12.0,
        inductance_h: 12.0 * 1.29e-3,
        supply_v: 12.0,
        chopper: None,
    };

    /// Measured on the microfactory, with a constant 0.197 A of the bridges: 0.83 A at 15.25 Hz,
    /// 0.61 A at 60.98 Hz and 0.39 A at 128.2 Hz.
    #[test]
    fn supply_current_falls_as_measured() {
        let winding = Winding {
            resistance_ohm: 15.91,
            inductance_h: 15.91 * 1.94e-3,
            ..ONE_AMPERE
        };
        for (hz, measured) in [(15.25, 0.83), (60.98, 0.61), (128.2, 0.39)] {
            let amperes = 0.197 + winding.current(hz).supply_a;
            assert!((amperes / measured - 1.0).abs() < 0.04, "{hz}: {amperes}");
        }
    }

    #[test]
    fn a_chopper_keeps_its_peak_until_the_rate_takes_it() {
        let chopped = Winding {
            supply_v: 48.0,
            chopper: Some(Chopper {
                peak_a: 0.9,
                off_s: 30e-6,
            }),
            ..ONE_AMPERE
        };
        for hz in [1.0, 10.0, 100.0, 400.0] {
            let current = chopped.current(hz);
            assert!((current.peak_a - 0.9).abs() < 1e-9, "{hz}: {current:?}");
        }
        assert!(chopped.current(20_000.0).peak_a < 0.9);
        // Nearly at standstill the RMS current is the peak minus half the ripple of 30 us in 1.29
        // ms. The supply only covers the losses.
        let slow = chopped.current(1.0);
        assert!((slow.rms_a - 0.89).abs() < 0.005, "{slow:?}");
        assert!(
            (slow.supply_a - 0.89 * 0.89 * 12.0 / 48.0).abs() < 0.01,
            "{slow:?}"
        );
    }

    #[test]
    fn pull_out_is_where_the_torque_is_the_load() {
        let rotor = Rotor {
            torque_nm_per_a: 0.02,
            cycles_per_turn: 50.0,
        };
        let load = 0.3 * ONE_AMPERE.torque(&rotor, 0.0);
        let hz = ONE_AMPERE.pull_out_hz(&rotor, load).unwrap();
        assert!((ONE_AMPERE.torque(&rotor, hz) / load - 1.0).abs() < 1e-9);
        assert_eq!(ONE_AMPERE.pull_out_hz(&rotor, 4.0 * load), None);
        let lighter = ONE_AMPERE.pull_out_hz(&rotor, load / 2.0).unwrap();
        assert!(lighter > 1.5 * hz);
    }

    fn winding() -> impl Strategy<Value = Winding> {
        let chopper = prop::option::of((0.05..1.5_f64, 1e-6..1e-3_f64));
        (1.0..50.0_f64, 1e-4..0.1_f64, 3.0..60.0_f64, chopper).prop_map(
            |(resistance_ohm, inductance_h, supply_v, chopper)| Winding {
                resistance_ohm,
                inductance_h,
                supply_v,
                chopper: chopper.map(|(fraction, off_s)| Chopper {
                    peak_a: fraction * supply_v / resistance_ohm,
                    off_s,
                }),
            },
        )
    }

    proptest! {
        /// The supply delivers the power that the resistance dissipates: over a cycle the
        /// inductance stores nothing.
        #[test]
        fn power_in_is_power_out(winding in winding(), hz in 1.0..3000.0_f64) {
            let current = winding.current(hz);
            let (given, taken) = (
                current.supply_a * winding.supply_v,
                current.rms_a * current.rms_a * winding.resistance_ohm,
            );
            // The phase of a chopper need not repeat with the half cycle.
            let tolerance = if winding.chopper.is_some() { 0.15 } else { 1e-6 };
            prop_assert!((given - taken).abs() <= tolerance * taken.max(1e-3), "{given} {taken}");
        }

        /// Without a chopper the current is that of the closed formula.
        #[test]
        fn unlimited_is_the_formula(winding in winding(), hz in 1.0..3000.0_f64) {
            let winding = Winding { chopper: None, ..winding };
            let x = 1.0 / (4.0 * hz * winding.time_constant_s());
            let limit = winding.supply_v / winding.resistance_ohm;
            let current = winding.current(hz);
            prop_assert!((current.peak_a - limit * x.tanh()).abs() < 1e-6 * limit);
            prop_assert!((current.supply_a - limit * (1.0 - x.tanh() / x)).abs() < 1e-6 * limit);
        }
    }
}
