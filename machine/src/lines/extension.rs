//! What a machine keeps for commands beyond plain moves.

use core::fmt::Debug;

use husillo_gcode::{Block, Command, Commands, Error, Modal, Nm};

use crate::lines::kept::{Compact, Kept};
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
    /// The stage before the machine as a block leaves it, and what takes the block back.
    type Stage;
    /// A move as its place in the queue keeps it.
    type Kept: Kept<N>;
    /// Whether there is a state.
    const IS_EXTENDED: bool;

    /// The state of a new machine.
    fn new() -> Self;
    /// No commands.
    fn nothing() -> Self::Commands;
    /// Applies a block to the modal state. Writes its commands after the stage to `to`, where all
    /// commands have been taken. After an error the modal state is unchanged.
    fn apply(
        &self,
        block: &Block,
        modal: &mut Modal<N>,
        to: &mut Self::Commands,
    ) -> Result<Self::Stage, Error>;
    /// Takes the block back, of which no command has been taken.
    fn revert(stage: Self::Stage, modal: &mut Modal<N>, commands: &mut Self::Commands);
    /// The commands, without taking them.
    fn pending(commands: &Self::Commands) -> impl Iterator<Item = Command<N>>;
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
    type Kept = Compact<N>;
    const IS_EXTENDED: bool = false;

    fn new() -> Self {}

    fn nothing() -> Commands<N> {
        Commands::new()
    }

    #[inline]
    fn apply(
        &self,
        block: &Block,
        modal: &mut Modal<N>,
        to: &mut Commands<N>,
    ) -> Result<(), Error> {
        modal.apply(block, to)
    }

    fn revert((): (), modal: &mut Modal<N>, commands: &mut Commands<N>) {
        modal.revert(commands);
    }

    #[inline]
    fn pending(commands: &Commands<N>) -> impl Iterator<Item = Command<N>> {
        commands.pending()
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
