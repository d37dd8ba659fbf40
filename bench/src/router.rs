use husillo_backlash::Backlash;
use husillo_gcode::{Dialect, Nm};
use husillo_interp::Path;
use husillo_machine::{Axis, AxisRamp, Config, Equipment, Machine, Scale};

/// The machine of the comparisons with Grbl.
pub type Router = Machine<3, Path<3>, Backlash, 32>;

/// Rate of the timer of [`router`]: that of an Arduino.
pub const ROUTER_HZ: u32 = 16_000_000;

/// A router of three axes: 2.5 um per step, 6000 mm/min, 500 mm/s^2, and corners with a deviation
/// of 0.01 mm, which is Grbl's default. Always present: the scale is not 0.
#[must_use]
pub fn router() -> Option<Router> {
    let axis = Axis {
        scale: Scale::new(2_500, 1)?,
        travel: None,
        max_rate_hz: 40_000,
        backlash_steps: 0,
        ramp: Some(AxisRamp {
            acceleration_hz_per_s: 200_000,
            start_rate_hz: 0,
            jerk_hz_per_s2: None,
            junction_hz: None,
        }),
    };
    Some(Router::new(Config {
        axes: [axis; 3],
        timer_hz: ROUTER_HZ,
        dialect: Dialect::RS274,
        arc_tolerance: None,
        rapid: None,
        top_feed: None,
        corner_deviation: Some(Nm(10_000)),
        equipment: Equipment::NONE,
        spindle_counts: None,
    }))
}
