//! Calibration of tip radius and pre-travel on a reference.

use crate::features::{
    Round, Tally, add, difference, dot, fit_round, length, outer, projected, solve, to_nm, unit,
};
use crate::{FitError, PreTravel, Residuals, Tip, Touch, UnitVector};

/// A reference body of known size.
#[derive(Copy, Clone, Eq, PartialEq, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Reference {
    /// A ball, touched from outside.
    Sphere {
        /// Its radius in nm.
        radius_nm: i64,
    },
    /// A ring, touched from inside.
    Ring {
        /// Its inner radius in nm.
        radius_nm: i64,
        /// The direction of its axis.
        axis: UnitVector,
    },
}

/// A calibrated probe and the quality of its calibration.
#[derive(Copy, Clone, Eq, PartialEq, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Calibration<const K: usize> {
    /// Radius and pre-travel of the probe.
    pub tip: Tip<K>,
    /// Centre of the reference, in nm.
    pub centre_nm: [i64; 3],
    /// Residuals of the touches after correction by radius and pre-travel.
    pub residuals: Residuals,
}

impl<const K: usize> Calibration<K> {
    /// Calibrates a probe from latched touches of a reference at an unknown position. It needs at
    /// least one touch more than there are unknowns. Several touches in each direction average the
    /// noise.
    ///
    /// A touch is `p = c + (R +- r) n + ed d`: centre, radii of reference and tip, outward normal
    /// of the ball's centre, pre-travel. The sum of the radii is for a sphere, the difference for a
    /// ring. Gauss-Newton finds `c`, the mean `ed` and, without `tip_radius_nm`, `r`. It minimises
    /// the squares of the differences between the distances `|p - ed d - c|` and `R +- r`. The
    /// table gets one entry for each of `directions`. The entry follows from the residuals of the
    /// touches nearest to it; without such touches it is the mean.
    ///
    /// A reference does not determine everything:
    ///
    /// - If every approach is along the normal, only the effective radius `r - ed` is known. State
    ///   the tip radius or touch obliquely too.
    /// - A pre-travel that is larger by `v.d` in every direction equals a reference displaced by
    ///   `v`. This part stays in the centre and shifts all measurements equally.
    ///
    /// # Errors
    /// - [`FitError::TooFewPoints`], [`FitError::Undetermined`] and [`FitError::NoFit`]: no fit is
    ///   possible.
    /// - [`FitError::Inseparable`]: `tip_radius_nm` is missing and no approach is oblique. The
    ///   cosines between travel and normal must spread by 0.01 or more.
    pub fn fit<I>(
        touches: I,
        reference: &Reference,
        tip_radius_nm: Option<i32>,
        directions: [UnitVector; K],
    ) -> Result<Calibration<K>, FitError>
    where
        I: IntoIterator<Item = Touch, IntoIter: Clone>,
    {
        let touches = touches.into_iter();
        let (radius, sign, axis) = match reference {
            Reference::Sphere { radius_nm } => (*radius_nm as f64, 1.0, None),
            Reference::Ring { radius_nm, axis } => (*radius_nm as f64, -1.0, Some(axis)),
        };
        let start = fit_round(touches.clone().map(|touch| touch.position), axis)?;
        let mut model = Model::new(
            &start,
            axis,
            tip_radius_nm.map(|tip| radius + sign * f64::from(tip)),
        );
        model.fit(touches.clone(), tip_radius_nm.is_some())?;

        // Sums of g f and of g g per entry. The correction is f / g for a touch with residual f and
        // cosine g.
        let mut sums = [(0.0, 0.0); K];
        for touch in touches.clone() {
            let (_, cosine, off) = model.ray(&touch);
            if let Some((product, square)) =
                nearest(&directions, &touch.direction).and_then(|entry| sums.get_mut(entry))
            {
                *product += cosine * off;
                *square += cosine * cosine;
            }
        }
        let corrections =
            sums.map(|(product, square)| if square > 0.0 { product / square } else { 0.0 });
        let residuals = touches
            .map(|touch| {
                let (_, cosine, off) = model.ray(&touch);
                let correction = nearest(&directions, &touch.direction)
                    .and_then(|entry| corrections.get(entry))
                    .unwrap_or(&0.0);
                off - cosine * correction
            })
            .collect::<Tally>()
            .residuals();
        let mut entries = directions.map(|direction| (direction, 0));
        for ((_, nm), correction) in entries.iter_mut().zip(corrections) {
            *nm = libm::round(model.pre_travel + correction) as i32;
        }
        let found = libm::round(sign * (model.radius - radius)) as i32;
        Ok(Calibration {
            tip: Tip {
                radius_nm: tip_radius_nm.unwrap_or(found),
                pre_travel: PreTravel::new(entries),
            },
            centre_nm: to_nm(model.origin, model.centre),
            residuals,
        })
    }
}

