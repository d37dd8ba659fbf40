//! What all controllers have in common.

/// A controller of one machine, or of several: bytes and inputs in, events and bytes out.
///
/// It has no clock, no pin and no port. What runs a controller is written once for all of them:
/// `husillo_sim::Emulated` in simulated time, `firmware/foreground` on a chip.
///
/// | when | call |
/// | --- | --- |
/// | a byte arrives | [`receive`](Controller::receive) |
/// | it returned `true` and the motors have stopped | [`halted`](Controller::halted) |
/// | the last event was made, or there is room for more | [`next_event`](Controller::next_event) |
/// | an event that has a wait was made | [`made`](Controller::made) |
/// | the transmitter is free | [`transmit`](Controller::transmit) |
/// | the reset button, or power that comes back | [`reset`](Controller::reset) |
///
/// A machine's events are made in the order in which they were given. Waits count from the event
/// before; after a time without events they count from the call that gave the event.
///
/// # Examples
///
/// ```
/// use husillo_controllers::{Controller, Drill, DrillConfig, DrillInputs, Timed};
///
/// /// Ticks until a controller has nothing to do: its inputs stay as they are.
/// fn busy_ticks<C: Controller>(controller: &mut C, inputs: &C::Inputs) -> u64 {
///     let mut ticks = 0;
///     while let Some(event) = controller.next_event(0, inputs) {
///         if let Some(wait) = event.wait_ticks() {
///             ticks += u64::from(wait);
///             controller.made(0, 1);
///         }
///     }
///     ticks
/// }
///
/// // No sensor ever closes: the drill gives up.
/// let mut drill = Drill::<64>::new(DrillConfig::FIXED);
/// assert!(busy_ticks(&mut drill, &DrillInputs::default()) > 1_000_000);
/// ```
pub trait Controller {
    /// What a machine's switches and sensors report.
    type Inputs;
    /// What a machine is to do.
    type Event: Timed;
    /// The bytes that stop the motors at once; `()`: none.
    type Stops: StopBytes;

    /// How many events with a wait it gives before the oldest of them is made. 1: the caller asks
    /// for the next event when the one before was made, so each event is decided with the inputs as
    /// they are then. A controller with more counts them, and gives no more.
    const AHEAD: usize = 1;

    /// How many machines it drives, each in its own time.
    fn machines(&self) -> u8 {
        1
    }

    /// Takes a byte of the line.
    ///
    /// `true`: the motors stop before their next event. The caller drops the events that were not
    /// made, reports the others with [`made`](Controller::made), and calls
    /// [`halted`](Controller::halted).
    fn receive(&mut self, byte: u8) -> bool;

    /// The bytes that stop what moves now. An interrupt holds the motors until
    /// [`receive`](Controller::receive) has taken the byte.
    fn stops(&self) -> Self::Stops;

    /// The motors have stopped, as [`receive`](Controller::receive) asked for.
    fn halted(&mut self) {}

    /// The next event of a machine, with its inputs as they are now.
    ///
    /// `None`: none now. The caller asks again after a byte, after an event was made, and after a
    /// byte was sent. A machine that does not exist has none.
    fn next_event(&mut self, machine: u8, inputs: &Self::Inputs) -> Option<Self::Event>;

    /// So many of a machine's events that have a wait were made, the oldest ones.
    fn made(&mut self, machine: u8, events: usize) {
        let _ = (machine, events);
    }

    /// Whether something is reported when an event that was given is made. Otherwise the caller may
    /// report several events with one call of [`made`](Controller::made).
    fn reports_next(&self) -> bool {
        true
    }

    /// The next byte for the line.
    fn transmit(&mut self) -> Option<u8>;

    /// The reset button, or power that comes back: as after the start. What was stored for good
    /// stays.
    fn reset(&mut self);
}

/// Bytes that stop the motors, for an interrupt.
pub trait StopBytes: Copy {
    /// No byte stops.
    const NONE: Self;

    /// Whether this byte stops.
    fn takes(self, byte: u8) -> bool;
}

/// No byte stops.
impl StopBytes for () {
    const NONE: () = ();

    fn takes(self, _: u8) -> bool {
        false
    }
}

/// An event that may have to wait for its time.
pub trait Timed {
    /// Timer ticks from the event before it, of 1 us in the four machines.
    ///
    /// `None`: it happens at once, and [`made`](Controller::made) does not count it.
    fn wait_ticks(&self) -> Option<u32>;
}
