//! Many events of an arc at a time.

/// What [`Helix::fill`](crate::Helix::fill) has written.
#[derive(Copy, Clone, PartialEq, Eq, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Run<const N: usize> {
    /// Number of events.
    pub events: u32,
    /// Number of steps of each axis.
    pub steps: [u32; N],
    /// Whether the sweeps of the events add up to more than the room. Without the last one they do
    /// not.
    pub is_beyond: bool,
}

impl<const N: usize> Run<N> {
    pub(crate) const NONE: Run<N> = Run {
        events: 0,
        steps: [0; N],
        is_beyond: false,
    };
}
