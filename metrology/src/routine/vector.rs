//! Vectors of three floats, in nm or without a unit.

use husillo_probe::UnitVector;

/// A vector of floats.
pub type Vector = [f64; 3];

/// The direction of a vector. `None`: its length is 0.
#[must_use]
pub fn direction(vector: Vector) -> Option<UnitVector> {
    let size = length(vector);
    // 2^31 is the resolution of `UnitVector::new`.
    UnitVector::new(vector.map(|part| (part / size * 2_147_483_648.0).round() as i64))
}

/// A direction as floats, with the length 1 to the last bit.
#[must_use]
pub fn components(direction: &UnitVector) -> Vector {
    let floats = direction
        .components()
        .map(|part| f64::from(part.to_bits()) / 1_073_741_824.0);
    scaled(floats, 1.0 / length(floats))
}

/// A point as floats, exact below 2^53 nm.
#[must_use]
pub fn floats(point_nm: [i64; 3]) -> Vector {
    point_nm.map(|nm| nm as f64)
}

/// The scalar product.
#[must_use]
pub fn dot(a: Vector, b: Vector) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// The length of a vector.
#[must_use]
pub fn length(a: Vector) -> f64 {
    dot(a, a).sqrt()
}

/// A vector times a number.
#[must_use]
pub fn scaled(a: Vector, by: f64) -> Vector {
    a.map(|part| part * by)
}

/// The sum of two vectors.
#[must_use]
pub fn plus(a: Vector, b: Vector) -> Vector {
    std::array::from_fn(|axis| a[axis] + b[axis])
}

/// `a` minus `b`.
#[must_use]
pub fn minus(a: Vector, b: Vector) -> Vector {
    std::array::from_fn(|axis| a[axis] - b[axis])
}

/// The vector product, which is perpendicular to both.
#[must_use]
pub fn cross(a: Vector, b: Vector) -> Vector {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

/// The direction of the component of `a` perpendicular to `axis`, with the length 1. `None`: `a` is
/// along `axis`.
#[must_use]
pub fn across(a: Vector, axis: Vector) -> Option<Vector> {
    let left = plus(a, scaled(axis, -dot(a, axis)));
    let size = length(left);
    // If `a` is within 1 mrad of the axis, this direction is not determined.
    (size > 1e-3 * length(a)).then(|| scaled(left, 1.0 / size))
}

/// The axis of the component with the largest magnitude, except `but`, and the sign of this
/// component.
#[must_use]
pub fn nearest_axis(vector: Vector, but: Option<usize>) -> (usize, f64) {
    let axes = (0..3).filter(|axis| Some(*axis) != but);
    let largest = axes.max_by(|a, b| vector[*a].abs().total_cmp(&vector[*b].abs()));
    let axis = largest.unwrap_or_default();
    (axis, if vector[axis] < 0.0 { -1.0 } else { 1.0 })
}

/// The middle of two points, rounded to the nearest nm.
#[must_use]
pub fn halfway(a: [i64; 3], b: [i64; 3]) -> [i64; 3] {
    let (a, b) = (floats(a), floats(b));
    plus(a, scaled(minus(b, a), 0.5)).map(|nm| nm.round() as i64)
}
