//! Backlash by position.

use crate::quantity::Fraction;
use husillo_backlash::{LashMap, MapError};
use std::sync::Arc;

/// A map of backlash in whole steps.
pub type Map = LashMap<Arc<[i32]>, Arc<[u32]>>;

/// Backlash by position: positions along one or two axes in mm, and the backlash there in um.
#[derive(Clone, Debug, PartialEq)]
pub struct PlaceTable {
    /// Numbers of the axes in rising order. A table along one axis has it twice.
    pub axes: [usize; 2],
    /// Positions along these axes. An axis without influence has one position.
    pub places_mm: [Vec<f64>; 2],
    /// Backlash of all positions of the first axis at the first position of the second, and so on.
    pub lash_um: Vec<f64>,
}

impl PlaceTable {
    /// The map of an axis, in whole steps. `own` is the step of this axis in nm, `steps` are the
    /// steps of X, Y and Z.
    ///
    /// # Errors
    ///
    /// [`MapError`].
    pub fn map(&self, own: Fraction, steps: [Fraction; 3]) -> Result<Map, MapError> {
        let places = [0, 1].map(|index| {
            let step = steps[self.axes[index]];
            let of_mm = |mm: &f64| in_steps(mm * 1e6, step) as i32;
            self.places_mm[index].iter().map(of_mm).collect()
        });
        let lash = self.lash_um.iter();
        let lash = lash.map(|um| in_steps(um * 1e3, own) as u32).collect();
        LashMap::new(self.axes, places, lash)
    }
}

/// A length in steps. The casts of the callers saturate.
fn in_steps(nm: f64, step: Fraction) -> f64 {
    (nm * step.den as f64 / step.num as f64).round()
}
