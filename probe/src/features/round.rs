//! Circles and spheres.

use super::linear::trace;
use super::vector::{add, difference, length, outer, projected, unit};
use super::{Centroid, FitError, Residuals, Tally, dot, solve};
use crate::UnitVector;

/// A sphere.
#[derive(Copy, Clone, Eq, PartialEq, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Sphere {
    /// The centre, in nm.
    pub centre_nm: [i64; 3],
    /// Its radius, in nm.
    pub radius_nm: i64,
    /// Residuals of the points; outside is positive.
    pub residuals: Residuals,
}

/// A circle: a bore or a boss.
#[derive(Copy, Clone, Eq, PartialEq, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Circle {
    /// The centre, in nm. Its height along `axis` is the mean height of the points.
    pub centre_nm: [i64; 3],
    /// Its radius, in nm.
    pub radius_nm: i64,
    /// The normal of the circle's plane.
    pub axis: UnitVector,
    /// Residuals of the points, seen along the axis; outside is positive.
    pub residuals: Residuals,
}

impl Sphere {
    /// Fits the least-squares sphere of at least four points.
    ///
    /// The start value is an algebraic fit. Gauss-Newton on the distances from the surface follows,
    /// until the centre moves by less than 10^-3 nm.
    ///
    /// # Errors
    /// - [`FitError::TooFewPoints`]: fewer than four points.
    /// - [`FitError::Undetermined`]: the points are in a plane.
    /// - [`FitError::NoFit`]: the iteration does not converge.
    ///
    /// # Cost
    /// About twenty passes over the points at most.
    ///
    /// # Source
    /// Start: I. Kåsa, "A circle fitting procedure and its error analysis", IEEE Trans. Instr.
    /// Meas. 25, 1976, in space. Iteration: S. J. Ahn et al., "Least-squares orthogonal distances
    /// fitting", Pattern Recognition 34, 2001.
    pub fn fit<I>(points: I) -> Result<Sphere, FitError>
    where
        I: IntoIterator<Item = [i64; 3], IntoIter: Clone>,
    {
        let round = fit_round(points.into_iter(), None)?;
        Ok(Sphere {
            centre_nm: round.centre_nm(),
            radius_nm: round.radius_nm(),
            residuals: round.residuals,
        })
    }

    /// Returns the distance of a point from the surface, positive outside, to the nearest nm.
    #[must_use]
    pub fn distance_nm(&self, point: [i64; 3]) -> i64 {
        let from_centre = length(difference(point, self.centre_nm));
        libm::round(from_centre - self.radius_nm as f64) as i64
    }

    /// Returns the sphere with a radius larger by `by_nm`. For a fit to centres of the ball,
    /// `by_nm` is minus the tip radius for a ball and plus the tip radius for a hollow.
    #[must_use]
    pub fn grown_nm(&self, by_nm: i64) -> Sphere {
        Sphere {
            radius_nm: self.radius_nm.saturating_add(by_nm),
            ..*self
        }
    }
}

impl Circle {
    /// Fits the least-squares circle of at least three points, seen along `axis`. The axis is
    /// known, or it is the normal of a [`Plane`](super::Plane).
    ///
    /// The method is that of [`Sphere::fit`], in the plane.
    ///
    /// # Errors
    /// - [`FitError::TooFewPoints`]: fewer than three points.
    /// - [`FitError::Undetermined`]: the points are on a line.
    /// - [`FitError::NoFit`]: the iteration does not converge.
    pub fn fit<I>(points: I, axis: &UnitVector) -> Result<Circle, FitError>
    where
        I: IntoIterator<Item = [i64; 3], IntoIter: Clone>,
    {
        let round = fit_round(points.into_iter(), Some(axis))?;
        Ok(Circle {
            centre_nm: round.centre_nm(),
            radius_nm: round.radius_nm(),
            axis: *axis,
            residuals: round.residuals,
        })
    }

    /// Returns the distance of a point from the circle, seen along its axis, positive outside, to
    /// the nearest nm.
    #[must_use]
    pub fn distance_nm(&self, point: [i64; 3]) -> i64 {
        let displacement = difference(point, self.centre_nm);
        let from_centre = length(projected(displacement, Some(self.axis.to_floats())));
        libm::round(from_centre - self.radius_nm as f64) as i64
    }

