//! The events that move motors.

/// Longest wait of one event, in timer ticks; longer ones come in several events.
pub const MAX_WAIT_TICKS: u32 = 1 << 31;

/// Wait `wait_ticks`, then step every axis by its delta.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct StepEvent<const N: usize> {
    /// Timer ticks from the event before this one.
    pub wait_ticks: u32,
    /// -1, 0 or +1 motor step of every axis.
    pub delta: [i8; N],
}
