//! Lost steps of a motor.

/// Reason why the rotor did not follow the field.
#[derive(Copy, Clone, Eq, PartialEq, Hash, Debug)]
pub enum Cause {
    /// The levels changed sooner than the pull-out interval.
    TooFast,
    /// The field jumped by half an electrical cycle, because a phase was skipped. Both directions
    /// are then equally near.
    HalfCycle,
    /// The levels changed while the coils had no current.
    NoCurrent,
    /// A step and direction driver did not count a step, or cancelled one. STEP was high or low for
    /// too short a time, or DIR was not stable around the rising edge.
    Pulse,
    /// The rotor was blocked.
    Blocked,
    /// The rotor was already behind, and went to an equilibrium that is not that of the previous
    /// field.
    Slipped,
}

/// One change of levels that the rotor did not follow.
#[derive(Copy, Clone, Eq, PartialEq, Debug)]
pub struct Loss {
    /// Index of the call of [`Rig::apply`](crate::Rig::apply), from 0.
    pub event: u64,
    /// Index of the axis, from 0.
    pub axis: usize,
    /// Drive steps that the field moved without the rotor.
    pub steps: u32,
    /// Reason for the loss.
    pub cause: Cause,
}