/// Unknowns of the fit.
struct Model {
    origin: [i64; 3],
    axis: Option<[f64; 3]>,
    /// Relative to the origin.
    centre: [f64; 3],
    pre_travel: f64,
    /// Radius of the sphere on which the ball's centre moves.
    radius: f64,
}

/// Below this value per touch the unknowns cannot be separated. It corresponds to a spread of
/// cosines of 0.01.
const APART: f64 = 1e-4;

impl Model {
    fn new(start: &Round, axis: Option<&UnitVector>, radius: Option<f64>) -> Model {
        Model {
            origin: start.centroid.origin,
            axis: axis.map(unit),
            centre: add(start.centroid.mean, 1.0, start.centre),
            // The first step finds it, because it is linear along the normal.
            pre_travel: 0.0,
            radius: radius.unwrap_or(start.radius),
        }
    }

    /// Returns the direction from the centre to the ball, its cosine to the travel, and the
    /// distance of the ball outside the radius.
    fn ray(&self, touch: &Touch) -> ([f64; 3], f64, f64) {
        let travel = touch.direction.to_floats();
        let ball = add(
            difference(touch.position, self.origin),
            -self.pre_travel,
            travel,
        );
        let radial = projected(add(ball, -1.0, self.centre), self.axis);
        let distance = length(radial);
        let ray = radial.map(|component| component / distance);
        (ray, dot(ray, travel), distance - self.radius)
    }

    /// One Gauss-Newton step: `u.shift + (u.d) change + growth = off` for each touch.
    fn fit(
        &mut self,
        touches: impl Iterator<Item = Touch> + Clone,
        is_radius_known: bool,
    ) -> Result<(), FitError> {
        for _ in 0..64 {
            let (mut matrix, mut right, mut count) = ([[0.0; 5]; 5], [0.0; 5], 0.0);
            for touch in touches.clone() {
                let ([x, y, z], cosine, off) = self.ray(&touch);
                let growth = if is_radius_known { 0.0 } else { 1.0 };
                let row = [x, y, z, cosine, growth];
                outer(&mut matrix, 1.0, row, row);
                right = add(right, off, row);
                count += 1.0;
            }
            // A parameter that is not fitted stays unchanged.
            if let Some([x, y, z]) = self.axis {
                let axis = [x, y, z, 0.0, 0.0];
                outer(&mut matrix, count, axis, axis);
            }
            if is_radius_known {
                let radius = [0.0, 0.0, 0.0, 0.0, 1.0];
                outer(&mut matrix, count, radius, radius);
            }
            let [x, y, z, change, growth] =
                solve(matrix, right, APART).ok_or(if is_radius_known {
                    FitError::Undetermined
                } else {
                    FitError::Inseparable
                })?;
            self.centre = add(self.centre, 1.0, [x, y, z]);
            self.pre_travel += change;
            self.radius += growth;
            let moved = length([x, y, z]).max(change.abs()).max(growth.abs());
            if moved < 1e-3_f64.max(self.radius * 1e-13) {
                return Ok(());
            }
        }
        Err(FitError::NoFit)
    }
}

/// Returns the entry nearest to a direction, the first if several are equal.
fn nearest<const K: usize>(directions: &[UnitVector; K], direction: &UnitVector) -> Option<usize> {
    let mut best = None;
    for (entry, candidate) in (0..K).zip(directions) {
        let cosine = candidate.cosine(direction);
        if best.is_none_or(|(most, _)| cosine > most) {
            best = Some((cosine, entry));
        }
    }
    best.map(|(_, entry)| entry)
}
