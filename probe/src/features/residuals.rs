//! Residuals and errors of fits.

/// Distances between points and the feature fitted to them, to the nearest nm.
#[derive(Copy, Clone, Eq, PartialEq, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Residuals {
    /// Number of points.
    pub points: u32,
    /// Root mean square of the distances.
    pub rms_nm: i64,
    /// The largest unsigned distance.
    pub largest_nm: i64,
    /// The largest signed distance minus the smallest: the deviation of form (ISO 1101) about the
    /// least-squares feature. For a line in space, whose distances have no sign, it is the largest
    /// distance.
    pub form_nm: i64,
}

/// Error of a fit.
#[derive(Copy, Clone, Eq, PartialEq, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum FitError {
    /// Fewer points than the feature has unknowns.
    TooFewPoints,
    /// The points do not determine the feature: they lie on a point, a line or a plane, or are
    /// spread evenly in all directions.
    Undetermined,
    /// The iteration does not converge: the points are far from any such feature.
    NoFit,
    /// Calibration: every approach was along the normal, so tip radius and pre-travel cannot be
    /// separated. State the tip radius or touch obliquely too.
    Inseparable,
}

impl core::fmt::Display for FitError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str(match self {
            FitError::TooFewPoints => "too few points",
            FitError::Undetermined => "points do not determine the feature",
            FitError::NoFit => "points are not on such a feature",
            FitError::Inseparable => "tip radius and pre-travel cannot be separated",
        })
    }
}

impl core::error::Error for FitError {}

/// Running sums of distances.
#[derive(Copy, Clone, Default)]
pub(crate) struct Tally {
    points: u32,
    squares: f64,
    least: f64,
    most: f64,
}

impl Tally {
    pub fn push(&mut self, distance: f64) {
        (self.least, self.most) = if self.points == 0 {
            (distance, distance)
        } else {
            (self.least.min(distance), self.most.max(distance))
        };
        self.points = self.points.saturating_add(1);
        self.squares += distance * distance;
    }

    pub fn residuals(&self) -> Residuals {
        let nm = |value: f64| libm::round(value) as i64;
        Residuals {
            points: self.points,
            rms_nm: nm(libm::sqrt(self.squares / f64::from(self.points.max(1)))),
            largest_nm: nm(self.most.max(-self.least)),
            form_nm: nm(self.most - self.least),
        }
    }
}

impl FromIterator<f64> for Tally {
    fn from_iter<I: IntoIterator<Item = f64>>(distances: I) -> Tally {
        let mut tally = Tally::default();
        distances
            .into_iter()
            .for_each(|distance| tally.push(distance));
        tally
    }
}
