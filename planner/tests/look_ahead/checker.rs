//! Checks that use only the events (axes and times), never what the planner reports about itself.

use crate::{
    moves::{ACCELERATION, JUMP, Move},
    runner::Event,
};

/// A piece of path with its duration: some events, or a part of them.
#[derive(Copy, Clone, Debug, Default)]
struct Window {
    nm: f64,
    ticks: f64,
    acceleration: f64,
    top: f64,
}

impl Window {
    /// Speed in nm/s, and the error that a tick at either end causes.
    fn speed(&self, hz: f64) -> (f64, f64) {
        let speed = self.nm * hz / self.ticks;
        (speed, speed / (self.ticks - 1.0))
    }
}

/// Groups events into windows of at least `least_ticks`; an incomplete window at the end is
/// dropped.
fn windows(moves: &[Move], events: &[Event], least_ticks: f64) -> Vec<Window> {
    let mut all = Vec::new();
    let mut window = Window::default();
    for event in events {
        let stretch = &moves[event.of].stretch;
        window.nm += event.length_nm;
        window.ticks += event.ticks as f64;
        window.acceleration = window
            .acceleration
            .max(stretch.acceleration_nm_per_s2 as f64);
        window.top = window.top.max(f64::from(stretch.top_at(event.percent)));
        if window.ticks >= least_ticks {
            all.push(std::mem::take(&mut window));
        }
    }
    all
}

/// Checks speed and acceleration along the path over windows of about `least_ticks`.
///
/// When the acceleration never exceeds a, the mean speeds of two neighbouring windows of T and U
/// seconds differ by at most a (T + U) / 2. The tolerance adds a tick at each end of a window and
/// the rounding of speeds to 1 nm/s.
pub fn check_path(
    moves: &[Move],
    events: &[Event],
    hz: u32,
    least_ticks: f64,
    is_override_fixed: bool,
) {
    let hz = f64::from(hz);
    let all = windows(moves, events, least_ticks);
    for window in &all {
        let (speed, tick) = window.speed(hz);
        // After a reduced override the path is still above it; only the ramp is checked then.
        if is_override_fixed {
            assert!(speed <= window.top + tick + 1.0, "{speed} of {window:?}");
        }
    }
    for pair in all.windows(2) {
        let [(first, first_tick), (second, second_tick)] = [pair[0].speed(hz), pair[1].speed(hz)];
        let seconds = (pair[0].ticks + pair[1].ticks + 2.0) / 2.0 / hz;
        let acceleration = pair[0].acceleration.max(pair[1].acceleration);
        let most = acceleration * seconds * (1.0 + 1e-6) + first_tick + second_tick + 4.0;
        assert!(
            (second - first).abs() <= most,
            "{first} to {second} with {most} in {pair:?}"
        );
    }
}

/// Checks the speed of each axis at every corner and the acceleration of each axis along every
/// line.
pub fn check_axes(moves: &[Move], events: &[Event], hz: u32) {
    let hz = f64::from(hz);
    for pair in events.windows(2) {
        let [before, after] = [&moves[pair[0].of], &moves[pair[1].of]];
        for axis in 0..2 {
            let [first, second] = [0, 1].map(|side| {
                let event = &pair[side];
                let along = [before, after][side].direction[axis];
                event.length_nm * hz / event.ticks as f64 * along
            });
            let seconds = (pair[0].ticks + pair[1].ticks) as f64 / 2.0 / hz;
            let jump = if pair[0].of == pair[1].of {
                0.0
            } else {
                f64::from(JUMP[axis])
            };
            // A tick at either end; lengths are rounded to whole nm.
            let error = |speed: f64, side: usize| {
                let length = [before, after][side].stretch.length_nm as f64;
                speed.abs() * (1.0 / (pair[side].ticks as f64 - 1.0) + 0.5 / length)
            };
            let tick = error(first, 0) + error(second, 1);
            let most = ACCELERATION[axis] as f64 * seconds * (1.0 + 1e-6) + jump + tick + 4.0;
            assert!(
                (second - first).abs() <= most,
                "axis {axis}: {first} to {second} with {most} at {pair:?}"
            );
        }
    }
}

/// The best possible speeds at every event, from the whole list of moves in floating point: one
/// forward and one backward pass over all events. Returns squares, one more than there are events.
pub fn optimum(moves: &[Move], percent: u8) -> Vec<f64> {
    let mut allowed = vec![0.0_f64];
    let mut gains = Vec::new();
    for (now, number) in moves.iter().zip(0_usize..) {
        let stretch = &now.stretch;
        let top = f64::from(stretch.top_at(percent)).powi(2);
        let entry = f64::from(stretch.entry_limit_nm_per_s).powi(2);
        let start = if number == 0 { 0.0 } else { entry };
        let last = allowed.last_mut().unwrap();
        *last = last.min(top).min(start);
        for sweep in &now.sweeps {
            let length = now.length_of(*sweep);
            gains.push(2.0 * stretch.acceleration_nm_per_s2 as f64 * length);
            allowed.push(top);
        }
    }
    *allowed.last_mut().unwrap() = 0.0;
    for (number, gain) in (0..gains.len()).zip(&gains) {
        allowed[number + 1] = allowed[number + 1].min(allowed[number] + gain);
    }
    for (number, gain) in (0..gains.len()).zip(&gains).rev() {
        allowed[number] = allowed[number].min(allowed[number + 1] + gain);
    }
    allowed
}
