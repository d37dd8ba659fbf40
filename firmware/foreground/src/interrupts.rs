//! The data of the interrupts.

use board::{CriticalSection, Steps};
use husillo_controllers::{Controller, StopBytes};

use crate::Product;

/// The queue of events, and the bytes that hold it.
///
/// A firmware has it in a static and calls its functions in `on_time` and `on_byte`. `PULSED` and
/// `PULSE_US` are those of [`Steps`].
pub struct Interrupts<
    P: Product,
    const PLACES: usize,
    const PULSED: u8 = 0,
    const PULSE_US: u32 = 0,
> {
    pub(crate) steps: Steps<P::Undo, PLACES, PULSED, PULSE_US>,
    pub(crate) stops: <P::Controller as Controller>::Stops,
}

impl<P: Product, const PLACES: usize, const PULSED: u8, const PULSE_US: u32>
    Interrupts<P, PLACES, PULSED, PULSE_US>
{
    /// No event; `undo` fills the places of the queue.
    pub const fn new(undo: P::Undo) -> Self {
        Interrupts {
            steps: Steps::new(undo),
            stops: StopBytes::NONE,
        }
    }

    /// For `on_time`: a wait is over.
    #[inline]
    pub fn on_time(&mut self, section: CriticalSection<'_>) {
        self.steps.on_time(section);
    }

    /// For `on_byte`: a byte that stops acts at once. The foreground may be busy for some steps.
    #[inline]
    pub fn on_byte(&mut self, byte: u8) {
        if self.stops.takes(byte) {
            self.steps.hold();
        }
    }
}
