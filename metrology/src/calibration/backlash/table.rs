//! Backlash by position.

use crate::quantity::Fraction;
use husillo_backlash::{BacklashMap, MapError};
use std::sync::Arc;

/// A map of backlash in whole steps.
pub type Map = BacklashMap<Arc<[i32]>, Arc<[u32]>>;

/// Backlash by position: positions along one or two axes in mm, and the backlash there in um.
#[derive(Clone, Debug, PartialEq)]
pub struct BacklashTable {
    /// Numbers of the axes in rising order. A table along one axis has its number twice.
    pub axes: [usize; 2],
    /// Positions along these axes. An axis that does not change the backlash has one position.
    pub positions_mm: [Vec<f64>; 2],
    /// Backlash of all positions of the first axis at the first position of the second, and so on.
    pub backlash_um: Vec<f64>,
}

impl BacklashTable {
    /// The map of an axis, in whole steps. `own` is the step of this axis in nm, `steps` are the
    /// steps of X, Y and Z.
    ///
    /// # Errors
    ///
    /// [`MapError`].
    pub fn map(&self, own: Fraction, steps: [Fraction; 3]) -> Result<Map, MapError> {
        let positions = [0, 1].map(|index| {
            let step = steps[self.axes[index]];
            let of_mm = |mm: &f64| in_steps(mm * 1e6, step) as i32;
            self.positions_mm[index].iter().map(of_mm).collect()
        });
        let backlash = self.backlash_um.iter();
        let backlash = backlash.map(|um| in_steps(um * 1e3, own) as u32).collect();
        BacklashMap::new(self.axes, positions, backlash)
    }
}

/// A length in steps. The casts of the callers saturate.
fn in_steps(nm: f64, step: Fraction) -> f64 {
    (nm * step.den as f64 / step.num as f64).round()
}
