//! M70 to M73: the modes of a subroutine's caller are saved and restored.

use super::{Program, Raw};
use crate::blocks::block::Block;
use crate::error::parameters::Fault;
use crate::modal::saved::SavedModes;

/// Number of subroutines that may have saved modes at the same time.
const SAVED: usize = 6;

/// The modes that a subroutine has saved.
#[derive(Copy, Clone, Debug)]
struct Entry {
    /// Number of running calls, those of the subroutine included.
    level: usize,
    modes: SavedModes,
    /// M73: they are restored at the end of the subroutine.
    at_end: bool,
}

/// Saved modes, and the restoring in progress.
#[derive(Clone, Debug)]
pub(super) struct Saved<'t> {
    entries: [Option<Entry>; SAVED],
    /// The modes that are being restored, the number of the next block, and the line.
    restoring: Option<(SavedModes, u8, Raw<'t>)>,
}

impl<'t> Saved<'t> {
    pub(super) const NONE: Saved<'t> = Saved {
        entries: [None; SAVED],
        restoring: None,
    };

    fn entry(&mut self, level: usize) -> Option<&mut Option<Entry>> {
        let mut entries = self.entries.iter_mut();
        entries.find(|entry| entry.is_some_and(|entry| entry.level == level))
    }

    /// M70 and M73.
    pub(super) fn save(
        &mut self,
        level: usize,
        modes: Option<SavedModes>,
        at_end: bool,
    ) -> Result<(), Fault> {
        let modes = modes.ok_or(Fault::NothingSaved)?;
        self.forget(level);
        let slot = self.entries.iter_mut().find(|entry| entry.is_none());
        *slot.ok_or(Fault::TooDeep)? = Some(Entry {
            level,
            modes,
            at_end,
        });
        Ok(())
    }

    /// M71.
    pub(super) fn forget(&mut self, level: usize) {
        if let Some(entry) = self.entry(level) {
            *entry = None;
        }
    }

    /// M72: the blocks that restore the modes come before the next line.
    pub(super) fn restore(&mut self, level: usize, raw: &Raw<'t>) -> Result<(), Fault> {
        let entry = self.entry(level).and_then(|entry| *entry);
        self.restoring = Some((entry.ok_or(Fault::NothingSaved)?.modes, 0, *raw));
        Ok(())
    }

    /// The end of a subroutine.
    pub(super) fn end(&mut self, level: usize, raw: &Raw<'t>) {
        let entry = self.entry(level).and_then(Option::take);
        if let Some(entry) = entry.filter(|entry| entry.at_end) {
            self.restoring = Some((entry.modes, 0, *raw));
        }
    }

    /// The next block that restores modes, with the line that it belongs to.
    pub(super) fn next(&mut self, now: Option<SavedModes>) -> Option<(Raw<'t>, Block)> {
        let (modes, number, raw) = self.restoring.as_mut()?;
        let block = now.and_then(|now| modes.restoring(*number, &now));
        *number = number.wrapping_add(1); // at most four
        let given = block.map(|block| (*raw, block));
        if given.is_none() {
            self.restoring = None;
        }
        given
    }
}

impl<'t, const GLOBALS: usize, const LOCALS: usize, const DEPTH: usize, const FILES: usize>
    Program<'t, GLOBALS, LOCALS, DEPTH, FILES>
{
    /// The next block that restores modes; blocks without effect are left out.
    pub(super) fn restored(&mut self, now: Option<SavedModes>) -> Option<(Raw<'t>, Block)> {
        loop {
            let (raw, block) = self.saved.next(now)?;
            if !block.is_empty() {
                return Some((raw, block));
            }
        }
    }
}
