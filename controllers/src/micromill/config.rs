//! Configuration of a mill.

use husillo_gcode::{Dialect, Nm};
use husillo_machine::{Axis, Config, Equipment, Scale};

/// The fixed properties of a mill, a constant of its firmware.
#[derive(Copy, Clone, Debug)]
pub struct MicromillConfig {
    /// Axes, timer and limits as for [`Machine`](husillo_machine::Machine), without ramps. Backlash
    /// must be below 65 536 steps, and positions within 2.1 m of machine zero. The other settings
    /// of the dialect are not used.
    pub machine: Config<3>,
    /// Step rate of jogs, counted steps and homing, in steps per second.
    pub jog_hz: u16,
    /// Change of the jog rate by one command, in steps per second.
    pub jog_change_hz: u16,
    /// Highest rate of a jog and a run, in steps per second. The motors follow this rate without a
    /// ramp.
    pub top_hz: u16,
    /// Load steps from the position where a home switch closes to machine zero.
    pub back_off_steps: u16,
    /// Longest search of homing towards each switch, in steps, if the position is not known: the
    /// sum of travel, backlash, and the distance to the switch. After it the search fails.
    pub search_steps: [u32; 3],
    /// Longest move of homing away from a closed switch, in steps. It covers the backlash and how
    /// far an axis may be beyond the point where its switch closes. After it homing fails. If the
    /// position is known, a search for the switch ends this many steps beyond machine zero.
    pub leave_steps: u16,
}

impl MicromillConfig {
    /// The micro mill: 140 nm per step, 10 x 7 mm, backlash 204 and 178 um, 170 steps per second,
    /// 390 at most, as in `machines/micromill.toml`.
    pub const MICROMILL: MicromillConfig = MicromillConfig::with_step_of(1);

    /// The micro mill with motors that make `parts` steps for a full step: 1 for full steps, 2 for
    /// half steps, 4 for quarter steps; at most 16. The speeds in mm/min are the same.
    pub const fn with_step_of(parts: u8) -> MicromillConfig {
        let parts = match parts {
            0 => 1,
            1..=16 => parts as u16,
            _ => 16,
        };
        // No product is above 16 times its full steps.
        MicromillConfig {
            machine: micromill(parts),
            jog_hz: parts.wrapping_mul(170),
            jog_change_hz: parts.wrapping_mul(10),
            top_hz: parts.wrapping_mul(390),
            back_off_steps: parts.wrapping_mul(400),
            // 10 mm and 7 mm are 71 429 and 50 000 full steps. Z has no travel: it is about X's.
            search_steps: [
                (parts as u32).wrapping_mul(80_000),
                (parts as u32).wrapping_mul(58_000),
                (parts as u32).wrapping_mul(80_000),
            ],
            // The backlash of 1457, and 0.5 mm.
            leave_steps: parts.wrapping_mul(5000),
        }
    }
}

/// A full step of the motors, in nanometres.
const FULL_STEP_NM: u32 = 140;
const FULL_STEP: Scale = match Scale::new(FULL_STEP_NM, 1) {
    Some(scale) => scale,
    None => panic!("140 nm is a length"),
};

/// The nearest number of steps to a backlash in nanometres. `parts` is 1 to 16.
const fn backlash_steps(nm: u32, parts: u16) -> u32 {
    // Below 2^24.
    let parts_of_nm = nm.wrapping_mul(parts as u32);
    parts_of_nm.wrapping_add(FULL_STEP_NM / 2) / FULL_STEP_NM
}

/// `parts` is 1 to 16.
const fn micromill(parts: u16) -> Config<3> {
    let scale = match Scale::new(FULL_STEP_NM, parts as u32) {
        Some(scale) => scale,
        None => FULL_STEP, // never reached: neither is zero
    };
    let axis = Axis {
        scale,
        travel: None,
        max_rate_hz: parts.wrapping_mul(170) as u32,
        backlash_steps: 0,
        ramp: None,
    };
    Config {
        axes: [
            Axis {
                travel: Some([Nm(0), Nm(10_000_000)]),
                backlash_steps: backlash_steps(204_000, parts),
                ..axis
            },
            Axis {
                travel: Some([Nm(0), Nm(7_000_000)]),
                backlash_steps: backlash_steps(178_000, parts),
                ..axis
            },
            axis,
        ],
        timer_hz: 1_000_000,
        dialect: Dialect::MICROMILL,
        arc_tolerance: None,
        rapid: None,
        top_feed: None,
        spindle_counts: None,
        corner_deviation: None,
        equipment: Equipment::NONE,
    }
}
