//! The data that the foreground shares with the interrupts.

use board::{CriticalSection, Pins, Steps};
use husillo_controllers::{Controller, StopBytes};

use crate::Product;

/// The queue of steps, and the bytes that stop it.
///
/// A firmware keeps this in a static and calls its functions in `on_time` and `on_byte`. `PULSED`
/// is that of [`Steps`].
pub struct Interrupts<P: Product, const PLACES: usize, const PULSED: Pins = 0> {
    pub(crate) steps: Steps<P::Undo, PLACES, PULSED>,
    pub(crate) stops: <P::Controller as Controller>::Stops,
}

impl<P: Product, const PLACES: usize, const PULSED: Pins> Interrupts<P, PLACES, PULSED> {
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

    /// Sets the time of a pulse.
    pub fn set_pulse_us(&mut self, us: u32) {
        self.steps.set_pulse_us(us);
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
