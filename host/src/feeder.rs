//! Lines of a checked program into the machine, its events out to whoever wants them.

use crate::source::Source;
use husillo_machine::{Event, Machine, Pause};
use std::io;
use std::ops::ControlFlow;

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
            // As far ahead as the queue goes, then events until a place is free.
            while !machine.has_room() {
                if pull(machine, &mut each)?.is_break() {
                    return Ok(());
                }
            }
            machine
                .line(text)
                .map_err(|refused| io::Error::other(format!("line {}: {refused}", line.number)))?;
        }
    }
    while pull(machine, &mut each)?.is_continue() {}
    Ok(())
}

/// One event; a break at the end of the program, and when there is none.
#[inline]
fn pull(
    machine: &mut Machine<3>,
    each: &mut impl FnMut(&Machine<3>, &Event<3>) -> io::Result<()>,
) -> io::Result<ControlFlow<()>> {
    // By reference: moving the event would read whole what was just written in parts, and wait for it.
    let Some(ref event) = machine.next_event() else {
        return Ok(ControlFlow::Break(()));
    };
    each(machine, event)?;
    Ok(match event {
        Event::Pause(Pause::End { .. }) => ControlFlow::Break(()),
        _ => ControlFlow::Continue(()),
    })
}
