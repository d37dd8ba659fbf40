//! A router with ramps, and its acceleration computed from its events alone.

use husillo_backlash::Backlash;
use husillo_gcode::{Dialect, Nm};
use husillo_interp::Path;
use husillo_machine::{Axis, AxisRamp, Config, Equipment, Event, Machine, Scale};

pub const HZ: u32 = 8_000_000;

pub fn config(acceleration_mm_per_s2: [u32; 3]) -> Config<3> {
    Config {
        axes: acceleration_mm_per_s2.map(|acceleration| Axis {
            scale: Scale::new(2_500, 1).unwrap(),
            travel: None,
            max_rate_hz: 40_000,
            backlash_steps: 0,
            ramp: Some(AxisRamp {
                acceleration_hz_per_s: acceleration * 400,
                start_rate_hz: 0,
                jerk_hz_per_s2: None,
                junction_hz: Some(2_000),
            }),
        }),
        timer_hz: HZ,
        dialect: Dialect::RS274.with_arc_tolerance(Some(Nm(500_000))),
        arc_tolerance: None,
        rapid: None,
        top_feed: None,
        corner_deviation: None,
        equipment: Equipment::NONE,
        spindle_counts: None,
    }
}

/// The router with steps of about 0.1 um, so that the steps hide little. Its corners stop.
pub fn fine(acceleration_mm_per_s2: [u32; 3], scales_nm: [u32; 3]) -> Config<3> {
    let mut config = config(acceleration_mm_per_s2);
    let limits = acceleration_mm_per_s2.into_iter().zip(scales_nm);
    for (axis, (limit, nm)) in config.axes.iter_mut().zip(limits) {
        axis.scale = Scale::new(nm, 1).unwrap();
        axis.max_rate_hz = 1_000_000;
        let ramp = axis.ramp.as_mut().unwrap();
        ramp.acceleration_hz_per_s = limit * 1_000_000 / nm;
        ramp.junction_hz = Some(0);
    }
    config
}

/// What the operator does.
#[derive(Copy, Clone, Debug)]
pub enum Act {
    /// Holds. The motion goes on when it stands.
    Hold,
    Override(u8),
}

/// Positions in nm after each event, with their times in seconds. An act happens after the events
/// before it.
pub fn trace(config: Config<3>, program: &str, acts: &[(usize, Act)]) -> Vec<(f64, [f64; 3])> {
    let mut machine: Machine<3, Path<3>, Backlash, 32> = Machine::new(config);
    let mut lines = program.lines().peekable();
    let mut trace = vec![(0.0, [0.0; 3])];
    let (mut ticks, mut is_held) = (0_u64, false);
    loop {
        while let Some(line) = lines.next_if(|_| machine.has_room()) {
            machine.line(line.as_bytes()).unwrap();
        }
        for (_, act) in acts.iter().filter(|(after, _)| *after == trace.len()) {
            match act {
                Act::Hold => {
                    machine.hold();
                    is_held = true;
                }
                Act::Override(percent) => machine.set_feed_override(*percent),
            }
        }
        match machine.next_event() {
            Some(Event::Step(step)) => ticks += u64::from(step.wait_ticks),
            Some(_) => continue,
            None if is_held => {
                machine.resume();
                is_held = false;
                continue;
            }
            None => return trace,
        }
        let steps = machine.position_steps();
        let at = [0, 1, 2].map(|axis: usize| {
            let scale = machine.config().axes[axis].scale;
            f64::from(steps[axis]) * f64::from(scale.nm()) / f64::from(scale.steps())
        });
        trace.push((ticks as f64 / f64::from(HZ), at));
    }
}

/// Largest acceleration of each axis in mm/s^2, from the events alone: second differences of the
/// positions over a window, less than the error of a step at each of the three places.
pub fn accelerations(trace: &[(f64, [f64; 3])], window: f64, step_nm: f64) -> [f64; 3] {
    let error = 2.0 * step_nm / (window * window) / 1e6;
    let mut most = [0.0_f64; 3];
    for found in second_differences(trace, window) {
        for (most, found) in most.iter_mut().zip(found) {
            *most = most.max(found.abs() - error);
        }
    }
    most
}

/// Largest acceleration in any direction of a plane, in the same way.
pub fn acceleration_in_plane(
    trace: &[(f64, [f64; 3])],
    plane: [usize; 2],
    window: f64,
    step_nm: f64,
) -> f64 {
    let error = 2.0 * 2_f64.sqrt() * step_nm / (window * window) / 1e6;
    let sizes = second_differences(trace, window).map(|found| {
        let [first, second] = plane.map(|axis| found[axis]);
        first.hypot(second)
    });
    sizes.fold(0.0, f64::max) - error
}

/// Second differences of the positions in mm/s^2, four in each window.
fn second_differences(
    trace: &[(f64, [f64; 3])],
    window: f64,
) -> impl Iterator<Item = [f64; 3]> + '_ {
    let at = |time: f64, axis: usize| {
        let after = trace
            .partition_point(|(when, _)| *when <= time)
            .min(trace.len() - 1);
        let [(t0, p0), (t1, p1)] = [trace[after - 1], trace[after]];
        let part = ((time - t0) / (t1 - t0)).min(1.0);
        p0[axis] + part * (p1[axis] - p0[axis])
    };
    let seconds = trace.last().unwrap().0;
    let samples = (seconds / window * 4.0) as usize;
    (4..samples.saturating_sub(4)).map(move |sample| {
        let time = sample as f64 * window / 4.0;
        [0, 1, 2].map(|axis| {
            let second = at(time + window, axis) - 2.0 * at(time, axis) + at(time - window, axis);
            second / (window * window) / 1e6
        })
    })
}
