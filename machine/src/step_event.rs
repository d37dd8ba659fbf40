//! Events that move motors.

/// Longest wait of one event in timer ticks; longer waits are split into several events.
pub const MAX_WAIT_TICKS: u32 = 1 << 31;

/// Wait `wait_ticks`, then step every axis by its delta.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct StepEvent<const N: usize> {
    /// Timer ticks since the previous event.
    pub wait_ticks: u32,
    /// Motor step of every axis: -1, 0 or +1.
    pub delta: [i8; N],
}

impl<const N: usize> Default for StepEvent<N> {
    /// No wait and no step, for places that [`Machine::fill`](crate::Machine::fill) writes.
    fn default() -> Self {
        StepEvent {
            wait_ticks: 0,
            delta: [0; N],
        }
    }
}
