//! The bytes that stop a motion.

/// The bytes that stop the motion. An interrupt uses this, because it must act before the
/// foreground takes the byte.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Stops {
    /// No byte: nothing moves.
    Nothing,
    /// Any byte except those of `W;`, `V;` and `L;`: a jog, or a motion with a lease.
    Jog,
    /// Any byte.
    Anything,
    /// `A`: lines are streamed.
    Letter,
}

impl Stops {
    /// Whether the byte stops the motion. The bytes of `W;`, `V;` and `L;` also stop a jog if they
    /// are out of place. The foreground detects this.
    pub const fn takes(self, byte: u8) -> bool {
        match self {
            Stops::Nothing => false,
            Stops::Jog => !matches!(byte, b'W' | b'V' | b'L' | b';'),
            Stops::Anything => true,
            Stops::Letter => byte == b'A',
        }
    }
}
