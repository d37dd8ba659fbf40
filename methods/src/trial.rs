//! Measures one method on one or many moves: iterations, error, speed and ripple.

use crate::curve::Curve;
use crate::method::{AXES, Method, Shape};
use serde::Serialize;

/// Numbers of events of the windows of the ripple.
pub const WINDOWS: [usize; 4] = [1, 8, 32, 128];
/// Timer ticks per BLU of path under vector feed.
const TICKS_PER_BLU: f64 = 1000.0;

/// Lowest and highest speed over windows of events.
#[derive(Clone, Debug)]
struct Pace {
    /// Path and time of the last events. The index is the event number modulo the length.
    ring: Vec<[f64; 2]>,
    events: usize,
    extremes: [[f64; 2]; WINDOWS.len()],
}

impl Pace {
    fn new() -> Self {
        Self {
            ring: vec![[0.0; 2]; 129],
            events: 0,
            extremes: [[f64::INFINITY, f64::NEG_INFINITY]; WINDOWS.len()],
        }
    }

    /// Adds an event at `path` BLU and `time` from the start.
    fn add(&mut self, path: f64, time: f64) {
        self.events += 1;
        let length = self.ring.len();
        for (events, [low, high]) in WINDOWS.into_iter().zip(&mut self.extremes) {
            if events > self.events {
                break;
            }
            let [before, since] = self.ring[(self.events - events) % length];
            if time > since {
                let speed = (path - before) / (time - since);
                *low = speed.min(*low);
                *high = speed.max(*high);
            }
        }
        self.ring[self.events % length] = [path, time];
    }

    /// Lowest and highest speed over windows of each length, relative to the mean, in per cent.
    /// They are 0 if the move is shorter than a window.
    fn ripple(&self) -> [[f64; 2]; WINDOWS.len()] {
        let [path, time] = self.ring[self.events % self.ring.len()];
        let mean = path / time;
        self.extremes.map(|[low, high]| {
            if low <= high && mean > 0.0 {
                [100.0 * (low / mean - 1.0), 100.0 * (high / mean - 1.0)]
            } else {
                [0.0; 2]
            }
        })
    }
}

/// The speed along the path, relative to the programmed one.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Speed {
    /// Length per time; 1 is the programmed feed.
    pub mean_speed: f64,
    /// The larger deviation from the mean over 32 events, per cent.
    pub ripple_percent: f64,
    /// Both deviations for each length of window.
    pub ripple_percent_windows: Vec<Ripple>,
}

/// Slowest and fastest window.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Ripple {
    /// Events of the window.
    pub events: usize,
    /// Slowest, relative to the mean, per cent.
    pub low: f64,
    /// Fastest, relative to the mean, per cent.
    pub high: f64,
}

/// Sums over all moves for one kind of timing.
#[derive(Clone, Debug, Default)]
struct Timing {
    time: f64,
    ripple: [[f64; 2]; WINDOWS.len()],
}

impl Timing {
    fn add(&mut self, time: f64, pace: &Pace) {
        self.time += time;
        for ([low, high], [lower, higher]) in self.ripple.iter_mut().zip(pace.ripple()) {
            *low = lower.min(*low);
            *high = higher.max(*high);
        }
    }

    fn speed(&self, length: f64) -> Speed {
        let windows: Vec<Ripple> = WINDOWS
            .into_iter()
            .zip(self.ripple)
            .map(|(events, [low, high])| Ripple {
                events,
                low: rounded(low),
                high: rounded(high),
            })
            .collect();
        Speed {
            mean_speed: rounded(length / self.time.max(f64::MIN_POSITIVE)),
            ripple_percent: windows
                .iter()
                .find(|ripple| ripple.events == 32)
                .map_or(0.0, |ripple| ripple.high.max(-ripple.low)),
            ripple_percent_windows: windows,
        }
    }
}

/// Rounds to six decimals.
fn rounded(value: f64) -> f64 {
    (value * 1e6).round() / 1e6 + 0.0
}

/// The results of one method on all moves so far.
#[derive(Clone, Debug, Default)]
pub struct Tally {
    /// Number of moves.
    pub moves: u64,
    /// Passes of the loop.
    pub iterations: u64,
    /// Passes with a step.
    pub moving: u64,
    /// Largest error, BLU.
    pub max_error_blu: f64,
    /// Position of the largest error, in the first two axes.
    pub worst_at: [f64; 2],
    /// Whether any centre was between the steps.
    pub is_between: bool,
    sum_of_squares: f64,
    length: f64,
    equal: Timing,
    vector: Option<Timing>,
}

