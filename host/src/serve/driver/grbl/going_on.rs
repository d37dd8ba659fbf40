//! A program that begins at one of its lines: the state there is shown first.

use super::Driver;
use crate::serve::continuation::{Circumstances, Continuation};
use crate::serve::loaded::Loaded;
use crate::serve::reply::Reply;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, TryRecvError, sync_channel};

/// A continuation that is being made, and who has asked for it.
#[derive(Debug)]
pub(super) struct Making {
    made: Receiver<Result<Continuation, String>>,
    program: Arc<Loaded>,
    reply: Reply,
}

impl Driver<'_> {
    /// Tells what a start at this line would do. Nothing moves. The lines before are read in
    /// another thread, because a stop must not wait for them.
    pub(super) fn show_from(&mut self, line: usize, reply: Reply) {
        let asked = self.may_run().and_then(|program| {
            self.has_length(&program, line)?;
            Ok((program, self.circumstances()?))
        });
        let (program, now) = match asked {
            Ok(asked) => asked,
            Err(why) => return reply.error(why),
        };
        let (to, made) = sync_channel(1);
        let making = Making {
            made,
            program: Arc::clone(&program),
            reply,
        };
        std::thread::spawn(move || {
            // If nobody waits any more, nobody needs it.
            let _ = to.send(Continuation::new(&program, line, now));
        });
        if let Some(before) = self.making.replace(making) {
            before.reply.error("another line was asked for");
        }
    }

    /// Answers with a continuation that has been made.
    pub(super) fn take_continuation(&mut self) {
        let Some(making) = self.making.take() else {
            return;
        };
        let present = self.running.course.program();
        let is_loaded = present.is_some_and(|program| Arc::ptr_eq(program, &making.program));
        match making.made.try_recv() {
            _ if !is_loaded => making.reply.error("another program was loaded"),
            Err(TryRecvError::Empty) => self.making = Some(making),
            Err(TryRecvError::Disconnected) => {
                making.reply.error("the lines before cannot be read");
            }
            Ok(Err(why)) => making.reply.error(why),
            Ok(Ok(continuation)) => {
                making.reply.data(continuation.described(&making.program));
                self.running.continuation = Some(continuation);
            }
        }
    }

    /// Forgets a continuation that is being made. Who asked for it gets the reason.
    pub(super) fn forget_making(&mut self, why: &str) {
        if let Some(making) = self.making.take() {
            making.reply.error(why);
        }
    }

    /// Starts the program at a line, exactly as it was shown.
    pub(super) fn go_on(&mut self, line: usize, reply: Reply) {
        let shown = self.may_run().and_then(|program| {
            self.has_length(&program, line)?;
            let now = self.circumstances()?;
            let shown = self.running.continuation.take();
            let shown = shown.filter(|shown| shown.is_shown(line, &now));
            let shown = shown.ok_or(
                "what was shown is not what would happen: the machine has moved, or its modes or \
                 the line differ; look at it again",
            )?;
            Ok((program, shown))
        });
        let (program, shown) = match shown {
            Ok(shown) => shown,
            Err(why) => return reply.error(why),
        };
        let lines = Arc::from(shown.lines(&program));
        let changes_made = changes_before(&program, line);
        self.start(program, lines, shown.before.len(), Some(shown.from));
        self.running.changes_made = changes_made;
        reply.ok();
    }

    /// Whether the length of the tool with which the program has run is still in effect, or the
    /// tool is changed first. Grbl forgets it with a reset.
    fn has_length(&self, program: &Loaded, line: usize) -> Result<(), String> {
        let next = program.lines.iter().find(|(number, _)| *number >= line);
        let change = program.changes.get(changes_before(program, line));
        let is_changed = change
            .zip(next)
            .is_some_and(|(change, (from, _))| change.line <= *from);
        let is_lost = self.running.length_mm != 0.0 && self.state.tool_length_mm == Some(0.0);
        match is_lost && !is_changed {
            true => Err(
                "the controller has forgotten the length of the tool, as a reset makes it \
                         do: measure the tool, then go on"
                    .into(),
            ),
            false => Ok(()),
        }
    }

    /// What the machine is like.
    fn circumstances(&self) -> Result<Circumstances, String> {
        let state = &*self.state;
        let places = state.zero_mm.clone().zip(state.machine_mm.clone());
        let (zero_mm, at_mm) = places.ok_or("the position of the machine is not known")?;
        if self.modes_are_pending() || state.modal.is_empty() {
            return Err("the controller has not reported its modes yet: try again".into());
        }
        let begun_mm = self.running.begun_mm.clone();
        Ok(Circumstances {
            begun_mm: begun_mm.unwrap_or_else(|| at_mm.clone()),
            zero_mm,
            at_mm,
            modal: state.modal.clone(),
            tool: state.tool,
        })
    }
}

/// How many changes of tools are before a line.
fn changes_before(program: &Loaded, line: usize) -> usize {
    program.changes.partition_point(|change| change.line < line)
}
