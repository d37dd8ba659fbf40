//! Float vectors, and points as differences to their centroid.

use super::FitError;
use crate::UnitVector;
use crate::unit_vector::{minus, plus};

/// Returns `a > b`; `false` if one of them is not a number.
pub(crate) fn exceeds(a: f64, b: f64) -> bool {
    a > b
}

pub(crate) fn dot<const N: usize>(a: [f64; N], b: [f64; N]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

pub(crate) fn length(a: [f64; 3]) -> f64 {
    libm::sqrt(dot(a, a))
}

/// Returns `a + factor b`.
pub(crate) fn add<const N: usize>(mut a: [f64; N], factor: f64, b: [f64; N]) -> [f64; N] {
    a.iter_mut().zip(b).for_each(|(a, b)| *a += factor * b);
    a
}

/// Adds `factor a b^T` to a matrix.
pub(crate) fn outer<const N: usize>(
    matrix: &mut [[f64; N]; N],
    factor: f64,
    a: [f64; N],
    b: [f64; N],
) {
    for (row, a) in matrix.iter_mut().zip(a) {
        *row = add(*row, factor * a, b);
    }
}

/// Converts a direction to floats with length 1 to the last bit.
pub(crate) fn unit(direction: &UnitVector) -> [f64; 3] {
    let floats = direction.to_floats();
    floats.map(|component| component / length(floats))
}

/// Returns `a` without its part along `axis`, if there is one.
pub(crate) fn projected(a: [f64; 3], axis: Option<[f64; 3]>) -> [f64; 3] {
    axis.map_or(a, |axis| add(a, -dot(a, axis), axis))
}

/// Returns the vector from `origin` to `point`, exact up to 2^53 nm.
pub(crate) fn difference(point: [i64; 3], origin: [i64; 3]) -> [f64; 3] {
    minus(point, origin).map(|component| component as f64)
}

/// Returns the point at `offset` from `origin`, to the nearest nm. The cast saturates.
pub(crate) fn to_nm(origin: [i64; 3], offset: [f64; 3]) -> [i64; 3] {
    plus(
        origin,
        offset.map(|component| libm::round(component) as i64),
    )
}

/// Centroid of points.
#[derive(Copy, Clone)]
pub(crate) struct Centroid {
    pub origin: [i64; 3],
    /// Relative to `origin`.
    pub mean: [f64; 3],
    pub count: u32,
}

impl Centroid {
    pub fn of(
        points: impl Iterator<Item = [i64; 3]> + Clone,
        least: u32,
    ) -> Result<Centroid, FitError> {
        let origin = points.clone().next().ok_or(FitError::TooFewPoints)?;
        let (mut count, mut sum) = (0_u32, [0.0; 3]);
        for point in points {
            count = count.saturating_add(1);
            sum = add(sum, 1.0, difference(point, origin));
        }
        if count < least {
            return Err(FitError::TooFewPoints);
        }
        Ok(Centroid {
            origin,
            mean: sum.map(|sum| sum / f64::from(count)),
            count,
        })
    }

    /// Returns a point relative to the centroid.
    pub fn offset(&self, point: [i64; 3]) -> [f64; 3] {
        add(difference(point, self.origin), -1.0, self.mean)
    }

    /// Returns the point at `offset` from the centroid.
    pub fn point_nm(&self, offset: [f64; 3]) -> [i64; 3] {
        to_nm(self.origin, add(self.mean, 1.0, offset))
    }

    /// Returns the sums of the products of the coordinates, about the centroid.
    pub fn scatter(&self, points: impl Iterator<Item = [i64; 3]>) -> [[f64; 3]; 3] {
        let mut scatter = [[0.0; 3]; 3];
        for point in points {
            let offset = self.offset(point);
            outer(&mut scatter, 1.0, offset, offset);
        }
        scatter
    }
}
