//! The play of screws by place.

/// What play each axis has where the tools are, all in steps of the drives.
///
/// Play that changes by a step or more from one step of the tool to the next is no screw's.
pub trait LashField<const N: usize>: Send + Sync {
    /// Play of each axis, not negative, with the tools at `tool`.
    fn lash_steps(&self, tool: [f64; N]) -> [f64; N];
}

impl<const N: usize, F: Fn([f64; N]) -> [f64; N] + Send + Sync> LashField<N> for F {
    fn lash_steps(&self, tool: [f64; N]) -> [f64; N] {
        self(tool)
    }
}
