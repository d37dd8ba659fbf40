//! One event: the axes that step together.

/// One event of a move: the axes that step, and the share of the path.
///
/// Eight bytes, so that it travels in registers. Bit `a` of the masks is axis `a`, so an interrupt
/// can write them directly to its step and direction pins. At most eight axes.
#[derive(Copy, Clone, PartialEq, Eq, Hash, Debug, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Step {
    /// The axes that make a step. Empty only in the idle passes of a DDA, which take time without
    /// motion.
    pub axes: u8,
    /// Those of `axes` that step backwards; no other bits are set.
    pub negative: u8,
    /// Share of the path time of the move, always positive. It is 1 for lines. For arcs it is the
    /// cross product |P x step| of the position from the centre *before* the step; see
    /// [`Arc::sweep_bits`](crate::Arc::sweep_bits) for its unit.
    pub sweep: u32,
}

impl Step {
    /// The step of one axis in BLU: -1, 0 or +1.
    #[inline]
    pub const fn delta(self, axis: usize) -> i8 {
        // An axis that does not exist does not step. The masks have eight bits, and shifts beyond
        // 31 would wrap.
        if axis > 7 {
            return 0;
        }
        let steps = (self.axes >> axis) as i8 & 1;
        let backwards = (self.negative >> axis) as i8 & 1;
        steps.wrapping_sub(backwards.wrapping_mul(2))
    }

    /// The step of every axis, in BLU.
    #[inline]
    pub fn deltas<const N: usize>(self) -> [i8; N] {
        core::array::from_fn(|axis| self.delta(axis))
    }
}

/// The mask of the axes with a negative distance, among the first eight.
pub(crate) fn negative_axes<const N: usize>(delta: [i32; N]) -> u8 {
    (0..8_u32)
        .zip(delta)
        .filter(|(_, distance)| *distance < 0)
        .fold(0, |mask, (axis, _)| mask | 1_u8.wrapping_shl(axis))
}
