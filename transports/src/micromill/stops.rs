//! Which bytes stop.

/// Bytes that stop what moves, for an interrupt that does not wait until they are taken in their turn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Stops {
    /// None: nothing moves.
    Nothing,
    /// Any but those of `W;`, `V;` and `L;`: a jog.
    Jog,
    /// Any.
    Anything,
    /// `A`: lines are streamed.
    Letter,
}

impl Stops {
    /// Whether it stops. In a jog the bytes of those strings do as well where they are out of place: that shows when they are taken.
    pub const fn takes(self, byte: u8) -> bool {
        match self {
            Stops::Nothing => false,
            Stops::Jog => !matches!(byte, b'W' | b'V' | b'L' | b';'),
            Stops::Anything => true,
            Stops::Letter => byte == b'A',
        }
    }
}
