//! Where three planes meet.

use super::linear::cross;
use super::vector::{add, difference, exceeds, to_nm};
use super::{Plane, dot};

/// The corner of three faces, in nm: two edges and the top, for instance. `None` where two of them
/// are parallel, or all three are along one direction (the determinant of their normals is below
/// 10^-3).
///
/// Cramer's rule about the first plane's point: `x = (d1 (n2 x n3) + d2 (n3 x n1) + d3 (n1 x n2)) /
/// n1.(n2 x n3)`.
#[must_use]
pub fn corner_nm(a: &Plane, b: &Plane, c: &Plane) -> Option<[i64; 3]> {
    let [na, nb, nc] = [a, b, c].map(|plane| plane.normal.to_floats());
    let determinant = dot(na, cross(nb, nc));
    if !exceeds(determinant * determinant, 1e-6) {
        return None;
    }
    // The first distance is 0.
    let origin = a.point_nm;
    let offset = |plane: &Plane, normal| dot(difference(plane.point_nm, origin), normal);
    let sum = add(
        cross(nc, na).map(|component| component * offset(b, nb)),
        offset(c, nc),
        cross(na, nb),
    );
    Some(to_nm(origin, sum.map(|component| component / determinant)))
}
