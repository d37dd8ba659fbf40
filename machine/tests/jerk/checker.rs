//! Speed, acceleration and jerk along the path, from the events alone.
//!
//! A difference of order n of the path, over a span h, is h^n times a mean of its derivative. So it
//! is at most h^n times the limit, and errors of the positions: each is at most a step off.

use husillo_gcode::Command;
use husillo_machine::Segment;

use crate::machines::{Facts, STEP, TIMER_HZ};

#[derive(Debug)]
pub struct Checker {
    /// Limits along the path in nm and s.
    acceleration: f64,
    jerk: f64,
    /// The window, acceleration / jerk.
    window: f64,
    ticks: u64,
    load: [i64; 3],
    segment: Option<Segment<3>>,
    /// Path before the present move, and in it.
    before: f64,
    within: f64,
    /// Time in s and path in nm of each event.
    points: Vec<(f64, f64)>,
    /// The axes in nm at each event.
    axes: Vec<[f64; 3]>,
}

impl Checker {
    pub fn new(axes: [Facts; 3]) -> Self {
        let least = axes.iter().map(|axis| axis.acceleration).min().unwrap();
        let jerk = axes.iter().filter_map(|axis| axis.jerk).min();
        let acceleration = f64::from(least) * 1e6 * 0.866;
        let jerk = f64::from(jerk.unwrap_or(1)) * 1e9;
        Checker {
            acceleration,
            jerk,
            window: acceleration / jerk,
            ticks: 0,
            load: [0; 3],
            segment: None,
            before: 0.0,
            within: 0.0,
            points: vec![(0.0, 0.0)],
            axes: vec![[0.0; 3]],
        }
    }

    pub fn wait(&mut self, ticks: u32) {
        self.ticks += u64::from(ticks);
    }

    pub fn seconds(&self) -> f64 {
        self.ticks as f64 / f64::from(TIMER_HZ)
    }

    /// A step of the path in this move.
    pub fn step(&mut self, segment: &Segment<3>, delta: [i8; 3]) {
        if self.segment.as_ref() != Some(segment) {
            self.before += self.segment.map_or(0.0, |segment| length(&segment));
            self.segment = Some(*segment);
            self.within = 0.0;
        }
        for (load, delta) in self.load.iter_mut().zip(delta) {
            *load += i64::from(delta);
        }
        self.within = self.place(segment);
        let place = self.before + self.within;
        self.points.push((self.seconds(), place));
        self.axes.push(self.load.map(|steps| steps as f64 * STEP));
    }

    /// Path since the start of the move, of the point nearest to the load.
    fn place(&self, segment: &Segment<3>) -> f64 {
        let at = self.load.map(|steps| steps as f64 * STEP);
        let from = segment.from.map(|from| from.0 as f64);
        if let Command::Arc { arc, .. } = segment.command {
            let centre = arc.centre.map(|centre| centre.0 as f64);
            let angle = |x: f64, y: f64| (y - centre[1]).atan2(x - centre[0]);
            let turned = angle(at[0], at[1]) - angle(from[0], from[1]);
            let turned = match arc.direction {
                husillo_gcode::Direction::Clockwise => -turned,
                husillo_gcode::Direction::CounterClockwise => turned,
            };
            // Next to the angle of the step before.
            let radius = (from[0] - centre[0]).hypot(from[1] - centre[1]);
            let turn = std::f64::consts::TAU;
            let turns = ((self.within / radius - turned) / turn).round();
            return (turned + turns * turn) * radius;
        }
        let to = segment.command.end().unwrap().map(|to| to.0 as f64);
        let way: [f64; 3] = std::array::from_fn(|axis| to[axis] - from[axis]);
        let whole = way.iter().map(|way| way * way).sum::<f64>().sqrt();
        let product: f64 = (0..3).map(|axis| (at[axis] - from[axis]) * way[axis]).sum();
        product / whole
    }

    /// Steps of X.
    pub fn steps(&self) -> i64 {
        self.load[0]
    }

