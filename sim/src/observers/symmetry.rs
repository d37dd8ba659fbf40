//! Compares the right side of a cut figure with the mirror image of its left side.

use crate::observers::{Now, Observer};
use husillo_machine::Origin;
use serde::Serialize;
use std::collections::HashMap;
use std::io;

/// A point is compared with a mirror image at most this far away, nm.
const NEAR_NM: f64 = 500.0;
/// Side of the squares into which points are sorted, nm; at least `NEAR_NM`.
const SQUARE_NM: f64 = 1000.0;

/// Points of the work on both sides of a vertical axis.
#[derive(Clone, Debug)]
pub struct Symmetry {
    axis_nm: f64,
    nm_per_step: [f64; 2],
    /// Commanded position of each point, and the distance of the tool from it.
    points: Vec<[[f64; 2]; 2]>,
}

/// The difference between the sides.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Difference {
    /// Number of points that have a mirror image.
    pub pairs: usize,
    /// Largest difference of the tool's distances within a pair, nm.
    pub max_nm: f64,
    /// Root mean square of these differences, nm.
    pub rms_nm: f64,
}

impl Symmetry {
    /// Mirrors at a machine position of X. `nm_per_step` is for X and Y.
    pub const fn new(axis_nm: f64, nm_per_step: [f64; 2]) -> Self {
        Self {
            axis_nm,
            nm_per_step,
            points: Vec::new(),
        }
    }

    /// Adds a point of the cut.
    fn add(&mut self, sent_nm: [f64; 2], tool_nm: [f64; 2]) {
        let off = [tool_nm[0] - sent_nm[0], tool_nm[1] - sent_nm[1]];
        if self.points.last().is_none_or(|last| last[0] != sent_nm) {
            self.points.push([sent_nm, off]);
        }
    }

    /// Compares each point on the right with the nearest mirror image of one on the left. Returns
    /// `None` without any pair.
    pub fn difference(&self) -> Option<Difference> {
        let square = |at: [f64; 2]| at.map(|nm| (nm / SQUARE_NM).floor() as i64);
        let mut left: HashMap<[i64; 2], Vec<[[f64; 2]; 2]>> = HashMap::new();
        for [at, off] in &self.points {
            if at[0] < self.axis_nm {
                let mirrored = [2.0 * self.axis_nm - at[0], at[1]];
                let image = [mirrored, [-off[0], off[1]]];
                left.entry(square(mirrored)).or_default().push(image);
            }
        }
        let (mut pairs, mut largest, mut sum) = (0, 0.0_f64, 0.0);
        for [at, off] in self.points.iter().filter(|[at, _]| at[0] > self.axis_nm) {
            let [column, row] = square(*at);
            let around = (-1..=1).flat_map(|x| (-1..=1).map(move |y| [column + x, row + y]));
            let images = around.filter_map(|place| left.get(&place)).flatten();
            let apart = |image: &[f64; 2]| f64::hypot(image[0] - at[0], image[1] - at[1]);
            let nearest = images.min_by(|a, b| apart(&a[0]).total_cmp(&apart(&b[0])));
            if let Some([_, image]) = nearest.filter(|[image, _]| apart(image) <= NEAR_NM) {
                let distance = f64::hypot(off[0] - image[0], off[1] - image[1]);
                pairs += 1;
                largest = largest.max(distance);
                sum += distance * distance;
            }
        }
        (pairs > 0).then(|| Difference {
            pairs,
            max_nm: largest.round(),
            rms_nm: (sum / pairs as f64).sqrt().round(),
        })
    }
}

impl Observer for Symmetry {
    #[inline]
    fn step(&mut self, now: &Now<'_>) -> io::Result<()> {
        if now.origin == Origin::Feed {
            let sent_nm = [0, 1].map(|axis| f64::from(now.sent[axis]) * self.nm_per_step[axis]);
            self.add(sent_nm, [now.tool_nm[0], now.tool_nm[1]]);
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::observers::tests::now;

    #[test]
    fn only_cuts_are_compared() {
        let mut figure = Symmetry::new(0.0, [500.0; 2]);
        for origin in [Origin::Rapid, Origin::TakeUp, Origin::Feed] {
            for x in [-2, 2] {
                let seen = Now {
                    origin,
                    sent: [x, 0, 0, 0, 0, 0],
                    tool_nm: [500.0 * f64::from(x) + 20.0, 0.0, 5.0, 0.0, 0.0, 0.0],
                    ..now(1)
                };
                figure.step(&seen).unwrap();
            }
        }
        let difference = figure.difference().unwrap();
        assert_eq!((difference.pairs, difference.max_nm), (1, 40.0));
    }

    #[test]
    fn sides_are_compared_as_mirror_images() {
        let mut figure = Symmetry::new(1e6, [1.0; 2]);
        // The right side is 30 nm too far out and 40 nm too high. The left one is exact.
        figure.add([1_500_000.0, 7.0], [1_500_030.0, 47.0]);
        figure.add([499_900.0, 7.0], [499_900.0, 7.0]);
        figure.add([1_700_000.0, 9.0], [1_700_000.0, 9.0]);
        let difference = figure.difference().unwrap();
        assert_eq!((difference.pairs, difference.max_nm), (1, 50.0));
        // Both sides are too far out: the figure is larger, but symmetric.
        let mut figure = Symmetry::new(0.0, [1.0; 2]);
        figure.add([100.0, 0.0], [130.0, 0.0]);
        figure.add([-100.0, 0.0], [-130.0, 0.0]);
        assert_eq!(figure.difference().unwrap().max_nm, 0.0);
        assert_eq!(Symmetry::new(0.0, [1.0; 2]).difference(), None);
    }
}
