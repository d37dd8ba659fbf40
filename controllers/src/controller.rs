//! Common interface of all controllers.

/// A controller of one or several machines: bytes and inputs in, events and bytes out.
///
/// It has no clock, no pin and no port. The code that runs a controller exists once for all
/// controllers: `husillo_sim::Emulated` in simulated time, `firmware/foreground` on a chip.
///
/// | when | call |
/// | --- | --- |
/// | a byte arrives | [`receive`](Controller::receive) |
/// | no byte has arrived for [`lease_us`](Controller::lease_us) | [`expire`](Controller::expire) |
/// | one of them returned `true` and the motors have stopped | [`halted`](Controller::halted) |
/// | the last event was made, or there is room for more | [`next_event`](Controller::next_event) |
/// | an event with a wait was made | [`made`](Controller::made) |
/// | the transmitter is free | [`transmit`](Controller::transmit) |
/// | the reset button is pressed, or power returns | [`reset`](Controller::reset) |
///
/// The caller makes the events of a machine in the order in which the controller gives them. A wait
/// counts from the previous event. After a time without events it counts from the call that gave
/// the event.
///
/// # Examples
///
/// ```
/// use husillo_controllers::{Controller, Drill, DrillConfig, DrillInputs, Timed};
///
/// /// Returns the ticks until a controller is idle, with constant inputs.
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
    /// The readings of a machine's switches and sensors.
    type Inputs;
    /// The events of a machine.
    type Event: Timed;
    /// The bytes that stop the motors at once; `()` for none.
    type Stops: StopBytes;

    /// Largest number of events with a wait that the controller gives before the oldest of them is
    /// made. With 1, the caller requests the next event when the previous one is made, so the
    /// controller decides each event with the inputs of that time. With more, the controller counts
    /// these events and stops at this number.
    const AHEAD: usize = 1;

    /// Returns the number of machines. Each has its own time.
    fn machines(&self) -> u8 {
        1
    }

    /// Takes a byte from the line.
    ///
    /// Returns `true` if the motors must stop before their next event. The caller then drops the
    /// events that were not made, reports the others with [`made`](Controller::made), and calls
    /// [`halted`](Controller::halted).
    fn receive(&mut self, byte: u8) -> bool;

    /// Returns the bytes that stop the present motion. An interrupt that receives such a byte holds
    /// the motors until [`receive`](Controller::receive) has taken it.
    fn stops(&self) -> Self::Stops;

    /// Confirms that the motors have stopped, after [`receive`](Controller::receive) requested it.
    fn halted(&mut self) {}

    /// Returns the longest permitted silence of the line during the present motion, us. `None`:
    /// nothing moves, or the motion needs no host.
    fn lease_us(&self) -> Option<u32> {
        None
    }

    /// Ends the motion, because no byte has arrived for [`lease_us`](Controller::lease_us). Returns
    /// `true` if the motors must stop before their next event, as [`receive`](Controller::receive)
    /// does.
    fn expire(&mut self) -> bool {
        false
    }

    /// Returns the next event of a machine for its present inputs.
    ///
    /// Returns `None` if there is none now. The caller asks again after a byte arrived, after an
    /// event was made, and after a byte was sent. A machine that does not exist has no events.
    fn next_event(&mut self, machine: u8, inputs: &Self::Inputs) -> Option<Self::Event>;

    /// Reports that the oldest `events` events with a wait were made.
    fn made(&mut self, machine: u8, events: usize) {
        let _ = (machine, events);
    }

    /// Whether the controller sends a report when an event that it has given is made. If not, the
    /// caller may report several events with one call of [`made`](Controller::made).
    fn reports_next(&self) -> bool {
        true
    }

    /// Whether [`transmit`](Controller::transmit) has made an event that the caller must request
    /// now. It can be that an answer waits for this event.
    fn has_event(&self) -> bool {
        false
    }

    /// Returns the next byte for the line.
    fn transmit(&mut self) -> Option<u8>;

    /// Sets the state after the start. The caller does this when the reset button is pressed or the
    /// power returns. Permanently stored data is kept.
    fn reset(&mut self);
}

/// Bytes that stop the motors, for use in an interrupt.
pub trait StopBytes: Copy {
    /// A set without any byte.
    const NONE: Self;

    /// Whether this byte stops the motors.
    fn takes(self, byte: u8) -> bool;
}

/// No byte stops the motors.
impl StopBytes for () {
    const NONE: () = ();

    fn takes(self, _: u8) -> bool {
        false
    }
}

/// An event that may have a wait.
pub trait Timed {
    /// Returns the timer ticks from the previous event. A tick is 1 us in all controllers of
    /// this crate.
    ///
    /// Returns `None` for an event that happens at once. [`made`](Controller::made) does not count
    /// such an event.
    fn wait_ticks(&self) -> Option<u32>;
}
