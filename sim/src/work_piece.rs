//! Simple solids for touch probing.

use crate::place::Place;

/// A point or a vector, mm.
pub type PointMm = [f64; 3];

/// A solid shape without holes.
#[derive(Copy, Clone, PartialEq, Debug)]
pub enum Shape {
    /// A box between two opposite corners, parallel to the axes.
    Box {
        /// The corner with the lower coordinates, mm.
        from_mm: PointMm,
        /// The corner with the higher coordinates, mm.
        to_mm: PointMm,
    },
    /// A cylinder about the line between the centres of its two faces.
    Cylinder {
        /// Centre of one face, mm.
        from_mm: PointMm,
        /// Centre of the other, mm.
        to_mm: PointMm,
        /// Radius, mm.
        radius_mm: f64,
    },
    /// A sphere.
    Sphere {
        /// Centre, mm.
        centre_mm: PointMm,
        /// Radius, mm.
        radius_mm: f64,
    },
    /// The half space behind a plane.
    Plane {
        /// A point of the plane, mm.
        point_mm: PointMm,
        /// Direction away from the material; any length above 0.
        outward: PointMm,
    },
}

/// A cylindrical hole in one solid, open at its beginning.
#[derive(Copy, Clone, PartialEq, Debug)]
pub struct Bore {
    /// Centre of the opening, in a face perpendicular to the bore, mm.
    pub from_mm: PointMm,
    /// Centre of the flat bottom, mm; beyond the solid for a through hole.
    pub to_mm: PointMm,
    /// Radius, mm.
    pub radius_mm: f64,
}

/// A shape minus its bores.
#[derive(Clone, PartialEq, Debug)]
pub struct Solid {
    /// The shape.
    pub shape: Shape,
    /// The bores in it.
    pub bores: Vec<Bore>,
}

/// A work piece for touch probing: solids that may be separate or overlap.
///
/// # Examples
/// ```
/// use husillo_sim::{Bore, Shape, Solid, WorkPiece};
///
/// let shape = Shape::Box { from_mm: [0.0; 3], to_mm: [20.0, 20.0, 10.0] };
/// let bore = Bore { from_mm: [10.0, 10.0, 10.0], to_mm: [10.0, 10.0, 4.0], radius_mm: 5.0 };
/// let solid = Solid { shape, bores: vec![bore] };
/// let piece = WorkPiece { solids: vec![solid], ..WorkPiece::default() };
/// assert_eq!(piece.distance_mm([10.0, 10.0, 5.0]), 1.0); // the bottom of the bore
/// assert_eq!(piece.normal([13.0, 10.0, 8.0]), [-1.0, 0.0, 0.0]); // its wall
/// ```
#[derive(Clone, PartialEq, Debug, Default)]
pub struct WorkPiece {
    /// The solids, in piece coordinates.
    pub solids: Vec<Solid>,
    /// Placement on the machine.
    pub place: Place,
}

impl WorkPiece {
    /// Distance of a point in machine coordinates from the surface, mm; negative inside. It is
    /// exact outside shapes, inside bores, and at the rims of bores that begin in a face
    /// perpendicular to them.
    pub fn distance_mm(&self, point: PointMm) -> f64 {
        let point = self.place.to_piece(point);
        let distances = self.solids.iter().map(|solid| solid.distance_mm(point));
        distances.fold(f64::INFINITY, f64::min)
    }

    /// Unit vector away from the nearest surface. It is computed from differences over 2 nm.
    pub fn normal(&self, point: PointMm) -> PointMm {
        const STEP_MM: f64 = 1e-6;
        let slope = [0, 1, 2].map(|axis| {
            let [mut before, mut after] = [point; 2];
            before[axis] -= STEP_MM;
            after[axis] += STEP_MM;
            // Distances below 1 m are accurate to 10^-13 mm, so slopes are accurate to 10^-7.
            let slope = (self.distance_mm(after) - self.distance_mm(before)) / (2.0 * STEP_MM);
            (slope * 1e6).round() / 1e6
        });
        unit(slope)
    }
}

impl Solid {
    fn distance_mm(&self, point: PointMm) -> f64 {
        let body = self.shape.distance_mm(point);
        let holes = self.bores.iter().map(|bore| bore.depth_mm(point));
        let hole = holes.fold(f64::NEG_INFINITY, f64::max);
        if body > 0.0 && hole > 0.0 {
            // In front of the opening, the distance to its rim counts.
            body.hypot(hole)
        } else {
            body.max(hole)
        }
    }
}

impl Shape {
    fn distance_mm(&self, point: PointMm) -> f64 {
        match *self {
            Shape::Box { from_mm, to_mm } => {
                let beyond = [0, 1, 2]
                    .map(|axis| (from_mm[axis] - point[axis]).max(point[axis] - to_mm[axis]));
                outside(&beyond)
            }
            Shape::Cylinder {
                from_mm,
                to_mm,
                radius_mm,
            } => {
                let (along, across) = cylindrical(point, from_mm, to_mm);
                let length = length(minus(to_mm, from_mm));
                outside(&[across - radius_mm, (-along).max(along - length)])
            }
            Shape::Sphere {
                centre_mm,
                radius_mm,
            } => length(minus(point, centre_mm)) - radius_mm,
            Shape::Plane { point_mm, outward } => dot(minus(point, point_mm), unit(outward)),
        }
    }
}

