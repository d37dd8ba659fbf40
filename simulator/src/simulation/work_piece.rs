//! The simulated work piece that a probe touches.

use crate::machines::machine_file::Probe;

/// A box that a simulated probe touches, and the probe.
#[derive(Clone, Debug, Default)]
pub struct WorkPiece {
    /// Lowest and highest coordinate of X, Y and Z, nm of the machine frame.
    sides: Option<[[f64; 2]; 3]>,
    /// Distance of the axes from the surface at which the input changes: the radius of the tip
    /// without the pre-travel, nm.
    reach: f64,
}

impl WorkPiece {
    /// The piece of a machine file, with work zero at `zero`, nm of the machine frame. Without a
    /// probe nothing is touched.
    pub fn new(probe: Option<&Probe>, zero: [i64; 3]) -> Self {
        let Some(probe) = probe else {
            return Self::default();
        };
        let placed = |axis: usize, side: [i64; 2]| side.map(|nm| (nm + zero[axis]) as f64);
        let sides = probe.piece;
        Self {
            sides: sides.map(|sides| [0, 1, 2].map(|axis| placed(axis, sides[axis]))),
            reach: (probe.radius_nm - probe.pre_travel_nm) as f64,
        }
    }

    /// Whether the probe is in contact, with the axes at these positions in nm.
    pub fn is_touched(&self, at: [f64; 3]) -> bool {
        let Some(sides) = &self.sides else {
            return false;
        };
        // Distance outside of the box, and inside from its nearest side.
        let (mut outside, mut inside) = (0.0, f64::NEG_INFINITY);
        for (at, [low, high]) in at.iter().zip(sides) {
            let beyond = (low - at).max(at - high);
            outside += beyond.max(0.0) * beyond.max(0.0);
            inside = inside.max(beyond);
        }
        let distance = if inside > 0.0 { outside.sqrt() } else { inside };
        distance <= self.reach
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ball_touches_sides_edges_and_corners() {
        let probe = Probe {
            radius_nm: 1_000_000,
            pre_travel_nm: 0,
            corrects: false,
            piece: Some([[0, 20_000_000], [0, 10_000_000], [-5_000_000, 0]]),
        };
        let piece = WorkPiece::new(Some(&probe), [7_000_000, 0, 0]);
        let mm = |at: [f64; 3]| piece.is_touched(at.map(|mm: f64| mm * 1e6));
        assert!(mm([10.0, 5.0, 1.0]) && !mm([10.0, 5.0, 1.001]));
        assert!(mm([6.0, 5.0, -1.0]) && !mm([5.999, 5.0, -1.0]));
        assert!(mm([6.3, 5.0, 0.7]) && !mm([6.27, 5.0, 0.73]));
        assert!(mm([10.0, 5.0, -2.0]));
        assert!(!WorkPiece::default().is_touched([0.0; 3]));
    }
}
