//! The drill's blocks: to a place, X before Y, and one drilling there.

use crate::block::Block;
use crate::code::{Code, Group};
use crate::commands::{Commands, Plain};
use crate::error::ErrorKind;
use crate::fault::Fault;
use crate::modal::Modal;

/// X and Y.
const BOTH: u16 = 0b11;

impl<const N: usize> Modal<N> {
    /// The last stage of a block in the drill dialect, whose only words are X and Y.
    pub(crate) fn drill(&mut self, block: &Block, commands: &mut Commands<N>) -> Result<(), Fault> {
        let code = block.code(Group::NonModal);
        if code == Some(Code::Shift) {
            return self.set_shift(block);
        }
        let given = block.axes();
        if given == 0 {
            return match code {
                Some(_) => Err(Fault::at_code(ErrorKind::NoAxisWords, Group::NonModal)),
                None => Ok(()),
            };
        }
        let to = self.target(block, self.frame())?;
        if given == BOTH {
            let mut corner = self.modes.position;
            if let (Some(corner), Some(to)) = (corner.first_mut(), to.first()) {
                *corner = *to;
            }
            commands.via(corner);
        }
        self.modes.position = to;
        commands.straight(to, None);
        if code.is_none() {
            commands.finish(Plain::Drill);
        }
        Ok(())
    }
}
