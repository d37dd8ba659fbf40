//! Circles and spheres.

use super::linear::trace;
use super::vector::{add, difference, length, outer, projected, unit};
use super::{Centroid, FitError, Residuals, Tally, dot, solve};
use crate::UnitVector;

/// A sphere.
#[derive(Copy, Clone, Eq, PartialEq, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Sphere {
    /// Its centre, in nm.
    pub centre_nm: [i64; 3],
    /// Its radius, in nm.
    pub radius_nm: i64,
    /// How the points lie on it; outside is positive.
    pub residuals: Residuals,
}

/// A circle: a bore or a boss.
#[derive(Copy, Clone, Eq, PartialEq, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Circle {
    /// Its centre, in nm, as high along `axis` as the points are on average.
    pub centre_nm: [i64; 3],
    /// Its radius, in nm.
    pub radius_nm: i64,
    /// The normal of its plane.
    pub axis: UnitVector,
    /// How the points lie on it, seen along the axis; outside is positive.
    pub residuals: Residuals,
}

impl Sphere {
    /// The least-squares sphere of at least four points.
    ///
    /// The start is the algebraic fit (I. Kåsa, "A circle fitting procedure and its error
    /// analysis", IEEE Trans. Instr. Meas. 25, 1976, in space), then Gauss-Newton on the distances
    /// from the surface (S. J. Ahn et al., "Least-squares orthogonal distances fitting", Pattern
    /// Recognition 34, 2001) until the centre moves less than 10^-3 nm. Some twenty passes at most.
    ///
    /// # Errors
    ///
    /// [`FitError::TooFewPoints`]; [`FitError::Undetermined`] where the points are in a plane;
    /// [`FitError::NoFit`].
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

    /// The distance of a point from the surface, positive outside, to the nearest nm.
    #[must_use]
    pub fn distance_nm(&self, point: [i64; 3]) -> i64 {
        let from_centre = length(difference(point, self.centre_nm));
        libm::round(from_centre - self.radius_nm as f64) as i64
    }

    /// The sphere `by_nm` larger in radius. From centres of the ball: by minus the tip radius a
    /// ball, by plus the tip radius a hollow.
    #[must_use]
    pub fn grown_nm(&self, by_nm: i64) -> Sphere {
        Sphere {
            radius_nm: self.radius_nm.saturating_add(by_nm),
            ..*self
        }
    }
}

impl Circle {
    /// The least-squares circle of at least three points, seen along `axis`: known, or the normal
    /// of a [`Plane`](super::Plane).
    ///
    /// As [`Sphere::fit`], in the plane.
    ///
    /// # Errors
    ///
    /// [`FitError::TooFewPoints`]; [`FitError::Undetermined`] where the points are on a line;
    /// [`FitError::NoFit`].
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

    /// The distance of a point from the circle, seen along its axis, positive outside, to the
    /// nearest nm.
    #[must_use]
    pub fn distance_nm(&self, point: [i64; 3]) -> i64 {
        let way = difference(point, self.centre_nm);
        let from_centre = length(projected(way, Some(self.axis.to_floats())));
        libm::round(from_centre - self.radius_nm as f64) as i64
    }

    /// The circle `by_nm` larger in radius. From centres of the ball: by plus the tip radius a
    /// bore, by minus the tip radius a boss.
    #[must_use]
    pub fn grown_nm(&self, by_nm: i64) -> Circle {
        Circle {
            radius_nm: self.radius_nm.saturating_add(by_nm),
            ..*self
        }
    }
}

/// A circle or sphere before it is rounded to nm.
pub(crate) struct Round {
    pub centroid: Centroid,
    /// From the centroid.
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

/// Points flatter than this, as a ratio of squares of lengths, determine no circle or sphere.
const FLAT: f64 = 1e-6;

/// Directions from the centre need less room: a cap of 5 degrees has a scatter of 10^-6 along its
/// axis.
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

/// The centre that makes the squares of the distances most alike: `sum z z^T c = sum z |z|^2 / 2`
/// about the centroid.
fn algebraic(
    offsets: impl Iterator<Item = [f64; 3]>,
    axis: Option<[f64; 3]>,
) -> Result<[f64; 3], FitError> {
    let (mut scatter, mut right) = ([[0.0; 3]; 3], [0.0; 3]);
    for offset in offsets {
        outer(&mut scatter, 1.0, offset, offset);
        right = add(right, dot(offset, offset) / 2.0, offset);
    }
    // Nothing is known along the axis, and nothing asked: the centre stays at the centroid's
    // height.
    if let Some(axis) = axis {
        let size = trace(&scatter);
        outer(&mut scatter, size, axis, axis);
    }
    solve(scatter, right, FLAT).ok_or(FitError::Undetermined)
}

/// One step of Gauss-Newton: with `u` the directions from the centre and `d` the distances, both
/// less their means, `sum u u^T shift = sum u d`. The mean of the distances is the radius.
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
    // A point in the centre makes it NaN, which `solve` refuses.
    let shift = solve(scatter, right, NARROW).ok_or(FitError::Undetermined)?;
    Ok((shift, radius))
}