impl Tally {
    /// Makes a move and measures it against its curve.
    ///
    /// # Errors
    ///
    /// Why the method cannot make the move.
    pub fn walk(&mut self, method: &Method, shape: &Shape, curve: &Curve) -> Result<(), String> {
        let (events, units) = method.events(shape)?;
        let mut at = start(shape);
        let (mut path, mut sweep, mut beats) = (0.0, 0.0, 0_u64);
        let (mut equal, mut vector) = (Pace::new(), Pace::new());
        let mut ticks = 0.0;
        for step in events {
            let next = stepped(&at, &step.deltas());
            path += curve.progress(&at, &next);
            at = next;
            self.iterations += 1;
            self.moving += u64::from(step.axes != 0);
            if step.axes != 0 || method.times_idle {
                beats += 1;
                equal.add(path, beats as f64);
            }
            if let Some(units) = units {
                sweep += f64::from(step.sweep);
                ticks = (sweep * TICKS_PER_BLU / units).floor();
                vector.add(path, ticks);
            }
            let error = curve.distance(&at);
            self.sum_of_squares += error * error;
            if error > self.max_error_blu {
                self.max_error_blu = error;
                self.worst_at = [at[0], at[1]];
            }
        }
        self.moves += 1;
        self.is_between |= matches!(shape, Shape::Arc(arc) if arc.fraction_bits > 0);
        self.length += curve.length();
        if beats > 0 {
            self.equal.add(beats as f64, &equal);
        }
        if units.is_some() && vector.events > 0 {
            let timing = self.vector.get_or_insert_default();
            timing.add(ticks / TICKS_PER_BLU, &vector);
        }
        Ok(())
    }

    /// Root mean square of the error after every pass, BLU.
    pub fn rms_error_blu(&self) -> f64 {
        (self.sum_of_squares / (self.iterations.max(1) as f64)).sqrt()
    }

    /// The speed if every timed pass takes the time of one BLU.
    pub fn equal_time(&self) -> Speed {
        self.equal.speed(self.length)
    }

    /// The speed if every event takes the time of its own path. `None` for methods whose passes are
    /// all one BLU.
    pub fn vector_feed(&self) -> Option<Speed> {
        self.vector.as_ref().map(|timing| timing.speed(self.length))
    }
}

/// The start of a move.
pub fn start(shape: &Shape) -> [f64; AXES] {
    let mut at = [0.0; AXES];
    if let Shape::Arc(arc) = shape {
        at[..2].copy_from_slice(&arc.from.map(f64::from));
    }
    at
}

/// The point after one step.
pub fn stepped(at: &[f64; AXES], delta: &[i8; AXES]) -> [f64; AXES] {
    std::array::from_fn(|axis| at[axis] + f64::from(delta[axis]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::method::{ARCS, by_name};
    use husillo_interp::{ArcMove, Direction, Rim};

    fn circle(name: &str, radius: i32) -> Tally {
        let arc = ArcMove {
            from: [radius, 0],
            to: [radius, 0],
            centre: [0; 2],
            fraction_bits: 0,
            direction: Direction::CounterClockwise,
            turns: 0,
            rim: Rim::Spiral,
        };
        let mut tally = Tally::default();
        let curve = Curve::of(&arc, None);
        let method = by_name(&ARCS, name, "arcs").unwrap();
        tally.walk(method, &Shape::Arc(arc), &curve).unwrap();
        tally
    }

    /// The table was measured by an independent program: per cent of the mean over 1, 8, 32 and 128
    /// events, with a radius of 1000.
    #[test]
    fn ripple_equals_that_of_an_independent_program() {
        let table = [
            (
                "staircase-printed",
                0.785,
                [[-99.9, 27.4], [-12.4, 27.4], [-10.1, 27.4], [-10.0, 24.4]],
            ),
            (
                "direct-search-printed",
                1.111,
                [[-34.4, 27.3], [-10.6, 27.3], [-10.0, 27.3], [-9.9, 22.5]],
            ),
            (
                "dda-printed",
                1.040,
                [[-77.8, 36.1], [-15.4, 35.9], [-5.7, 11.3], [-3.8, 5.2]],
            ),
        ];
        for (name, mean, ripple) in table {
            let speed = circle(name, 1000).equal_time();
            assert!((speed.mean_speed - mean).abs() < 6e-4, "{name} {speed:?}");
            for (window, [low, high]) in speed.ripple_percent_windows.iter().zip(ripple) {
                assert!(
                    (window.low - low).abs() < 0.6 && (window.high - high).abs() < 0.6,
                    "{name} {speed:?}"
                );
            }
        }
    }

    #[test]
    fn vector_feed_has_an_even_speed() {
        let speed = circle("direct-search", 1000).vector_feed().unwrap();
        assert!((speed.mean_speed - 1.0).abs() < 1e-4, "{speed:?}");
        assert!(speed.ripple_percent_windows[0].high < 0.21, "{speed:?}");
        assert!(circle("dda", 1000).vector_feed().is_none());
    }
}
