//! Intersection of three planes.

use super::linear::cross;
use super::vector::{add, difference, exceeds, to_nm};
use super::{Plane, dot};

/// Returns the corner of three faces, in nm, for example of two edges and the top. Returns `None`
/// if two of them are parallel or all three contain one direction (the determinant of their normals
/// is below 10^-3).
///
/// Computed by Cramer's rule about the first plane's point: `x = (d1 (n2 x n3) + d2 (n3 x n1) + d3
/// (n1 x n2)) / n1.(n2 x n3)`.
#[must_use]
pub fn corner_nm(a: &Plane, b: &Plane, c: &Plane) -> Option<[i64; 3]> {
    let [na, nb, nc] = [a, b, c].map(|plane| plane.normal.to_floats());
    let determinant = dot(na, cross(nb, nc));
    if !exceeds(determinant * determinant, 1e-6) {
        return None;
    }
    // The distance of the first plane is 0.
    let origin = a.point_nm;
    let offset = |plane: &Plane, normal| dot(difference(plane.point_nm, origin), normal);
    let sum = add(
        cross(nc, na).map(|component| component * offset(b, nb)),
        offset(c, nc),
        cross(na, nb),
    );
    Some(to_nm(origin, sum.map(|component| component / determinant)))
}
