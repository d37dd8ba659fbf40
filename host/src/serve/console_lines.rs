//! The lines that a machine has sent and received, for the console of the pages.

use serde::Serialize;
use std::collections::VecDeque;
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::Instant;

/// Lines that are kept.
const KEPT: usize = 2000;
/// Lines in one frame.
const IN_A_FRAME: usize = 500;

/// Who has written a line.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum From {
    /// A line to the controller.
    Host,
    /// A line of the controller.
    Controller,
    /// What this program has to say.
    Server,
}

/// One line.
#[derive(Clone, Debug, Serialize)]
pub struct Line {
    /// Its number, from 1.
    pub number: u64,
    /// Time since the server started, ms.
    pub at_ms: u64,
    /// Who has written it.
    pub from: From,
    /// The text.
    pub text: String,
}

/// The last lines of a machine.
#[derive(Debug)]
pub struct ConsoleLines {
    start: Instant,
    lines: Mutex<VecDeque<Line>>,
}

/// Lines for a client.
#[derive(Debug, Serialize)]
pub struct Lines {
    /// Lines that are no longer kept.
    pub missed: u64,
    /// The lines.
    pub lines: Vec<Line>,
}

impl ConsoleLines {
    /// No lines.
    pub fn new() -> Self {
        Self {
            start: Instant::now(),
            lines: Mutex::new(VecDeque::new()),
        }
    }

    /// Appends a line. The oldest one is dropped if there are too many.
    pub fn push(&self, from: From, text: impl Into<String>) {
        let mut lines = self.lines();
        let number = lines.back().map_or(0, |last| last.number) + 1;
        if lines.len() == KEPT {
            lines.pop_front();
        }
        lines.push_back(Line {
            number,
            at_ms: u64::try_from(self.start.elapsed().as_millis()).unwrap_or(u64::MAX),
            from,
            text: text.into(),
        });
    }

    /// Lines after number `seen`, as many as a frame has. `None`: there are none.
    pub fn after(&self, seen: u64) -> Option<Lines> {
        let lines = self.lines();
        let first = lines.front()?.number;
        let missed = first.saturating_sub(seen + 1);
        let skipped = usize::try_from((seen + 1).saturating_sub(first)).unwrap_or(usize::MAX);
        let lines: Vec<_> = lines
            .iter()
            .skip(skipped)
            .take(IN_A_FRAME)
            .cloned()
            .collect();
        (!lines.is_empty()).then_some(Lines { missed, lines })
    }

    fn lines(&self) -> MutexGuard<'_, VecDeque<Line>> {
        self.lines.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_client_gets_the_lines_it_has_not_seen() {
        let console = ConsoleLines::new();
        assert!(console.after(0).is_none());
        (0..2100).for_each(|number| console.push(From::Host, format!("{number}")));
        let some = console.after(0).unwrap();
        assert_eq!((some.missed, some.lines.len()), (100, 500));
        assert_eq!(
            (some.lines[0].number, &some.lines[0].text[..]),
            (101, "100")
        );
        let some = console.after(2090).unwrap();
        assert_eq!((some.missed, some.lines.len()), (0, 10));
        assert!(console.after(2100).is_none());
    }
}
