//! Lines of a checked program into the machine, its events out to whoever wants them.

use crate::source::Source;
use husillo_machine::{Event, Machine, Pause, Refused};
use std::io;

/// Runs a program to its end; `each` gets the machine and every event it gives.
///
/// # Errors
///
/// Reading or writing fails, or the machine refuses a line: a check before makes sure that it does not.
pub fn feed(
    source: &mut Source,
    machine: &mut Machine<3>,
    mut each: impl FnMut(&Machine<3>, &Event<3>) -> io::Result<()>,
) -> io::Result<()> {
    let dialect = machine.config().dialect;
    while let Some(line) = source.next_line()? {
        for (_, text) in dialect.blocks(line.bytes) {
            loop {
                let taken = machine.line(text);
                // By reference: moving the event would read whole what was just written in parts, and wait for it.
                while let Some(ref event) = machine.next_event() {
                    each(machine, event)?;
                    if matches!(event, Event::Pause(Pause::End { .. })) {
                        return Ok(());
                    }
                }
                match taken {
                    Ok(()) => break,
                    // All events are out now: the same line once more.
                    Err(Refused::Busy) => {}
                    Err(refused) => {
                        return Err(io::Error::other(format!("line {}: {refused}", line.number)));
                    }
                }
            }
        }
    }
    Ok(())
}
