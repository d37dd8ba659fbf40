//! How often the axes of a program turn round, from its geometry alone.

use husillo_gcode::{Arc, Direction, Nm};

/// Counts turn-rounds of every axis.
#[derive(Debug)]
pub struct Turns {
    direction: [i8; 3],
    reversals: [u64; 3],
}

impl Turns {
    /// Every axis has come off its switch in positive direction.
    pub const fn new() -> Self {
        Self {
            direction: [1; 3],
            reversals: [0; 3],
        }
    }

    /// Turn-rounds so far.
    pub const fn reversals(&self) -> [u64; 3] {
        self.reversals
    }

    fn go(&mut self, axis: usize, direction: i8) {
        if direction != 0 && direction != self.direction[axis] {
            self.direction[axis] = direction;
            self.reversals[axis] += 1;
        }
    }

    /// A straight move.
    pub fn line(&mut self, from: [Nm; 3], to: [Nm; 3]) {
        for axis in 0..3 {
            self.go(axis, (to[axis].0 - from[axis].0).signum() as i8);
        }
    }

    /// An arc: quarter by quarter, as an axis turns round where the arc passes from one to the next.
    pub fn arc(&mut self, from: [Nm; 3], arc: &Arc<3>) {
        let [a, b] = arc.plane.axes();
        let across = 3 - a - b;
        self.go(across, (arc.to[across].0 - from[across].0).signum() as i8);
        let angle = |p: [Nm; 3]| {
            ((p[b].0 - arc.centre[b].0) as f64).atan2((p[a].0 - arc.centre[a].0) as f64)
        };
        let sense = if arc.direction == Direction::CounterClockwise {
            1.0
        } else {
            -1.0
        };
        let turn = std::f64::consts::TAU;
        let mut sweep = (sense * (angle(arc.to) - angle(from))).rem_euclid(turn);
        if sweep < 1e-9 {
            sweep = turn;
        }
        let quarter = turn / 4.0;
        // Clockwise is the mirror image: the second axis goes the other way.
        let start = (sense * angle(from)).rem_euclid(turn) / quarter;
        let first = (start + 1e-9).floor();
        let last = (start + sweep / quarter - 1e-9).floor();
        // A whole turn repeats itself, and so do the turn-rounds in it.
        let quarters = (last - first) as u64;
        for k in 0..=quarters {
            let (da, db) = match (first as u64 + k) % 4 {
                0 => (-1, 1),
                1 => (-1, -1),
                2 => (1, -1),
                _ => (1, 1),
            };
            self.go(a, da);
            self.go(b, if sense > 0.0 { db } else { -db });
        }
        for axis in [a, b] {
            self.reversals[axis] += 2 * u64::from(arc.turns);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use husillo_gcode::Plane;

    #[test]
    fn a_full_circle_turns_each_axis_twice() {
        let arc = Arc {
            to: [Nm(3), Nm(0), Nm(0)],
            centre: [Nm(0); 3],
            plane: Plane::Xy,
            direction: Direction::CounterClockwise,
            turns: 0,
            radius: None,
            mismatch: Nm(0),
            resolution: Nm(1),
        };
        let mut turns = Turns::new();
        turns.arc([Nm(3), Nm(0), Nm(0)], &arc);
        assert_eq!(turns.reversals(), [2, 2, 0]);
    }
}
