//! Integrates the jerks of the slices alone, and compares the path with the limits.

use husillo_planner::{JerkLimits, Slice};

use crate::moves::Move;

/// Largest ratios to the limits seen so far.
#[derive(Clone, Copy, Debug, Default)]
pub struct Seen {
    pub acceleration: f64,
    /// Acceleration in a move beside that of the move.
    pub own: f64,
    pub jerk: f64,
    pub top: f64,
    pub corner: f64,
    /// Longest way back in a slice, in units.
    pub backwards: f64,
    pub seconds: f64,
}

impl Seen {
    pub fn join(&mut self, other: &Seen) {
        self.acceleration = self.acceleration.max(other.acceleration);
        self.own = self.own.max(other.own);
        self.jerk = self.jerk.max(other.jerk);
        self.top = self.top.max(other.top);
        self.corner = self.corner.max(other.corner);
        self.backwards = self.backwards.max(other.backwards);
        self.seconds += other.seconds;
    }

    /// Whether a limit is exceeded by more than a millionth.
    pub fn fault(&self) -> bool {
        let worst = self
            .acceleration
            .max(self.own)
            .max(self.jerk)
            .max(self.top)
            .max(self.corner);
        worst > 1.000_001 || self.backwards > 0.0
    }
}

/// The path, integrated exactly: only a jerk is taken from each slice.
pub struct Checker<'a> {
    limits: JerkLimits,
    moves: &'a [Move],
    /// Programmed tops are held against this percentage.
    percent: u8,
    /// Seconds per slice.
    slice: f64,
    /// Units per nanometre.
    scale: f64,
    /// Where each move ends, in units.
    ends: Vec<i128>,
    /// The move in which the path is.
    at: usize,
    /// Units, units per slice, and half of the units per slice^2.
    position: i128,
    speed: i128,
    bend: i128,
    pub seen: Seen,
}

impl<'a> Checker<'a> {
    pub fn new(limits: JerkLimits, moves: &'a [Move], percent: u8, units_per_nm: u32) -> Self {
        let mut end = 0;
        let ends = moves
            .iter()
            .map(|one| {
                end += i128::from(one.stretch.length_nm) * i128::from(units_per_nm);
                end
            })
            .collect();
        Checker {
            limits,
            moves,
            percent,
            slice: 0.0,
            scale: f64::from(units_per_nm),
            ends,
            at: 0,
            position: 0,
            speed: 0,
            bend: 0,
            seen: Seen::default(),
        }
    }

    /// Seconds of the next slice; they change only at rest.
    pub fn set_slice(&mut self, slice: f64) {
        assert!(slice == self.slice || (self.speed, self.bend) == (0, 0));
        self.slice = slice;
    }

    pub fn pass(&mut self, slice: &Slice) {
        let twist = i128::from(slice.twist);
        let scale = self.scale;
        let ratio = |value: f64, limit: u64| value.abs() / scale / limit as f64;
        let jerk = 6.0 * twist as f64 / self.slice.powi(3);
        self.seen.jerk = self.seen.jerk.max(ratio(jerk, self.limits.jerk_nm_per_s3));
        for part in 0..8 {
            self.look(twist, f64::from(part) / 8.0);
        }
        self.pass_corners(twist);
        let length = self.speed + self.bend + twist;
        self.seen.backwards = self.seen.backwards.max(-length as f64);
        self.position += length;
        self.speed += 2 * self.bend + 3 * twist;
        self.bend += 3 * twist;
        let acceleration = 2.0 * self.bend as f64 / self.slice.powi(2);
        let acceleration = ratio(acceleration, self.limits.acceleration_nm_per_s2);
        self.seen.acceleration = self.seen.acceleration.max(acceleration);
        self.seen.seconds += self.slice;
    }

    /// Path since the start of the slice in units, and speed in nm/s.
    fn state(&self, twist: i128, x: f64) -> (f64, f64) {
        let [speed, bend, twist] = [self.speed, self.bend, twist].map(|value| value as f64);
        let path = x * (speed + x * (bend + x * twist));
        let slope = speed + x * (2.0 * bend + x * 3.0 * twist);
        (path, slope / self.scale / self.slice)
    }

    /// Distance from the start of the slice to the end of a move, in units.
    fn distance(&self, at: usize) -> f64 {
        (self.ends[at] - self.position) as f64
    }

    /// Compares speed and acceleration with those of the move.
    fn look(&mut self, twist: i128, x: f64) {
        let (path, speed) = self.state(twist, x);
        let mut at = self.at;
        while at + 1 < self.ends.len() && self.distance(at) <= path {
            at += 1;
        }
        // At the border of two moves, rounding decides.
        let border = 1e-9 * self.scale * self.slice * speed + 1.0;
        let is_border =
            self.distance(at) - path < border || (at > 0 && path - self.distance(at - 1) < border);
        if !is_border {
            let top = f64::from(self.moves[at].stretch.top_at(self.percent));
            self.see_top(speed, top);
            let own = self.moves[at].stretch.acceleration_nm_per_s2 as f64;
            let bend = self.bend as f64 + 3.0 * x * twist as f64;
            let acceleration = 2.0 * bend / self.slice.powi(2) / self.scale;
            // A top speed of a unit per slice is always allowed.
            let least = 96.0 / self.scale / self.slice / (16.0 * self.slice);
            self.seen.own = self.seen.own.max(acceleration.abs() / own.max(least));
        }
    }

    fn see_top(&mut self, speed: f64, top: f64) {
        // Tops below a unit per slice count as a unit.
        let least = 96.0 / self.scale / self.slice;
        self.seen.top = self.seen.top.max(speed / top.max(least));
    }

    /// Compares the speed at each junction with its limit.
    fn pass_corners(&mut self, twist: i128) {
        let end = self.position + self.speed + self.bend + twist;
        while self.at + 1 < self.moves.len() && self.ends[self.at] <= end {
            let corner = self.distance(self.at);
            let (mut low, mut high) = (0.0, 1.0);
            for _ in 0..60 {
                let middle = (low + high) / 2.0;
                if self.state(twist, middle).0 < corner {
                    low = middle;
                } else {
                    high = middle;
                }
            }
            let speed = self.state(twist, low).1;
            self.at += 1;
            let limit = f64::from(self.moves[self.at].stretch.entry_limit_nm_per_s);
            // 1 um/s is no jump.
            let ratio = (speed - 1_000.0) / limit.max(1_000.0);
            self.seen.corner = self.seen.corner.max(ratio);
        }
    }

    /// Whether the path is exactly at the end of the last move, at rest.
    pub fn is_done(&self) -> bool {
        Some(&self.position) == self.ends.last() && (self.speed, self.bend) == (0, 0)
    }
}
