//! What this build has, as constants.

/// Whether the codes beyond Grbl's list are there.
pub(crate) const EXTENDED: bool = cfg!(feature = "extended");

/// Whether there is room for code that is faster and longer. Processors without compare-and-swap
/// (Cortex-M0) have little.
pub(crate) const ROOMY: bool = cfg!(target_has_atomic = "32");
