//! The distance of the tool from the programmed path while it cuts.

use crate::geometry::path::Path;
use crate::observers::largest::Largest;
use crate::observers::recording::MOST_MOVES;
use crate::observers::{Begun, Now, Observer};
use husillo_machine::Origin;
use std::io;

/// Largest and root-mean-square deviation of feed moves.
#[derive(Clone, Debug)]
pub struct Deviation {
    path: Path,
    /// Squares over time, nm^2.
    pub over_time: Largest,
    /// Largest square of each move, nm^2, up to [`MOST_MOVES`].
    pub of_moves: Vec<f32>,
    largest_squared: f64,
    sum_of_squares: f64,
    count: u64,
}

impl Default for Deviation {
    /// Starts without measurements.
    fn default() -> Self {
        Self {
            path: Path::line([0.0; 3], [0.0; 3]),
            over_time: Largest::default(),
            of_moves: Vec::new(),
            largest_squared: 0.0,
            sum_of_squares: 0.0,
            count: 0,
        }
    }
}

impl Deviation {
    /// Takes one squared distance.
    #[inline]
    fn add(&mut self, squared: f64) {
        if squared > self.largest_squared {
            self.largest_squared = squared;
        }
        self.sum_of_squares += squared;
        self.count += 1;
    }

    /// Largest deviation in nanometres.
    pub fn largest_nm(&self) -> f64 {
        self.largest_squared.sqrt()
    }

    /// Root mean square in nanometres; 0 without measurements.
    pub fn rms_nm(&self) -> f64 {
        (self.sum_of_squares / (self.count.max(1) as f64)).sqrt()
    }
}

impl Observer for Deviation {
    fn begin(&mut self, begun: &Begun<'_>) {
        self.path = begun.path.clone();
        if self.of_moves.len() < MOST_MOVES {
            self.of_moves.push(0.0);
        }
    }

    #[inline]
    fn step(&mut self, now: &Now<'_>) -> io::Result<()> {
        if now.origin == Origin::Feed {
            let squared = self.path.distance_squared(&now.place());
            self.add(squared);
            self.over_time.take(now.ticks, squared as f32);
            if let Some(largest) = self.of_moves.last_mut() {
                *largest = largest.max(squared as f32);
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::observers::tests::{begun, line, now};
    use husillo_gcode::Nm;

    #[test]
    fn only_feeds_are_measured() {
        let mut deviation = Deviation::default();
        let (segment, path) = (line(Nm(9000)), Path::line([0.0; 3], [9000.0, 0.0, 0.0]));
        deviation.begin(&begun(&segment, &path));
        for (origin, y) in [
            (Origin::Feed, 30.0),
            (Origin::Rapid, 900.0),
            (Origin::TakeUp, 900.0),
            (Origin::Feed, -40.0),
        ] {
            let tool_nm = [1000.0, y, 0.0, 0.0, 0.0, 0.0];
            let seen = Now {
                origin,
                tool_nm,
                ..now(1)
            };
            deviation.step(&seen).unwrap();
        }
        assert_eq!(deviation.largest_nm(), 40.0);
        assert_eq!(deviation.rms_nm(), 1250.0_f64.sqrt());
        assert_eq!(deviation.of_moves, [1600.0]);
        assert_eq!(deviation.over_time.columns().0.last(), Some(&1600.0));
    }
}
