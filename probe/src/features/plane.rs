//! Planes and edges.

use super::linear::{adjugate, largest_eigenvector, trace};
use super::vector::{exceeds, outer, projected, unit};
use super::{Centroid, FitError, Residuals, Tally, dot};
use crate::UnitVector;
use crate::unit_vector::{minus, plus};

/// A plane: a face, or an edge as the face below it.
///
/// Fitted to compensated points, or to centres of the ball and then [`moved`](Plane::moved_nm) by
/// the tip radius.
#[derive(Copy, Clone, Eq, PartialEq, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Plane {
    /// A point of it, in nm: the centroid of the points, where it was fitted.
    pub point_nm: [i64; 3],
    /// Its normal.
    pub normal: UnitVector,
    /// How the points lie on it.
    pub residuals: Residuals,
}

impl Plane {
    /// The plane through `point_nm` at right angles to `normal`, from no measurement.
    #[must_use]
    pub fn new(point_nm: [i64; 3], normal: UnitVector) -> Plane {
        Plane {
            point_nm,
            normal,
            residuals: Tally::default().residuals(),
        }
    }

    /// The least-squares plane of at least three points: through the centroid, its normal the
    /// eigenvector of the scatter matrix with the smallest eigenvalue. The normal points to the
    /// side of `outward`.
    ///
    /// # Errors
    ///
    /// [`FitError::TooFewPoints`]; [`FitError::Undetermined`] where the points are on a line
    /// (narrower than a thousandth of their length) or as thick as wide.
    pub fn fit<I>(points: I, outward: &UnitVector) -> Result<Plane, FitError>
    where
        I: IntoIterator<Item = [i64; 3], IntoIter: Clone>,
    {
        let points = points.into_iter();
        let centroid = Centroid::of(points.clone(), 3)?;
        let scatter = centroid.scatter(points.clone());
        Plane::of_scatter(points, &centroid, &scatter, outward)
    }

    /// An edge: the least-squares plane that contains the direction `along`, of at least two
    /// points. So the straight edge of a part seen from above is the plane upright below it,
    /// `along` Z. The normal points to the side of `outward`.
    ///
    /// # Errors
    ///
    /// [`FitError::TooFewPoints`]; [`FitError::Undetermined`] where the points are one above the
    /// other along `along`.
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
        // As long in that direction as in all others, it is never the normal.
        let size = trace(&scatter);
        outer(&mut scatter, size, along, along);
        Plane::of_scatter(points, &centroid, &scatter, outward)
    }

    /// The plane with a normal that is known, of at least one point: an edge touched once, a height
    /// touched often.
    ///
    /// # Errors
    ///
    /// [`FitError::TooFewPoints`] without a point.
    pub fn across<I>(points: I, normal: &UnitVector) -> Result<Plane, FitError>
    where
        I: IntoIterator<Item = [i64; 3], IntoIter: Clone>,
    {
        let points = points.into_iter();
        let centroid = Centroid::of(points.clone(), 1)?;
        Ok(Plane::about(points, &centroid, *normal))
    }

    /// The distance of a point from the plane, positive on the side of the normal, to the nearest
    /// nm; up to 2.1 m from [`point_nm`](Plane::point_nm). Integers only.
    #[must_use]
    pub fn distance_nm(&self, point: [i64; 3]) -> i64 {
        self.normal.length_along(minus(point, self.point_nm))
    }

    /// The plane `by_nm` farther along its normal: by minus the tip radius, the surface from
    /// centres of the ball.
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
        // The sum of the products of two eigenvalues, against the square of their sum.
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
