//! Settings of machines that suit the simulated motors.

use crate::heads::{
    AxisSettings, Errors, Machine, ProbeSettings, Stylus, Switches, Wiring, pre_travel_by_sign,
};
use crate::quantity::Fraction;
use crate::scale::Scale;
use husillo_sim::DcMotorModel;
use husillo_transports::nmc::{Baud, Gains};

/// With these gains every move of the simulated motor ends at most a count from its goal.
const GAINS: Gains = Gains {
    proportional: 2000,
    integral: 50,
    derivative: 16_000,
    integration_limit: 8000,
    output_limit: 255,
    current_limit: 0,
    error_limit: 400,
    rate_divisor: 1,
    dead_band: 0,
    step_multiplier: None,
};

const fn axis(letter: char, module: u8, travel: i32) -> AxisSettings {
    AxisSettings {
        letter,
        module,
        travel: [-travel, travel],
        in_position: 1,
        rate: 1200,
        acceleration: 6000,
        limits: [Wiring::Probe, Wiring::Nothing],
        gains: GAINS,
        motor: DcMotorModel::PROTOTYPE,
    }
}

fn probe(radius_nm: i32) -> ProbeSettings {
    ProbeSettings {
        rate: 200,
        slow_rate: 40,
        back_off: 60,
        over_travel: 100,
        switches: Switches::One,
        stylus: Stylus {
            radius_nm,
            pre_travel: pre_travel_by_sign([0; 2]),
        },
    }
}

/// A machine with one axis X. Its travel is 8000 counts to each side of home. The length of a
/// count is not known.
#[must_use]
pub fn one_axis() -> Machine {
    Machine {
        title: "Measuring machine, one axis, 400 counts a turn".into(),
        scale: Scale::new(None),
        axes: vec![axis('X', 1, 8000)],
        probe: probe(0),
        baud: Baud::B19200,
        errors: Errors::default(),
    }
}

/// A machine with three axes and scales of 2 um. The travel of each is 200 mm to each side of
/// home. The ball has a radius of 1 mm.
#[must_use]
pub fn three_axes() -> Machine {
    Machine {
        title: "Measuring machine, three axes, scales of 2 um".into(),
        scale: Scale::new(Some(Fraction { num: 2000, den: 1 })),
        axes: vec![
            axis('X', 1, 100_000),
            axis('Y', 2, 100_000),
            axis('Z', 3, 100_000),
        ],
        probe: probe(1_000_000),
        baud: Baud::B115200,
        errors: Errors::default(),
    }
}
