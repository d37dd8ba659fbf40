//! Counts and locates the reversals of the axes of a program, from its geometry alone.

use husillo_gcode::{Arc, Direction, Nm};
use husillo_metrology::calibration::backlash::Map;
use husillo_sim::geometry::turn;
use husillo_sim::observers::AXES;
use std::f64::consts::FRAC_PI_2;

/// Counts the reversals of each axis, and the backlash that they take up.
#[derive(Debug)]
pub struct Turns {
    direction: [i8; AXES],
    reversals: [u64; AXES],
    /// Backlash of each axis by position.
    maps: [Map; AXES],
    /// Nanometres per step.
    steps_nm: [f64; AXES],
    taken_up: [TakenUp; AXES],
}

/// The take-ups of an axis, steps.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TakenUp {
    /// Sum.
    pub steps: u64,
    /// Smallest; `u32::MAX` if there are none.
    pub least: u32,
    /// Largest.
    pub most: u32,
}

impl Turns {
    /// Starts after homing, in which each axis has left its switch in the positive direction.
    pub fn new(maps: [Map; AXES], steps_nm: [f64; AXES]) -> Self {
        Self {
            direction: [1; AXES],
            reversals: [0; AXES],
            maps,
            steps_nm,
            taken_up: [TakenUp {
                steps: 0,
                least: u32::MAX,
                most: 0,
            }; AXES],
        }
    }

    /// The take-ups so far.
    pub const fn taken_up(&self) -> [TakenUp; AXES] {
        self.taken_up
    }

    /// The reversals so far.
    pub const fn reversals(&self) -> [u64; AXES] {
        self.reversals
    }

    fn go(&mut self, axis: usize, direction: i8, at: [f64; AXES]) {
        if direction != 0 && direction != self.direction[axis] {
            self.direction[axis] = direction;
            self.add(axis, at, 1);
        }
    }

    /// Counts reversals at a position in nm.
    fn add(&mut self, axis: usize, at: [f64; AXES], count: u64) {
        if count == 0 {
            return;
        }
        let map = &self.maps[axis];
        // The cast saturates. No machine is that large.
        let position = map
            .axes()
            .map(|along| (at[along] / self.steps_nm[along]).round() as i32);
        let backlash = map.steps(position);
        let taken_up = &mut self.taken_up[axis];
        taken_up.steps += count * u64::from(backlash);
        taken_up.least = taken_up.least.min(backlash);
        taken_up.most = taken_up.most.max(backlash);
        self.reversals[axis] += count;
    }

    /// Counts the reversals of a straight move.
    pub fn line(&mut self, from: [Nm; AXES], to: [Nm; AXES]) {
        let at = from.map(|Nm(nm)| nm as f64);
        for axis in 0..AXES {
            self.go(axis, (to[axis].0 - from[axis].0).signum() as i8, at);
        }
    }

    /// Counts the reversals of an arc by quadrants. An axis reverses where the arc passes from one
    /// quadrant to the next.
    pub fn arc(&mut self, from: [Nm; AXES], arc: &Arc<AXES>) {
        let [a, b] = arc.plane.axes();
        let begin = from.map(|Nm(nm)| nm as f64);
        for across in (0..AXES).filter(|axis| ![a, b].contains(axis)) {
            let way = arc.to[across].0 - from[across].0;
            self.go(across, way.signum() as i8, begin);
        }
        let angle = |p: [Nm; AXES]| {
            let spoke = [a, b].map(|axis| (p[axis].0 - arc.centre[axis].0) as f64);
            turn::angle(spoke, [0.0; 2])
        };
        let is_forward = arc.direction == Direction::CounterClockwise;
        let sweep = turn::sweep(angle(from), angle(arc.to), is_forward);
        let sense = if is_forward { 1.0 } else { -1.0 };
        // A clockwise arc is the mirror image, with the second axis in the opposite direction.
        let start = turn::turned(0.0, angle(from), is_forward) / FRAC_PI_2;
        let first = (start + 1e-9).floor();
        let last = (start + sweep / FRAC_PI_2 - 1e-9).floor();
        // `arc.turns` whole turns are added below.
        let quarters = (last - first) as u64;
        let centre = arc.centre.map(|Nm(nm)| nm as f64);
        let radius = (begin[a] - centre[a]).hypot(begin[b] - centre[b]);
        // The point of the circle at the start of a quadrant.
        let end = |quarter: u64| {
            let (sin, cos) = (sense * quarter as f64 * FRAC_PI_2).sin_cos();
            let mut at = begin;
            at[a] = centre[a] + radius * cos;
            at[b] = centre[b] + radius * sin;
            at
        };
        for k in 0..=quarters {
            let at = if k == 0 { begin } else { end(first as u64 + k) };
            let (da, db) = match (first as u64 + k) % 4 {
                0 => (-1, 1),
                1 => (-1, -1),
                2 => (1, -1),
                _ => (1, 1),
            };
            self.go(a, da, at);
            self.go(b, if is_forward { db } else { -db }, at);
        }
        for quarter in 0..4 {
            let axis = if quarter % 2 == 0 { a } else { b };
            self.add(axis, end(quarter), arc.turns.into());
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::programs::setup;
    use husillo_backlash::BacklashMap;
    use husillo_gcode::Plane;

    #[test]
    fn a_full_circle_reverses_each_axis_twice() {
        let arc = Arc {
            to: [Nm(3), Nm(0), Nm(0), Nm(0), Nm(0), Nm(0)],
            centre: [Nm(0); AXES],
            plane: Plane::Xy,
            direction: Direction::CounterClockwise,
            turns: 0,
            radius: None,
            mismatch: Nm(0),
            resolution: Nm(1),
        };
        let mut turns = Turns::new(setup::no_backlash(), [1.0; AXES]);
        turns.arc(arc.to, &arc);
        assert_eq!(turns.reversals(), [2, 2, 0, 0, 0, 0]);
    }

    /// The backlash grows along X by one step per ten nanometres. Each end of a circle takes up the
    /// backlash of its own position.
    #[test]
    fn a_reversal_takes_up_the_backlash_of_its_position() {
        let map: Map = BacklashMap::new(
            [0, 1],
            [vec![0, 1000].into(), vec![0].into()],
            vec![0, 100].into(),
        )
        .unwrap();
        let maps = std::array::from_fn(|_| map.clone());
        let mut turns = Turns::new(maps, [1.0; AXES]);
        let mut arc = Arc {
            to: [Nm(600), Nm(0), Nm(0), Nm(0), Nm(0), Nm(0)],
            centre: [Nm(500), Nm(0), Nm(0), Nm(0), Nm(0), Nm(0)],
            plane: Plane::Xy,
            direction: Direction::CounterClockwise,
            turns: 0,
            radius: None,
            mismatch: Nm(0),
            resolution: Nm(1),
        };
        turns.arc(arc.to, &arc);
        let [x, y, ..] = turns.taken_up();
        // X reverses at its start, 600, and at 400. Y reverses at the top and at the bottom, both
        // at X 500.
        assert_eq!((x.steps, x.least, x.most), (100, 40, 60));
        assert_eq!((y.steps, y.least, y.most), (100, 50, 50));
        arc.turns = 3;
        turns.arc(arc.to, &arc);
        let [x, y, ..] = turns.taken_up();
        assert_eq!([x.steps, y.steps], [500, 500]);
        assert_eq!(turns.reversals(), [10, 10, 0, 0, 0, 0]);
    }
}
