//! The data that the foreground shares with the interrupts.

use board::{CriticalSection, Pins, Steps};
use husillo_controllers::{Controller, StopBytes};

use crate::Product;

/// The queue of steps, and the bytes that stop it.
///
/// A firmware keeps this in a static and calls its functions in `on_time` and `on_byte`. `PULSED`
/// and `PULSE_US` are those of [`Steps`].
pub struct Interrupts<
    P: Product,
    const PLACES: usize,
    const PULSED: Pins = 0,
    const PULSE_US: u32 = 0,
> {
    pub(crate) steps: Steps<P::Undo, PLACES, PULSED, PULSE_US>,
    pub(crate) stops: <P::Controller as Controller>::Stops,
}

impl<P: Product, const PLACES: usize, const PULSED: Pins, const PULSE_US: u32>
    Interrupts<P, PLACES, PULSED, PULSE_US>
{
    /// An empty queue and no stopping byte. `undo` fills the slots of the queue.
    pub const fn new(undo: P::Undo) -> Self {
        Interrupts {
            steps: Steps::new(undo),
            stops: StopBytes::NONE,
        }
    }

    /// Inverts pins of `PULSED`, while no step is queued.
    pub fn invert(&mut self, pins: Pins) {
        self.steps.invert(pins);
    }

    /// The pins of `PULSED` whose pulse is low.
    pub fn inverted(&self) -> Pins {
        self.steps.inverted()
    }

    /// Acts at the end of a wait. `on_time` calls this.
    #[inline]
    pub fn on_time(&mut self, section: CriticalSection<'_>) {
        self.steps.on_time(section);
    }

    /// Holds the queue at once if the byte is a stopping byte, because the foreground may be busy
    /// for the time of some steps. `on_byte` calls this.
    #[inline]
    pub fn on_byte(&mut self, byte: u8) {
        if self.stops.takes(byte) {
            self.steps.hold();
        }
    }
}
