//! A controller of one or two machines with its link.

use husillo_transports::microfactory::{Device, Order, REJECTED, Report};

use super::{Microfactory, MicrofactoryConfig, MicrofactoryEvent, MicrofactoryInputs};
use crate::controller::{Controller, Timed};
use crate::ring::Ring;

/// Size of the queue of the transmitter in bytes: an answer with a status.
const OUT: usize = 64;

/// A figure in memory: at most `MOVES` moves in X and Z, in steps. While a figure is being
/// received, the stored figure is empty.
#[derive(Copy, Clone, Debug)]
struct Figure<const MOVES: usize> {
    moves: [[i16; 2]; MOVES],
    /// At most `MOVES`.
    count: usize,
    is_whole: bool,
}

impl<const MOVES: usize> Figure<MOVES> {
    const NONE: Self = Self {
        moves: [[0; 2]; MOVES],
        count: 0,
        is_whole: false,
    };

    fn clear(&mut self) {
        (self.count, self.is_whole) = (0, false);
    }

    /// Adds a move. Returns `false` if there is no room.
    fn push(&mut self, move_steps: [i16; 2]) -> bool {
        let Some(slot) = self.moves.get_mut(self.count) else {
            return false;
        };
        *slot = move_steps;
        self.count = self.count.wrapping_add(1); // it is at most `MOVES`
        true
    }
}

impl<const MOVES: usize> AsRef<[[i16; 2]]> for Figure<MOVES> {
    fn as_ref(&self) -> &[[i16; 2]] {
        let moves = self.moves.get(..self.count).filter(|_| self.is_whole);
        moves.unwrap_or_default()
    }
}

/// The controller of a microfactory with its link: bytes in, events and bytes out.
///
/// It drives one or two machines. The original controller has 20 to 24 lines for each. Each machine
/// has its own motors, switches, figure and time. With two machines the link selects one
/// ([`Device::of_two_machines`]), and a command applies to the selected one. Both may move at the
/// same time. An emergency stop and a reset apply to both.
///
/// A host may request a lease ([`Order::Lease`]). A motion of any kind then ends when no byte has
/// arrived for that time. Every byte renews the lease.
///
/// If the queue has no room for an answer, the answer is lost, and the host asks again.
///
/// # Cost
/// The size is 4 bytes for each of `MOVES` moves and 0.2 kB per machine, plus 0.1 kB.
///
/// # Examples
///
/// ```
/// use husillo_controllers::{
///     Controller, MicrofactoryConfig, MicrofactoryEvent, MicrofactoryInputs, MicrofactoryStation,
/// };
/// use husillo_transports::microfactory::{ByteTable, Device, Order};
///
/// let link = Device::new(ByteTable::DEFAULT).of_two_machines();
/// let mut station = MicrofactoryStation::<100, 2>::new(link, MicrofactoryConfig::ORIGINAL);
/// assert!(station.store(0, &[[100, 50]]));
/// for machine in [0, 1] {
///     assert!(station.command(machine, Order::Jog { motor: 3, forward: true }));
/// }
/// assert!(station.command(0, Order::Emergency));
/// assert!(!station.is_moving(1));
/// let event = station.next_event(1, &MicrofactoryInputs::default());
/// assert!(matches!(event, Some(MicrofactoryEvent::Report(_))));
/// ```
#[derive(Clone, Debug)]
pub struct MicrofactoryStation<const MOVES: usize, const MACHINES: usize = 1> {
    link: Device,
    machines: [Microfactory<Figure<MOVES>>; MACHINES],
    out: Ring<u8, OUT>,
    /// Longest permitted silence of the line during a motion, in units of 10 ms. 0: no limit.
    lease: u8,
}

impl<const MOVES: usize, const MACHINES: usize> MicrofactoryStation<MOVES, MACHINES> {
    /// Creates machines of one kind, at rest, with the motors off, not homed, without a figure.
    pub fn new(link: Device, config: MicrofactoryConfig) -> Self {
        Self {
            link,
            machines: [const { Figure::NONE }; MACHINES]
                .map(|figure| Microfactory::new(config, figure)),
            out: Ring::new(0),
            lease: 0,
        }
    }

    /// Stores a figure, as the link does. Returns `false` if it has too many moves, if a figure is
    /// being cut, or if the machine does not exist.
    pub fn store(&mut self, machine: u8, moves: &[[i16; 2]]) -> bool {
        let figure = self.machine_mut(machine).and_then(Microfactory::figure_mut);
        let Some(figure) = figure.filter(|_| moves.len() <= MOVES) else {
            return false;
        };
        figure.clear();
        figure.is_whole = moves.iter().all(|move_steps| figure.push(*move_steps));
        figure.is_whole
    }

