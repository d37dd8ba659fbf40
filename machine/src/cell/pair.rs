//! Two machines of four motors, one controller.

use husillo_transports::byte_commands::ByteCommand;

use super::{Cell, CellConfig, CellEvent, CellInputs};

/// How many machines a controller drives.
pub const PAIR: usize = 2;

/// A controller of two microfactories: every machine has its own motors, switches, lines, figure and time.
///
/// The original's controller drives two machines of 20 to 24 lines each, and nobody says how they are told apart; here the link names one
/// (`ByteCommands::machine`), and a command is for that one. Both may move at once. An emergency stop, and a reset, are for both.
///
/// ```
/// use husillo_machine::{CellConfig, CellEvent, CellInputs, CellPair};
/// use husillo_transports::byte_commands::ByteCommand;
///
/// let mut pair = CellPair::new(CellConfig::ORIGINAL, [[[5, 0]], [[0, 5]]]);
/// for machine in [0, 1] {
///     assert!(pair.command(machine, ByteCommand::Jog { motor: 3, forward: true }));
/// }
/// assert!(pair.command(0, ByteCommand::Emergency));
/// assert!(!pair.is_moving(1));
/// // Each has a timer of its own.
/// assert!(matches!(pair.next_event(1, &CellInputs::default()), CellEvent::Report(_)));
/// ```
#[derive(Clone, Debug)]
pub struct CellPair<F> {
    cells: [Cell<F>; PAIR],
}

impl<F: AsRef<[[i16; 2]]>> CellPair<F> {
    /// Both at rest, motors off, not homed; machines of one kind, a figure each.
    pub fn new(config: CellConfig, figures: [F; PAIR]) -> Self {
        Self {
            cells: figures.map(|figure| Cell::new(config, figure)),
        }
    }

    /// A command for a machine, 0 or 1: whether it is carried out, see [`Cell::command`]. [`ByteCommand::Emergency`] stops both.
    pub fn command(&mut self, machine: u8, command: ByteCommand) -> bool {
        if command == ByteCommand::Emergency {
            let mut is_taken = false;
            for cell in &mut self.cells {
                is_taken |= cell.command(command);
            }
            return is_taken;
        }
        let cell = self.cell_mut(machine);
        cell.is_some_and(|cell| cell.command(command))
    }

    /// What happens next at a machine, with its switches as they are now; [`CellEvent::Idle`] of one that is not there. Waits count from
    /// the last event of the same machine.
    pub fn next_event(&mut self, machine: u8, inputs: &CellInputs) -> CellEvent {
        let cell = self.cell_mut(machine);
        cell.map_or(CellEvent::Idle, |cell| cell.next_event(inputs))
    }

    /// Whether a task is under way at a machine.
    pub fn is_moving(&self, machine: u8) -> bool {
        self.cell(machine).is_some_and(Cell::is_moving)
    }

    /// What a panel's reset or power up does, at both.
    pub fn reset(&mut self) {
        for cell in &mut self.cells {
            cell.reset();
        }
    }

    /// A machine, 0 or 1.
    pub fn cell(&self, machine: u8) -> Option<&Cell<F>> {
        self.cells.get(usize::from(machine))
    }

    /// The same, to be changed.
    pub fn cell_mut(&mut self, machine: u8) -> Option<&mut Cell<F>> {
        self.cells.get_mut(usize::from(machine))
    }
}