impl Bore {
    /// Depth of a point inside the hole, which extends without end in front of its opening;
    /// negative in the material.
    fn depth_mm(&self, point: PointMm) -> f64 {
        let (along, across) = cylindrical(point, self.from_mm, self.to_mm);
        let length = length(minus(self.to_mm, self.from_mm));
        -outside(&[across - self.radius_mm, along - length])
    }
}

/// Distance to a body with perpendicular faces, from the distances beyond each face.
fn outside(beyond: &[f64]) -> f64 {
    let square: f64 = beyond.iter().map(|part| part.max(0.0).powi(2)).sum();
    let nearest = beyond.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    square.sqrt() + nearest.min(0.0)
}

/// Distance along the line between two points, from the first one, and distance from the line.
fn cylindrical(point: PointMm, from: PointMm, to: PointMm) -> (f64, f64) {
    let axis = unit(minus(to, from));
    let off = minus(point, from);
    let along = dot(off, axis);
    let across = [0, 1, 2].map(|k| off[k] - along * axis[k]);
    (along, length(across))
}

fn minus(a: PointMm, b: PointMm) -> PointMm {
    [0, 1, 2].map(|axis| a[axis] - b[axis])
}

fn dot(a: PointMm, b: PointMm) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn length(vector: PointMm) -> f64 {
    dot(vector, vector).sqrt()
}

/// The unit vector in this direction; +Z for the zero vector.
fn unit(vector: PointMm) -> PointMm {
    let length = length(vector);
    if length > 0.0 {
        vector.map(|part| part / length)
    } else {
        [0.0, 0.0, 1.0]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn piece(shape: Shape, bores: Vec<Bore>) -> WorkPiece {
        WorkPiece {
            solids: vec![Solid { shape, bores }],
            ..WorkPiece::default()
        }
    }

    #[test]
    fn a_piece_lies_where_it_is_put() {
        let shape = Shape::Box {
            from_mm: [0.0; 3],
            to_mm: [40.0, 20.0, 10.0],
        };
        let mut piece = piece(shape, Vec::new());
        // X of the piece is Y of the machine, its Y is Z, its Z is X.
        piece.place = Place::new([100.0, 0.0, -30.0], 90.0, 90.0);
        for (point, distance, normal) in [
            ([105.0, -2.0, -20.0], 2.0, [0.0, -1.0, 0.0]),
            ([105.0, 20.0, -7.0], 3.0, [0.0, 0.0, 1.0]),
            ([111.0, 20.0, -20.0], 1.0, [1.0, 0.0, 0.0]),
        ] {
            assert!((piece.distance_mm(point) - distance).abs() < 1e-9);
            let off = piece.normal(point).into_iter().zip(normal);
            assert!(
                off.into_iter()
                    .all(|(is, wanted)| (is - wanted).abs() < 1e-6)
            );
        }
    }

    #[test]
    fn shapes_from_all_sides() {
        let block = piece(
            Shape::Box {
                from_mm: [0.0; 3],
                to_mm: [10.0, 20.0, 30.0],
            },
            Vec::new(),
        );
        assert_eq!(block.distance_mm([12.0, 10.0, 10.0]), 2.0);
        assert_eq!(block.distance_mm([13.0, 24.0, 10.0]), 5.0);
        assert_eq!(block.distance_mm([5.0, 9.0, 29.0]), -1.0);
        assert_eq!(block.normal([5.0, -3.0, 7.0]), [0.0, -1.0, 0.0]);
        let boss = piece(
            Shape::Cylinder {
                from_mm: [0.0; 3],
                to_mm: [0.0, 0.0, 5.0],
                radius_mm: 3.0,
            },
            Vec::new(),
        );
        assert_eq!(boss.distance_mm([0.0, 7.0, 2.0]), 4.0);
        assert_eq!(boss.distance_mm([6.0, 0.0, 9.0]), 5.0);
        assert_eq!(boss.distance_mm([0.0, 0.0, 6.0]), 1.0);
        let ball = piece(
            Shape::Sphere {
                centre_mm: [1.0, 2.0, 3.0],
                radius_mm: 5.0,
            },
            Vec::new(),
        );
        assert_eq!(ball.distance_mm([1.0, 2.0, 10.0]), 2.0);
        let wall = piece(
            Shape::Plane {
                point_mm: [4.0, 0.0, 0.0],
                outward: [-2.0, 0.0, 0.0],
            },
            Vec::new(),
        );
        assert_eq!(wall.distance_mm([1.0, 9.0, 9.0]), 3.0);
    }

    #[test]
    fn a_bore_has_wall_bottom_and_rim_and_no_lid() {
        let shape = Shape::Box {
            from_mm: [-20.0, -20.0, -10.0],
            to_mm: [20.0, 20.0, 0.0],
        };
        let bore = Bore {
            from_mm: [0.0; 3],
            to_mm: [0.0, 0.0, -6.0],
            radius_mm: 8.0,
        };
        let block = piece(shape, vec![bore]);
        assert_eq!(block.distance_mm([0.0, 7.0, -3.0]), 1.0);
        assert_eq!(block.distance_mm([0.0, 0.0, -4.0]), 2.0);
        assert_eq!(block.distance_mm([0.0, 5.0, 4.0]), 5.0);
        assert_eq!(block.distance_mm([0.0, 12.0, 4.0]), 4.0);
        assert!(block.distance_mm([0.0, 9.0, -3.0]) < 0.0);
        assert!(block.distance_mm([0.0, 0.0, -7.0]) < 0.0);
    }
}
