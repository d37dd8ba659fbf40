//! Blocks of the drill: move to a position, X before Y, and drill there.

use crate::blocks::block::Block;
use crate::blocks::fault::{Fault, Reason};
use crate::codes::code::{Code, Group};
use crate::modal::Modal;
use crate::modal::commands::Commands;

/// X and Y.
const BOTH: u16 = 0b11;

impl<const N: usize> Modal<N> {
    /// The last stage of a block in the drill dialect, whose only words are X and Y.
    #[inline(never)]
    pub(crate) fn drill(&mut self, block: &Block, commands: &mut Commands<N>) -> Result<(), Fault> {
        let code = block.code(Group::NonModal);
        if code == Some(Code::Shift) {
            return self.set_shift(block, commands);
        }
        let given = block.axes();
        if given == 0 {
            return match code {
                Some(_) => Err(Fault::at_code(Reason::NoAxisWords, Group::NonModal)),
                None => Ok(()),
            };
        }
        self.aim(block, self.terms(), commands)?;
        if given == BOTH {
            // X first: the other axes stay.
            commands.via = self.modes.position;
            if let (Some(corner), Some(to)) = (commands.via.first_mut(), commands.arc.to.first()) {
                *corner = *to;
            }
            commands.go_via();
        }
        self.go(Code::Rapid, commands);
        if code.is_none() {
            commands.finish(None);
        }
        Ok(())
    }
}
