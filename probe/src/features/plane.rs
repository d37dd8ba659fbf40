//! Planes and edges.

use super::linear::{adjugate, largest_eigenvector, trace};
use super::vector::{exceeds, outer, projected, unit};
use super::{Centroid, FitError, Residuals, Tally, dot};
use crate::UnitVector;
use crate::unit_vector::{minus, plus};

/// A plane: a face, or the vertical face below an edge.
///
/// It is fitted to compensated points, or to centres of the ball and then [moved](Plane::moved_nm)
/// by the tip radius.
#[derive(Copy, Clone, Eq, PartialEq, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Plane {
    /// A point of the plane, in nm. For a fitted plane it is the centroid of the points.
    pub point_nm: [i64; 3],
    /// The normal.
    pub normal: UnitVector,
    /// Residuals of the points.
    pub residuals: Residuals,
}

impl Plane {
    /// Creates the plane through `point_nm` perpendicular to `normal`, without a measurement.
    #[must_use]
    pub fn new(point_nm: [i64; 3], normal: UnitVector) -> Plane {
        Plane {
            point_nm,
            normal,
            residuals: Tally::default().residuals(),
        }
    }

    /// Fits the least-squares plane of at least three points. It passes through the centroid. Its
    /// normal is the eigenvector of the scatter matrix with the smallest eigenvalue and points to
    /// the side of `outward`.
    ///
    /// # Errors
    /// - [`FitError::TooFewPoints`]: fewer than three points.
    /// - [`FitError::Undetermined`]: the points are on a line (narrower than a thousandth of their
    ///   length), or their spread is as thick as wide.
    pub fn fit<I>(points: I, outward: &UnitVector) -> Result<Plane, FitError>
    where
        I: IntoIterator<Item = [i64; 3], IntoIter: Clone>,
    {
        let points = points.into_iter();
        let centroid = Centroid::of(points.clone(), 3)?;
        let scatter = centroid.scatter(points.clone());
        Plane::of_scatter(points, &centroid, &scatter, outward)
    }

    /// Fits an edge: the least-squares plane of at least two points that contains the direction
    /// `along`. With `along` = Z, the straight edge of a part seen from above is the vertical plane
    /// below it. The normal points to the side of `outward`.
    ///
    /// # Errors
    /// - [`FitError::TooFewPoints`]: fewer than two points.
    /// - [`FitError::Undetermined`]: the points coincide when seen along `along`.
    pub fn edge<I>(points: I, along: &UnitVector, outward: &UnitVector) -> Result<Plane, FitError>
    where
        I: IntoIterator<Item = [i64; 3], IntoIter: Clone>,
    {
        let points = points.into_iter();
        let centroid = Centroid::of(points.clone(), 2)?;
        let along = unit(along);
        let mut scatter = [[0.0; 3]; 3];
        for point in points.clone() {
            let offset = projected(centroid.offset(point), Some(along));
            outer(&mut scatter, 1.0, offset, offset);
        }
        // With the trace of the scatter added along it, `along` is never the normal.
        let size = trace(&scatter);
        outer(&mut scatter, size, along, along);
        Plane::of_scatter(points, &centroid, &scatter, outward)
    }

    /// Fits a plane with a known normal to at least one point: an edge touched once, a height
    /// touched several times.
    ///
    /// # Errors
    /// [`FitError::TooFewPoints`] without a point.
    pub fn across<I>(points: I, normal: &UnitVector) -> Result<Plane, FitError>
    where
        I: IntoIterator<Item = [i64; 3], IntoIter: Clone>,
    {
        let points = points.into_iter();
        let centroid = Centroid::of(points.clone(), 1)?;
        Ok(Plane::about(points, &centroid, *normal))
    }

    /// Returns the distance of a point from the plane, positive on the side of the normal, to the
    /// nearest nm. The point is up to 2.1 m from [`point_nm`](Plane::point_nm). Integers only.
    #[must_use]
    pub fn distance_nm(&self, point: [i64; 3]) -> i64 {
        self.normal.length_along(minus(point, self.point_nm))
    }

    /// Returns the plane moved by `by_nm` along its normal. Minus the tip radius moves it from
    /// centres of the ball to the surface.
    #[must_use]
    pub fn moved_nm(&self, by_nm: i64) -> Plane {
        Plane {
            point_nm: plus(self.point_nm, self.normal.scaled(by_nm)),
            ..*self
        }
    }

    fn of_scatter(
        points: impl Iterator<Item = [i64; 3]>,
        centroid: &Centroid,
        scatter: &[[f64; 3]; 3],
        outward: &UnitVector,
    ) -> Result<Plane, FitError> {
        // Compares the sum of the products of two eigenvalues with the square of their sum.
        let (adjugate, size) = (adjugate(scatter), trace(scatter));
        if !exceeds(trace(&adjugate), 1e-6 * size * size) {
            return Err(FitError::Undetermined);
        }
        let normal = largest_eigenvector(adjugate).ok_or(FitError::Undetermined)?;
        let side = dot(normal, outward.to_floats());
        let normal = if side < 0.0 {
            normal.map(|c| -c)
        } else {
            normal
        };
        let normal = UnitVector::from_floats(normal).ok_or(FitError::Undetermined)?;
        Ok(Plane::about(points, centroid, normal))
    }

    fn about(
        points: impl Iterator<Item = [i64; 3]>,
        centroid: &Centroid,
        normal: UnitVector,
    ) -> Plane {
        let along = normal.to_floats();
        let tally: Tally = points
            .map(|point| dot(centroid.offset(point), along))
            .collect();
        Plane {
            point_nm: centroid.point_nm([0.0; 3]),
            normal,
            residuals: tally.residuals(),
        }
    }
}
