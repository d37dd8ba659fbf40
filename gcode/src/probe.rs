//! Probing: G38.2 to G38.5.

use crate::block::Block;
use crate::code::Group;
use crate::command::Command;
use crate::commands::Commands;
use crate::dialect::Flavour;
use crate::error::{Error, ErrorKind};
use crate::modal::{FeedMode, Modal};

impl<const N: usize> Modal<N> {
    /// G38.2 to G38.5.
    pub(crate) fn probe(
        &mut self,
        block: &Block,
        away: bool,
        must: bool,
        commands: &mut Commands<N>,
    ) -> Result<(), Error> {
        if block.axes() == 0 {
            return Err(block.error_at_code(ErrorKind::NoAxisWords, Group::Motion));
        }
        let to = self.target(block, self.frame())?;
        if to == self.position {
            return Err(block.error_at_axes(ErrorKind::NoProbeMove));
        }
        if self.feed_mode != FeedMode::PerMinute && self.dialect.flavour != Flavour::Grbl {
            return Err(block.error_at_motion(ErrorKind::WrongFeedMode));
        }
        let feed = self.feed_of(block)?;
        self.position = to;
        commands.motion(Command::Probe {
            to,
            feed,
            away,
            must,
        });
        Ok(())
    }
}
