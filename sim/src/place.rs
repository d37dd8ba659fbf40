//! Position and orientation of a work piece on the table.

use crate::work_piece::PointMm;

/// Origin of a work piece on the machine, and its orientation.
///
/// # Examples
/// ```
/// use husillo_sim::Place;
///
/// let place = Place::new([5.0, 0.0, 0.0], 90.0, 0.0);
/// let [x, y, z] = place.to_piece([5.0, 2.0, 1.0]);
/// assert!((x - 2.0).abs() < 1e-12 && y.abs() < 1e-12 && z == 1.0);
/// ```
#[derive(Copy, Clone, PartialEq, Debug)]
pub struct Place {
    at_mm: PointMm,
    /// Directions of X, Y and Z of the piece in machine coordinates.
    axes: [PointMm; 3],
}

impl Default for Place {
    /// The identity: piece coordinates are machine coordinates.
    fn default() -> Place {
        Place {
            at_mm: [0.0; 3],
            axes: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        }
    }
}

impl Place {
    /// Creates a placement: the piece is tilted about X, then turned about Z, then moved by
    /// `at_mm`. Angles are in degrees, from Y to Z and from X to Y.
    pub fn new(at_mm: PointMm, turn_deg: f64, tilt_deg: f64) -> Place {
        let (sin_turn, cos_turn) = turn_deg.to_radians().sin_cos();
        let (sin_tilt, cos_tilt) = tilt_deg.to_radians().sin_cos();
        let turned =
            |[x, y, z]: PointMm| [x * cos_turn - y * sin_turn, x * sin_turn + y * cos_turn, z];
        let axes = [
            [1.0, 0.0, 0.0],
            [0.0, cos_tilt, sin_tilt],
            [0.0, -sin_tilt, cos_tilt],
        ];
        Place {
            at_mm,
            axes: axes.map(turned),
        }
    }

    /// Converts a point from machine to piece coordinates.
    pub fn to_piece(&self, point: PointMm) -> PointMm {
        let off = [0, 1, 2].map(|axis| point[axis] - self.at_mm[axis]);
        self.axes
            .map(|axis| axis.iter().zip(off).map(|(a, b)| a * b).sum())
    }
}