    /// Takes a command for a machine, 0 or 1. Returns whether it is carried out: see
    /// [`Microfactory::command`]. [`Order::Emergency`] stops all machines.
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

    /// Whether a task of a machine is running.
    pub fn is_moving(&self, machine: u8) -> bool {
        self.machine(machine).is_some_and(Microfactory::is_moving)
    }

    /// Returns a machine, 0 or 1.
    pub fn machine(
        &self,
        machine: u8,
    ) -> Option<&Microfactory<impl AsRef<[[i16; 2]]> + use<MOVES, MACHINES>>> {
        self.machines.get(usize::from(machine))
    }

    fn machine_mut(&mut self, machine: u8) -> Option<&mut Microfactory<Figure<MOVES>>> {
        self.machines.get_mut(usize::from(machine))
    }

    /// Carries out commands without motion. These concern the figure of a machine or the lease, or
    /// request a report.
    fn keep(&mut self, machine: u8, command: Order) {
        if let Order::Lease(time) = command {
            self.lease = time;
            return;
        }
        let Some(machine) = self.machine_mut(machine) else {
            return;
        };
        if command == Order::Ask {
            let status = machine.status();
            return self.answer(&status.bytes());
        }
        if command == Order::Switches {
            let switches = machine.switches();
            return self.answer(&switches.bytes());
        }
        // Nothing moves while a figure is received, so the figure is available. The link counts its
        // moves.
        let Some(figure) = machine.figure_mut() else {
            return;
        };
        match command {
            Order::Clear => figure.clear(),
            Order::Line(move_steps) => {
                figure.push(move_steps);
            }
            Order::Keep => figure.is_whole = true,
            // The other commands were already begun or refused.
            _ => {}
        }
    }

    fn answer(&mut self, bytes: &[u8]) {
        for byte in bytes {
            self.out.push(*byte);
        }
    }
}

impl<const MOVES: usize, const MACHINES: usize> Controller
    for MicrofactoryStation<MOVES, MACHINES>
{
    type Inputs = MicrofactoryInputs;
    type Event = MicrofactoryEvent;
    type Stops = ();

    fn machines(&self) -> u8 {
        MACHINES as u8
    }

    /// Takes a byte from the line. If it stops the motion, a step that was already given is the
    /// last one.
    fn receive(&mut self, byte: u8) -> bool {
        let is_moving = self.is_moving(self.link.machine());
        let received = self.link.receive(byte, is_moving);
        let machine = self.link.machine();
        let is_taken = match received.command {
            Some(command) if command.is_a_motion() => self.command(machine, command),
            _ => true,
        };
        if let Some(reply) = received.reply {
            self.answer(&[if is_taken { reply } else { REJECTED }]);
        }
        if let Some(command) = received.command {
            self.keep(machine, command);
        }
        false
    }

    fn stops(&self) {}

    fn lease_us(&self) -> Option<u32> {
        let moves = self.machines.iter().any(Microfactory::is_moving);
        let is_held = moves && self.lease > 0;
        // At most 2.55 s.
        is_held.then_some(u32::from(self.lease).wrapping_mul(10_000))
    }

    /// Ends the motion of every machine. A step that was already given is the last one.
    fn expire(&mut self) -> bool {
        for machine in &mut self.machines {
            machine.expire();
        }
        self.link.leave_mode();
        false
    }

    fn next_event(
        &mut self,
        machine: u8,
        inputs: &MicrofactoryInputs,
    ) -> Option<MicrofactoryEvent> {
        let event = self.machine_mut(machine)?.next_event(inputs);
        let is_switch = matches!(event, MicrofactoryEvent::Report(Report::Switch { .. }));
        if is_switch && self.link.machine() == machine {
            self.link.leave_mode();
        }
        (event != MicrofactoryEvent::Idle).then_some(event)
    }

    fn transmit(&mut self) -> Option<u8> {
        self.out.pop()
    }

    fn reset(&mut self) {
        for machine in &mut self.machines {
            machine.reset();
        }
        self.link.reset();
        self.lease = 0;
    }
}

impl Timed for MicrofactoryEvent {
    fn wait_ticks(&self) -> Option<u32> {
        match *self {
            MicrofactoryEvent::Step(step) => Some(step.wait_ticks),
            // Another task follows at once. Its waits continue from the end of this one.
            MicrofactoryEvent::Dwell { wait_ticks: 0 } => None,
            MicrofactoryEvent::Dwell { wait_ticks } => Some(wait_ticks),
            MicrofactoryEvent::Reset { ticks } => Some(ticks),
            // The current takes effect now: later waits count from here.
            MicrofactoryEvent::Enable(on) => on.then_some(0),
            MicrofactoryEvent::Report(_) | MicrofactoryEvent::Idle => None,
        }
    }
}
