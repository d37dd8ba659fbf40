//! Probing: G38.2 to G38.5.

use crate::block::Block;
use crate::code::Group;
use crate::command::Command;
use crate::commands::Commands;
use crate::dialect::Flavour;
use crate::error::ErrorKind;
use crate::fault::Fault;
use crate::modal::{FeedMode, Modal};

impl<const N: usize> Modal<N> {
    /// G38.2 to G38.5.
    #[inline(never)]
    pub(crate) fn probe(
        &mut self,
        block: &Block,
        away: bool,
        must: bool,
        commands: &mut Commands<N>,
    ) -> Result<(), Fault> {
        if block.axes() == 0 {
            return Err(Fault::at_code(ErrorKind::NoAxisWords, Group::Motion));
        }
        let to = self.target(block, self.frame())?;
        if to == self.modes.position {
            return Err(Fault::at_axes(ErrorKind::NoProbeMove));
        }
        if self.modes.feed_mode != FeedMode::PerMinute && self.dialect.flavour != Flavour::Grbl {
            return Err(Fault::at_motion(ErrorKind::WrongFeedMode));
        }
        let feed = self.feed_of()?;
        self.modes.position = to;
        commands.motion(Command::Probe {
            to,
            feed,
            away,
            must,
        });
        Ok(())
    }
}