    /// The path stands where it is.
    pub fn finish(&mut self) {
        let place = self.before + self.within;
        self.points.push((self.seconds() + 1.0, place));
    }

    /// Times of the steps of the path in s.
    pub fn times(&self) -> impl Iterator<Item = f64> + Clone {
        // The last point is not a step.
        let count = self.axes.len() - 1;
        self.points
            .iter()
            .skip(1)
            .take(count)
            .map(|(time, _)| *time)
    }

    /// Time at which the path is at a place in nm.
    pub fn time_of(&self, place: f64) -> f64 {
        let after = self.points.partition_point(|(_, at)| *at < place);
        self.points[after].0
    }

    /// The axes at a time in nm.
    pub fn axes_at(&self, time: f64) -> [f64; 3] {
        let after = self.points.partition_point(|(at, _)| *at <= time);
        let last = self.axes.len() - 1;
        let [from, to] = [after.max(1) - 1, after].map(|place| self.axes[place.min(last)]);
        let start = self.points[after.max(1) - 1].0;
        let end = self.points.get(after).map_or(start + 1.0, |point| point.0);
        let part = (time - start) / (end - start);
        std::array::from_fn(|axis| from[axis] + (to[axis] - from[axis]) * part)
    }

    /// Path at a time in nm.
    pub fn place_at(&self, time: f64) -> f64 {
        let after = self.points.partition_point(|(at, _)| *at <= time);
        let Some((end, to)) = self.points.get(after) else {
            return self.before + self.within;
        };
        let Some((start, from)) = after.checked_sub(1).map(|before| self.points[before]) else {
            return 0.0;
        };
        // Between two events that are far apart, the path may stand at any time.
        from + (to - from) * (time - start) / (end - start)
    }

    /// Largest ratios of speed, acceleration and jerk to their limits, beyond the error of the
    /// positions.
    pub fn ratios(&self, top: f64) -> [f64; 3] {
        let span = self.window / 4.0;
        let count = (self.seconds() / span * 3.0) as usize;
        let mut ratios = [0.0_f64; 3];
        for sample in 0..count {
            let time = sample as f64 * span / 3.0;
            let [a, b, c, d] = [0.0, 1.0, 2.0, 3.0].map(|part| self.place_at(time + part * span));
            let differences = [
                (b - a - 2.0 * STEP) / (top * span),
                ((c - 2.0 * b + a).abs() - 4.0 * STEP) / (self.acceleration * span.powi(2)),
                ((d - 3.0 * c + 3.0 * b - a).abs() - 8.0 * STEP) / (self.jerk * span.powi(3)),
            ];
            for (ratio, difference) in ratios.iter_mut().zip(differences) {
                *ratio = ratio.max(difference);
            }
        }
        ratios
    }

    pub fn check(&self, top: f64) {
        let ratios = self.ratios(top);
        assert!(
            ratios.iter().all(|ratio| *ratio <= 1.0 + 1e-9),
            "{ratios:?}"
        );
    }
}

/// Length of a move in the plane XY, or of a line.
fn length(segment: &Segment<3>) -> f64 {
    let from = segment.from.map(|from| from.0 as f64);
    let to = segment.command.end().unwrap().map(|to| to.0 as f64);
    if let Command::Arc { arc, .. } = segment.command {
        let centre = arc.centre.map(|centre| centre.0 as f64);
        let angle = |at: [f64; 3]| (at[1] - centre[1]).atan2(at[0] - centre[0]);
        let turned = match arc.direction {
            husillo_gcode::Direction::Clockwise => angle(from) - angle(to),
            husillo_gcode::Direction::CounterClockwise => angle(to) - angle(from),
        };
        let radius = (from[0] - centre[0]).hypot(from[1] - centre[1]);
        let turn = std::f64::consts::TAU;
        let turned = turned.rem_euclid(turn);
        return if turned < 1e-9 { turn } else { turned } * radius;
    }
    let squares = (0..3).map(|axis| (to[axis] - from[axis]).powi(2));
    squares.sum::<f64>().sqrt()
}
