//! Configuration of a mill.

use husillo_machine::Config;

/// The fixed properties of a mill, a constant of its firmware.
#[derive(Copy, Clone, Debug)]
pub struct MicromillConfig {
    /// Axes, timer and limits as for [`Machine`](husillo_machine::Machine), without ramps. Backlash
    /// must be below 65 536 steps, and positions within 2.1 m of machine zero. The other settings
    /// of the dialect are not used.
    pub machine: Config<3>,
    /// Step rate of jogs, counted steps and homing, in steps per second.
    pub jog_hz: u16,
    /// Change of the jog rate at a time, in steps per second.
    pub jog_change_hz: u16,
    /// Highest rate of a jog and a run, in steps per second: the rate that the motors follow
    /// without a ramp.
    pub top_hz: u16,
    /// Load steps from the position where a home switch closes to machine zero.
    pub back_off_steps: u16,
    /// Steps of homing without a switch after which the search fails.
    pub search_steps: u32,
}

impl MicromillConfig {
    /// The micro mill: 140 nm per step, 10 x 7 mm, backlash 204 and 178 um, 170 steps per second,
    /// 390 at most, as in `machines/micromill.toml`.
    pub const MICROMILL: MicromillConfig = MicromillConfig {
        machine: micromill(),
        jog_hz: 170,
        jog_change_hz: 10,
        top_hz: 390,
        back_off_steps: 400,
        // 10 mm are 71 429 steps, plus the backlash of 1457.
        search_steps: 80_000,
    };
}

const fn micromill() -> Config<3> {
    use husillo_gcode::{Dialect, Nm};
    use husillo_machine::{Axis, Scale};

    let scale = match Scale::new(140, 1) {
        Some(scale) => scale,
        None => panic!("140 nm is a length"),
    };
    let axis = Axis {
        scale,
        travel: None,
        max_rate_hz: 170,
        lash_steps: 0,
        ramp: None,
    };
    Config {
        axes: [
            Axis {
                travel: Some([Nm(0), Nm(10_000_000)]),
                lash_steps: 1457,
                ..axis
            },
            Axis {
                travel: Some([Nm(0), Nm(7_000_000)]),
                lash_steps: 1271,
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
    }
}
