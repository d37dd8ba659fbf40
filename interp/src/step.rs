//! One event: the axes that step together.

/// One event of a move: which axes step, and how much of the path that is.
#[derive(Copy, Clone, PartialEq, Eq, Debug)]
pub struct Step<const N: usize> {
    /// One step (-1, 0 or +1) for each axis, in BLU; never all zero.
    pub delta: [i8; N],
    /// Share of the move's path time: 1 for lines; for arcs the cross product |P x delta| of the
    /// position from the centre *before* the step, see [`Arc::sweep_bits`](crate::Arc::sweep_bits)
    /// for its unit. Always positive.
    pub sweep: u64,
}