    /// Returns the circle with a radius larger by `by_nm`. For a fit to centres of the ball,
    /// `by_nm` is plus the tip radius for a bore and minus the tip radius for a boss.
    #[must_use]
    pub fn grown_nm(&self, by_nm: i64) -> Circle {
        Circle {
            radius_nm: self.radius_nm.saturating_add(by_nm),
            ..*self
        }
    }
}

/// A circle or sphere before rounding to nm.
pub(crate) struct Round {
    pub centroid: Centroid,
    /// Relative to the centroid.
    pub centre: [f64; 3],
    pub radius: f64,
    pub residuals: Residuals,
}

impl Round {
    fn centre_nm(&self) -> [i64; 3] {
        self.centroid.point_nm(self.centre)
    }

    fn radius_nm(&self) -> i64 {
        libm::round(self.radius) as i64
    }
}

/// Points with a smaller ratio of squares of lengths are too flat to determine a circle or sphere.
const FLAT: f64 = 1e-6;

/// The limit for directions from the centre is lower: a cap of 5 degrees has a scatter of 10^-6
/// along its axis.
const NARROW: f64 = 1e-9;

pub(crate) fn fit_round(
    points: impl Iterator<Item = [i64; 3]> + Clone,
    axis: Option<&UnitVector>,
) -> Result<Round, FitError> {
    let centroid = Centroid::of(points.clone(), if axis.is_some() { 3 } else { 4 })?;
    let axis = axis.map(unit);
    let offsets = points.map(|point| projected(centroid.offset(point), axis));
    let mut centre = algebraic(offsets.clone(), axis)?;
    for _ in 0..64 {
        let (shift, radius) = improve(offsets.clone(), f64::from(centroid.count), axis, centre)?;
        centre = add(centre, 1.0, shift);
        if length(shift) < 1e-3_f64.max(radius * 1e-14) {
            let distances = offsets.map(|offset| length(add(offset, -1.0, centre)));
            let radius = distances.clone().sum::<f64>() / f64::from(centroid.count);
            let tally: Tally = distances.map(|distance| distance - radius).collect();
            return Ok(Round {
                centroid,
                centre,
                radius,
                residuals: tally.residuals(),
            });
        }
    }
    Err(FitError::NoFit)
}

/// Returns the centre for which the squares of the distances differ least:
/// `sum z z^T c = sum z |z|^2 / 2` about the centroid.
fn algebraic(
    offsets: impl Iterator<Item = [f64; 3]>,
    axis: Option<[f64; 3]>,
) -> Result<[f64; 3], FitError> {
    let (mut scatter, mut right) = ([[0.0; 3]; 3], [0.0; 3]);
    for offset in offsets {
        outer(&mut scatter, 1.0, offset, offset);
        right = add(right, dot(offset, offset) / 2.0, offset);
    }
    // The height along the axis is neither known nor needed: the centre stays at the height of the
    // centroid.
    if let Some(axis) = axis {
        let size = trace(&scatter);
        outer(&mut scatter, size, axis, axis);
    }
    solve(scatter, right, FLAT).ok_or(FitError::Undetermined)
}

/// Computes one step of Gauss-Newton, `sum u u^T shift = sum u d`. `u` are the directions from the
/// centre and `d` the distances, each minus its mean. The mean of the distances is the radius.
fn improve(
    offsets: impl Iterator<Item = [f64; 3]> + Clone,
    count: f64,
    axis: Option<[f64; 3]>,
    centre: [f64; 3],
) -> Result<([f64; 3], f64), FitError> {
    let rays = offsets.map(|offset| {
        let ray = add(offset, -1.0, centre);
        let distance = length(ray);
        (ray.map(|component| component / distance), distance)
    });
    let (mut direction, mut radius) = ([0.0; 3], 0.0);
    for (ray, distance) in rays.clone() {
        direction = add(direction, 1.0 / count, ray);
        radius += distance / count;
    }
    let (mut scatter, mut right) = ([[0.0; 3]; 3], [0.0; 3]);
    for (ray, distance) in rays {
        let ray = add(ray, -1.0, direction);
        outer(&mut scatter, 1.0, ray, ray);
        right = add(right, distance - radius, ray);
    }
    if let Some(axis) = axis {
        outer(&mut scatter, count, axis, axis);
    }
    // A point at the centre makes the matrix NaN, which `solve` rejects.
    let shift = solve(scatter, right, NARROW).ok_or(FitError::Undetermined)?;
    Ok((shift, radius))
}
