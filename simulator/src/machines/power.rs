//! The power stage of a motor as a machine file describes it: winding, chopper, rotor and load.

use crate::machines::table::Table;
use husillo_sim::{Chopper, Rotor, Winding};

/// Sense voltage of the PBL3717A at full current, per reference voltage (data sheet: 420 mV at
/// 5 V). The peak current is this voltage divided by the sense resistor.
const PEAK_OF_REFERENCE: f64 = 0.083;
/// Off time of the PBL3717A divided by R C of its timing network: ln 2.
const OFF_OF_RC: f64 = 0.69;
/// Inductance of the filter before the motor divided by that of the winding.
const FILTER_OF_WINDING: f64 = 0.1;
/// L C of this filter, s^2: its corner frequency is 8 kHz.
const FILTER_LC: f64 = 4e-10;

/// Winding, chopper, rotor and load of a motor.
#[derive(Clone, Copy, Debug)]
pub struct Power {
    /// The winding, with the chopper if there is one.
    pub winding: Winding,
    /// The rotor that the current turns.
    pub rotor: Rotor,
    /// Torque of friction and gear, N m.
    pub load_nm: f64,
    /// Current of the bridges themselves, A. It is the same at every rate.
    pub bridges_a: f64,
}

impl Power {
    /// Reads `[axis.x.motor]`. Missing and wrong keys become findings.
    pub fn read(table: &mut Table<'_, '_>) -> Option<Self> {
        let mut number = |key, range| table.required_number(key, range);
        let resistance_ohm = number("resistance_ohm", 0.01..=10_000.0);
        let inductance_mh = number("inductance_mh", 0.001..=10_000.0);
        let supply_v = number("supply_v", 0.1..=1000.0);
        let torque_nm_per_a = number("torque_nm_per_a", 1e-6..=1000.0);
        let full_steps_per_turn = number("full_steps_per_turn", 4.0..=10_000.0);
        let load_nm = number("load_nm", 0.0..=1000.0);
        let has_bridges = table.value("bridges_a").is_some();
        let bridges_a = has_bridges
            .then(|| table.required_number("bridges_a", 0.0..=100.0))
            .flatten();
        let chopper = table.optional_table("chopper", read_chopper).flatten();
        Some(Self {
            winding: Winding {
                resistance_ohm: resistance_ohm?,
                inductance_h: inductance_mh? * 1e-3,
                supply_v: supply_v?,
                chopper,
            },
            rotor: Rotor {
                torque_nm_per_a: torque_nm_per_a?,
                cycles_per_turn: full_steps_per_turn? / 4.0,
            },
            load_nm: load_nm?,
            bridges_a: bridges_a.unwrap_or(0.0),
        })
    }

    /// The rate in full steps/s at which the motor falls out of step. `None` if it does not turn
    /// its load at all.
    pub fn pull_out_hz(&self) -> Option<f64> {
        let cycles = self.winding.pull_out_hz(&self.rotor, self.load_nm)?;
        Some(4.0 * cycles)
    }

    /// Inductance and capacitance of the filter between bridge and motor, H and F.
    pub fn filter(&self) -> [f64; 2] {
        let inductance = FILTER_OF_WINDING * self.winding.inductance_h;
        [inductance, FILTER_LC / inductance]
    }
}

fn read_chopper(table: &mut Table<'_, '_>) -> Option<Chopper> {
    let mut number = |key, range| table.required_number(key, range);
    let timing_kohm = number("timing_kohm", 0.1..=10_000.0);
    let timing_nf = number("timing_nf", 0.001..=10_000.0);
    let reference_v = number("reference_v", 0.01..=50.0);
    let sense_ohm = number("sense_ohm", 0.001..=1000.0);
    Some(Chopper {
        peak_a: PEAK_OF_REFERENCE * reference_v? / sense_ohm?,
        off_s: OFF_OF_RC * timing_kohm? * 1e3 * timing_nf? * 1e-9,
    })
}
