//! Steps a motor did not make.

/// Why the rotor did not follow the field.
#[derive(Copy, Clone, Eq, PartialEq, Hash, Debug)]
pub enum Cause {
    /// The levels changed sooner than the pull-out interval.
    TooFast,
    /// The field jumped half an electrical cycle: a phase was skipped, and either way is as near.
    HalfCycle,
    /// The levels changed while the coils had no current.
    NoCurrent,
    /// A step and direction driver counted no step, or one too few: STEP was high or low too
    /// shortly, or DIR was not stable around its rising edge.
    Pulse,
    /// Something held the rotor.
    Blocked,
    /// The rotor, already behind, went to another equilibrium than the one the field came from.
    Slipped,
}

/// One change of levels that the rotor did not follow.
#[derive(Copy, Clone, Eq, PartialEq, Debug)]
pub struct Loss {
    /// Which call of [`Rig::apply`](crate::Rig::apply), from 0.
    pub event: u64,
    /// Which axis, from 0.
    pub axis: usize,
    /// How many steps of the drive the field moved without the rotor.
    pub steps: u32,
    /// Why.
    pub cause: Cause,
}
