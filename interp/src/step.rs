//! One event: the axes that step together.

/// One event of a move: which axes step, and how much of the path that is.
///
/// Eight bytes, so that it travels in registers. Bit `a` of the masks is axis `a`: an interrupt
/// writes them to its step and direction pins as they are. Eight axes at most.
#[derive(Copy, Clone, PartialEq, Eq, Hash, Debug, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Step {
    /// The axes that make a step. Empty only in the idle passes of a DDA, which take their time and
    /// move nothing.
    pub axes: u8,
    /// Those of them that step backwards; no other bits.
    pub negative: u8,
    /// Share of the move's path time: 1 for lines; for arcs the cross product |P x step| of the
    /// position from the centre *before* the step, see [`Arc::sweep_bits`](crate::Arc::sweep_bits)
    /// for its unit. Always positive.
    pub sweep: u32,
}

impl Step {
    /// -1, 0 or +1 step of one axis, in BLU.
    #[inline]
    pub const fn delta(self, axis: usize) -> i8 {
        // An axis that does not exist does not step: the masks have eight bits, shifts beyond 31
        // would wrap.
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

/// The mask of the axes that go backwards, of the first eight.
pub(crate) fn negative_axes<const N: usize>(delta: [i32; N]) -> u8 {
    (0..8_u32)
        .zip(delta)
        .filter(|(_, distance)| *distance < 0)
        .fold(0, |mask, (axis, _)| mask | 1_u8.wrapping_shl(axis))
}
