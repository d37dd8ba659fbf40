//! Two machines of four motors, one controller.

use husillo_transports::microfactory::Order;

use super::{Microfactory, MicrofactoryConfig, MicrofactoryEvent, MicrofactoryInputs};

/// How many machines a controller drives.
pub const PAIR: usize = 2;

/// A controller of two microfactories: every machine has its own motors, switches, lines, figure and time.
///
/// The original's controller drives two machines of 20 to 24 lines each, and nobody says how they are told apart; here the link names one
/// (`Device::machine`), and a command is for that one. Both may move at once. An emergency stop, and a reset, are for both.
///
/// ```
/// use husillo_controllers::{MicrofactoryConfig, MicrofactoryEvent, MicrofactoryInputs, MicrofactoryPair};
/// use husillo_transports::microfactory::Order;
///
/// let mut pair = MicrofactoryPair::new(MicrofactoryConfig::ORIGINAL, [[[5, 0]], [[0, 5]]]);
/// for machine in [0, 1] {
///     assert!(pair.command(machine, Order::Jog { motor: 3, forward: true }));
/// }
/// assert!(pair.command(0, Order::Emergency));
/// assert!(!pair.is_moving(1));
/// // Each has a timer of its own.
/// assert!(matches!(pair.next_event(1, &MicrofactoryInputs::default()), MicrofactoryEvent::Report(_)));
/// ```
#[derive(Clone, Debug)]
pub struct MicrofactoryPair<F> {
    machines: [Microfactory<F>; PAIR],
}

impl<F: AsRef<[[i16; 2]]>> MicrofactoryPair<F> {
    /// Both at rest, motors off, not homed; machines of one kind, a figure each.
    pub fn new(config: MicrofactoryConfig, figures: [F; PAIR]) -> Self {
        Self {
            machines: figures.map(|figure| Microfactory::new(config, figure)),
        }
    }

    /// A command for a machine, 0 or 1: whether it is carried out, see [`Microfactory::command`]. [`Order::Emergency`] stops both.
    pub fn command(&mut self, machine: u8, command: Order) -> bool {
        if command == Order::Emergency {
            let mut is_taken = false;
            for machine in &mut self.machines {
                is_taken |= machine.command(command);
            }
            return is_taken;
        }
        let machine = self.machine_mut(machine);
        machine.is_some_and(|machine| machine.command(command))
    }

    /// What happens next at a machine, with its switches as they are now; [`MicrofactoryEvent::Idle`] of one that is not there. Waits count from
    /// the last event of the same machine.
    pub fn next_event(&mut self, machine: u8, inputs: &MicrofactoryInputs) -> MicrofactoryEvent {
        let machine = self.machine_mut(machine);
        machine.map_or(MicrofactoryEvent::Idle, |machine| {
            machine.next_event(inputs)
        })
    }

    /// Whether a task is under way at a machine.
    pub fn is_moving(&self, machine: u8) -> bool {
        self.machine(machine).is_some_and(Microfactory::is_moving)
    }

    /// What a panel's reset or power up does, at both.
    pub fn reset(&mut self) {
        for machine in &mut self.machines {
            machine.reset();
        }
    }

    /// A machine, 0 or 1.
    pub fn machine(&self, machine: u8) -> Option<&Microfactory<F>> {
        self.machines.get(usize::from(machine))
    }

    /// The same, to be changed.
    pub fn machine_mut(&mut self, machine: u8) -> Option<&mut Microfactory<F>> {
        self.machines.get_mut(usize::from(machine))
    }
}
