//! Checks that use only the events (axes and times), never what the planner reports about itself.

use crate::{
    moves::{ACCELERATION, JUMP, Move},
    runner::Event,
};

/// Largest acceleration seen, as a multiple of the limit: the cubic of a piece, see `Ramp`.
const SEEN: f64 = 1.036;

/// Largest error of an event within a piece, in intervals. It shows only where a hold or an
/// override ends a piece.
const LATE: f64 = 0.04;

/// A piece of path with its duration: some events, or a part of them.
#[derive(Copy, Clone, Debug, Default)]
struct Window {
    nm: f64,
    ticks: f64,
    acceleration: f64,
    top: f64,
    /// Length of the longest event of its moves.
    longest_nm: f64,
}

impl Window {
    /// Speed in nm/s, and the error that a tick at either end, and this part of the time, cause.
    fn speed(&self, hz: f64, late: f64) -> (f64, f64) {
        let speed = self.nm * hz / self.ticks;
        let event = self.ticks * (self.longest_nm / self.nm).max(1.0);
        (speed, speed * (1.0 + late * event) / (self.ticks - 1.0))
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
        let longest = moves[event.of].sweeps.iter().max().unwrap();
        let longest_nm = moves[event.of].length_of(*longest);
        window.longest_nm = window.longest_nm.max(longest_nm);
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
    let late = if is_override_fixed { 0.0 } else { LATE };
    let all = windows(moves, events, least_ticks);
    for window in &all {
        let (speed, tick) = window.speed(hz, late);
        // After a reduced override the path is still above it; only the ramp is checked then.
        if is_override_fixed {
            assert!(speed <= window.top + tick + 1.0, "{speed} of {window:?}");
        }
    }
    for pair in all.windows(2) {
        let [(first, first_tick), (second, second_tick)] =
            [pair[0].speed(hz, late), pair[1].speed(hz, late)];
        let seconds = (pair[0].ticks + pair[1].ticks + 2.0) / 2.0 / hz;
        let acceleration = pair[0].acceleration.max(pair[1].acceleration);
        let most = acceleration * seconds * SEEN + first_tick + second_tick + 4.0;
        assert!(
            (second - first).abs() <= most,
            "{first} to {second} with {most} in {pair:?}"
        );
    }
}

/// Checks the speed of each axis at every corner and the acceleration of each axis along every
/// line. `is_steady`: nothing ended a piece early.
pub fn check_axes(moves: &[Move], events: &[Event], hz: u32, is_steady: bool) {
    let late = if is_steady { 0.0 } else { LATE };
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
                let ticks = pair[side].ticks as f64;
                speed.abs() * ((1.0 + late * ticks) / (ticks - 1.0) + 0.5 / length)
            };
            let tick = error(first, 0) + error(second, 1);
            let most = ACCELERATION[axis] as f64 * seconds * SEEN + jump + tick + 4.0;
            assert!(
                (second - first).abs() <= most,
                "axis {axis}: {first} to {second} with {most} at {pair:?}"
            );
        }
    }
}

/// The best possible motion, from the whole list of moves in floating point: a forward and a
/// backward pass over their ends, and the exact time on the path between them.
pub struct Optimum {
    /// Square of the speed at the start of each move and at the end of the last one.
    ends: Vec<f64>,
}

impl Optimum {
    pub fn new(moves: &[Move], percent: u8) -> Optimum {
        let gain = |one: &Move| {
            2.0 * one.stretch.acceleration_nm_per_s2 as f64 * one.stretch.length_nm as f64
        };
        let top = |one: &Move| f64::from(one.stretch.top_at(percent)).powi(2);
        let mut ends = vec![0.0; moves.len() + 1];
        for (number, pair) in (1..).zip(moves.windows(2)) {
            let entry = f64::from(pair[1].stretch.entry_limit_nm_per_s).powi(2);
            ends[number] = entry.min(top(&pair[0])).min(top(&pair[1]));
        }
        for (number, one) in (0..).zip(moves) {
            ends[number + 1] = f64::min(ends[number + 1], ends[number] + gain(one));
        }
        for (number, one) in (0..moves.len()).zip(moves).rev() {
            ends[number] = f64::min(ends[number], ends[number + 1] + gain(one));
        }
        Optimum { ends }
    }

    /// Speed and time after `at` of the length of a move, in nm/s and seconds from its start, and
    /// whether the acceleration changes within `around` of it.
    pub fn at(
        &self,
        number: usize,
        one: &Move,
        percent: u8,
        at: f64,
        around: f64,
    ) -> (f64, f64, bool) {
        let a = one.stretch.acceleration_nm_per_s2 as f64;
        let length = one.stretch.length_nm as f64;
        let top = f64::from(one.stretch.top_at(percent)).powi(2);
        let [first, last] = [self.ends[number], self.ends[number + 1]];
        // Where the ramps would meet, and where they meet the top.
        let apex = ((last - first) / (2.0 * a) + length) / 2.0;
        let up = ((top - first) / (2.0 * a)).min(apex);
        let down = (length - (top - last) / (2.0 * a)).max(apex);
        let peak = (first + 2.0 * a * up).sqrt();
        let (speed, time) = if at <= up {
            let speed = (first + 2.0 * a * at).sqrt();
            (speed, (speed - first.sqrt()) / a)
        } else if at <= down {
            (peak, (peak - first.sqrt()) / a + (at - up) / peak)
        } else {
            let speed = (last + 2.0 * a * (length - at)).max(0.0).sqrt();
            let level = (peak - first.sqrt()) / a + (down - up) / peak;
            (speed, level + (peak - speed) / a)
        };
        let is_near = |corner: f64| (at - corner).abs() <= around;
        (speed, time, is_near(up) || is_near(down))
    }
}
