//! Position-dependent backlash of screws.

/// Backlash of each axis as a function of the tool position, all in drive steps.
///
/// As on a real screw, the backlash must change by less than a step from one step of the tool to
/// the next.
pub trait BacklashField<const N: usize>: Send + Sync {
    /// Backlash of each axis, not negative, with the tool at `tool`.
    fn backlash_steps(&self, tool: [f64; N]) -> [f64; N];
}

impl<const N: usize, F: Fn([f64; N]) -> [f64; N] + Send + Sync> BacklashField<N> for F {
    fn backlash_steps(&self, tool: [f64; N]) -> [f64; N] {
        self(tool)
    }
}
