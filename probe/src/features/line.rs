//! Straight lines in space.

use super::linear::largest_eigenvector;
use super::vector::{add, difference, exceeds, length, projected};
use super::{Centroid, FitError, Residuals, Tally, dot};
use crate::UnitVector;

/// A straight line in space.
#[derive(Copy, Clone, Eq, PartialEq, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Line {
    /// A point on the line, in nm: the centroid of the fitted points.
    pub point_nm: [i64; 3],
    /// The direction.
    pub direction: UnitVector,
    /// Residuals of the points.
    pub residuals: Residuals,
}

impl Line {
    /// Fits the least-squares line of at least two points. It passes through the centroid, along
    /// the eigenvector of the scatter matrix with the largest eigenvalue. Its direction points to
    /// the side of `towards`.
    ///
    /// # Errors
    /// - [`FitError::TooFewPoints`]: fewer than two points.
    /// - [`FitError::Undetermined`]: the points coincide, or their spread is as wide as long.
    pub fn fit<I>(points: I, towards: &UnitVector) -> Result<Line, FitError>
    where
        I: IntoIterator<Item = [i64; 3], IntoIter: Clone>,
    {
        let points = points.into_iter();
        let centroid = Centroid::of(points.clone(), 2)?;
        let along =
            largest_eigenvector(centroid.scatter(points.clone())).ok_or(FitError::Undetermined)?;
        let side = dot(along, towards.to_floats());
        let along = if side < 0.0 { along.map(|c| -c) } else { along };
        let tally: Tally = points
            .map(|point| length(projected(centroid.offset(point), Some(along))))
            .collect();
        let residuals = tally.residuals();
        Ok(Line {
            point_nm: centroid.point_nm([0.0; 3]),
            direction: UnitVector::from_floats(along).ok_or(FitError::Undetermined)?,
            residuals: Residuals {
                form_nm: residuals.largest_nm,
                ..residuals
            },
        })
    }

    /// Returns the distance of a point from the line, to the nearest nm, never negative.
    #[must_use]
    pub fn distance_nm(&self, point: [i64; 3]) -> i64 {
        let across = projected(
            difference(point, self.point_nm),
            Some(self.direction.to_floats()),
        );
        libm::round(length(across)) as i64
    }

    /// Returns the point of this line nearest to `other`, in nm. If the lines cross, it is the
    /// corner. Returns `None` if they are parallel within 1 mrad.
    ///
    /// With `w` the vector between their points and `c` the cosine of their angle, it lies
    /// `((w.a) - c (w.b)) / (1 - c^2)` along this line.
    #[must_use]
    pub fn crossing_nm(&self, other: &Line) -> Option<[i64; 3]> {
        let (a, b) = (self.direction.to_floats(), other.direction.to_floats());
        let displacement = difference(other.point_nm, self.point_nm);
        let cosine = dot(a, b);
        let sine_squared = 1.0 - cosine * cosine;
        if !exceeds(sine_squared, 1e-6) {
            return None;
        }
        let along = (dot(displacement, a) - cosine * dot(displacement, b)) / sine_squared;
        Some(super::to_nm(self.point_nm, add([0.0; 3], along, a)))
    }
}
