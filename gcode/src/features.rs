//! Features of this build, as constants.

/// Whether the codes beyond those of Grbl are compiled in.
pub(crate) const EXTENDED: bool = cfg!(feature = "extended");

/// Whether there is room for faster, longer code. Processors without compare-and-swap (Cortex-M0)
/// have little flash.
pub(crate) const ROOMY: bool = cfg!(target_has_atomic = "32");
