//! The entries of a run as columns, in batches of bounded size.

use crate::programs::origins::Lines;
use husillo_machine::Origin;
use husillo_sim::observers::{AXES, Begun, Now, Observer};
use std::fmt;
use std::io;

/// The kind of an entry.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Kind {
    /// A wait without a step.
    Wait = 0,
    /// A step of a feed.
    Feed = 1,
    /// A step of a rapid.
    Rapid = 2,
    /// A step that takes up backlash: the tool stands still.
    TakeUp = 3,
    /// Another step.
    Other = 4,
}

impl From<Origin> for Kind {
    fn from(origin: Origin) -> Self {
        match origin {
            Origin::Feed => Self::Feed,
            Origin::Rapid => Self::Rapid,
            Origin::TakeUp => Self::TakeUp,
            Origin::Rest => Self::Other,
        }
    }
}

/// Entries of a run: step events, and waits without a step. The columns with values of all axes
/// have those of the first entry, then those of the second.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Columns {
    /// Ticks between the entry before and this one.
    pub wait_ticks: Vec<u32>,
    /// Its [`Kind`] as a number.
    pub kind: Vec<u8>,
    /// The line of its move, from 1; 0 where it is not known, as in
    /// [`Origins::lines`](crate::programs::origins::Origins::lines), and for waits.
    pub line: Vec<u32>,
    /// Step of each axis, -1, 0 or 1.
    pub delta: Vec<i8>,
    /// Position of the controller after it, steps of each axis.
    pub commanded: Vec<i32>,
    /// Position of the tool after it, steps of each axis.
    pub tool: Vec<i32>,
}

impl Columns {
    /// Number of entries.
    pub const fn len(&self) -> usize {
        self.wait_ticks.len()
    }

    /// Whether there is no entry.
    pub const fn is_empty(&self) -> bool {
        self.wait_ticks.is_empty()
    }
}

/// Collects the entries of a run, and passes each batch of `size` on: the last one has fewer.
pub struct Batches<F> {
    axes: usize,
    size: usize,
    lines: Lines,
    line: u32,
    ticks: u64,
    commanded: [i32; AXES],
    tool: [i32; AXES],
    batch: Columns,
    pass: F,
    /// A batch that ended with a wait could not be passed on.
    failed: Option<io::Error>,
}

impl<F: FnMut(Columns) -> io::Result<()>> Batches<F> {
    /// Batches of a machine with this number of axes, whose tool is at `start`. `pass` gets them.
    /// A run ends where it fails.
    pub fn new(axes: usize, size: usize, start: [i32; AXES], lines: Lines, pass: F) -> Self {
        Self {
            axes: axes.min(AXES),
            size: size.max(1),
            lines,
            line: 0,
            ticks: 0,
            commanded: start,
            tool: start,
            batch: Columns::default(),
            pass,
            failed: None,
        }
    }

    #[inline]
    fn push(&mut self, ticks: u64, kind: Kind, line: u32, delta: &[i8; AXES]) -> io::Result<()> {
        let wait = ticks.saturating_sub(self.ticks);
        self.ticks = ticks;
        let batch = &mut self.batch;
        batch
            .wait_ticks
            .push(u32::try_from(wait).unwrap_or(u32::MAX));
        batch.kind.push(kind as u8);
        batch.line.push(line);
        batch.delta.extend_from_slice(&delta[..self.axes]);
        batch
            .commanded
            .extend_from_slice(&self.commanded[..self.axes]);
        batch.tool.extend_from_slice(&self.tool[..self.axes]);
        if batch.len() < self.size {
            return Ok(());
        }
        (self.pass)(std::mem::take(batch))
    }
}

impl<F: FnMut(Columns) -> io::Result<()>> Observer for Batches<F> {
    fn begin(&mut self, begun: &Begun<'_>) {
        self.line = self.lines.line(&begun.to);
    }

    fn step(&mut self, now: &Now<'_>) -> io::Result<()> {
        if let Some(error) = self.failed.take() {
            return Err(error);
        }
        self.commanded = now.sent;
        self.tool = now.tool;
        self.push(now.ticks, now.origin.into(), self.line, &now.step.delta)
    }

    fn dwell(&mut self, ticks: u64) {
        if self.failed.is_none() {
            self.failed = self.push(ticks, Kind::Wait, 0, &[0; AXES]).err();
        }
    }

    fn finish(&mut self) -> io::Result<()> {
        if let Some(error) = self.failed.take() {
            return Err(error);
        }
        match self.batch.is_empty() {
            true => Ok(()),
            false => (self.pass)(std::mem::take(&mut self.batch)),
        }
    }
}

impl<F> fmt::Debug for Batches<F> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Batches")
            .field("size", &self.size)
            .field("batch", &self.batch.len())
            .finish_non_exhaustive()
    }
}

#[cfg(test)]
mod tests;
