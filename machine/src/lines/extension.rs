//! What a machine keeps for commands beyond plain moves.

use core::fmt::Debug;

use husillo_gcode::{Command, Commands, ErrorKind, Nm};

use crate::lines::state::State;

/// Whether a machine runs the commands that need [`Equipment`](crate::Equipment) and cutter
/// compensation. There are two implementations: `()` for a machine without them, which contains
/// nothing of their code, and [`Extended`](crate::Extended).
pub trait Extension<const N: usize>: Parts<N> {}

impl<const N: usize> Extension<N> for () {}

/// The methods of an [`Extension`], which are those of this crate.
pub trait Parts<const N: usize>: Clone + Debug {
    /// The commands of one block.
    type Commands: Iterator<Item = Command<N>> + Clone + Debug;
    /// The stage before the machine.
    type Stage;
    /// Whether there is a state.
    const IS_EXTENDED: bool;

    /// The state of a new machine.
    fn new() -> Self;
    /// The commands of a block after the stage, and the stage after them.
    fn plan(&self, commands: Commands<N>) -> Result<(Self::Stage, Self::Commands), ErrorKind>;
    /// Replaces the stage.
    fn set_stage(&mut self, stage: Self::Stage);
    /// A stage with nothing in it, at a position.
    fn restart(&mut self, at: [Nm; N]);
    /// The commands that wait in the stage for another block.
    fn finish(&mut self) -> Option<Self::Commands>;
    /// The point that a probe has touched with the axes at `at`, on a move between two ends.
    fn touched(&self, ends: [&[Nm; N]; 2], at: [Nm; N]) -> [Nm; N];
    /// The state.
    fn state(&self) -> Option<&State<N>>;
    /// The state.
    fn state_mut(&mut self) -> Option<&mut State<N>>;
}

impl<const N: usize> Parts<N> for () {
    type Commands = Commands<N>;
    type Stage = ();
    const IS_EXTENDED: bool = false;

    fn new() -> Self {}

    fn plan(&self, commands: Commands<N>) -> Result<((), Commands<N>), ErrorKind> {
        Ok(((), commands))
    }

    fn set_stage(&mut self, (): ()) {}

    fn restart(&mut self, _: [Nm; N]) {}

    fn finish(&mut self) -> Option<Commands<N>> {
        None
    }

    fn touched(&self, _: [&[Nm; N]; 2], at: [Nm; N]) -> [Nm; N] {
        at
    }

    fn state(&self) -> Option<&State<N>> {
        None
    }

    fn state_mut(&mut self) -> Option<&mut State<N>> {
        None
    }
}
