//! Cuts on a bench, and lengths of what was cut.

use crate::calibration::backlash::{Bench, Moment};

/// Executes a block, and returns the positions after each of its steps, take-ups included.
pub fn cut(bench: &mut dyn Bench, block: &str) -> Result<Vec<Moment>, String> {
    let mut moments = Vec::new();
    bench.make(block, &mut |moment| moments.push(*moment))?;
    Ok(moments)
}

/// Extent of a mark along an axis, mm.
pub fn extent_mm(moments: &[Moment], axis: usize) -> f64 {
    let at = || moments.iter().map(|moment| moment.tool_nm[axis] / 1e6);
    at().fold(f64::MIN, f64::max) - at().fold(f64::MAX, f64::min)
}

/// Moves to a position in mm from the lower left, so that both axes are on their positive flanks.
pub fn approach(bench: &mut dyn Bench, [x, y]: [f64; 2]) -> Result<(), String> {
    /// Run-up, mm: more than the backlash that remains after any take-up.
    const RUN_UP_MM: f64 = 0.1;
    for before in [RUN_UP_MM, 0.0] {
        let block = format!("G0 X{:.5} Y{:.5}", x - before, y - before);
        bench.make(&block, &mut |_| {})?;
    }
    Ok(())
}
