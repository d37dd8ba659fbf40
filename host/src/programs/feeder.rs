//! Feeds the lines of a checked program to the machine, and passes its events on.

use crate::programs::blocks;
use crate::programs::setup::ClosedMicromill;
use crate::programs::source::Source;
use crate::programs::spindle_time::Turning;
use husillo_backlash::Lash;
use husillo_interp::Path;
use husillo_machine::{Event, Followed, Machine, Pause, Refused};
use husillo_sim::observers::AXES;
use std::io;
use std::ops::ControlFlow;

/// Runs a program to its end. `each` gets the machine and each of its events.
///
/// # Errors
///
/// Reading or writing fails, or the machine refuses a line. It refuses no line of a program that
/// was checked before.
pub fn feed<L: Lash<AXES>>(
    source: &mut Source,
    machine: &mut Machine<AXES, Path<AXES>, L>,
    mut each: impl FnMut(&Machine<AXES, Path<AXES>, L>, &Event<AXES>) -> io::Result<()>,
) -> io::Result<()> {
    let config = machine.config();
    let dialect = config.dialect;
    let mut turning = config
        .spindle_counts
        .map(|counts| Turning::new(counts, config.timer_hz));
    let mut each = |machine: &Machine<AXES, Path<AXES>, L>, event: &Event<AXES>| match &mut turning
    {
        None => each(machine, event),
        Some(turning) => each(machine, &turning.timed(event)?),
    };
    let mut ended = false;
    blocks::each_block(
        source,
        dialect,
        machine,
        |machine| machine.modal(),
        |machine, given, block| {
            // Fills the queue, then takes events until a slot is free.
            while !machine.has_room() {
                if pull(machine, &mut each)? == Pulled::End {
                    ended = true;
                    return Ok(ControlFlow::Break(()));
                }
            }
            block
                .map_err(Refused::from)
                .and_then(|block| machine.block(&block))
                .map_err(|refused| io::Error::other(format!("line {}: {refused}", given.number)))?;
            // Any text may follow the end of a program.
            Ok(if machine.has_ended() {
                ControlFlow::Break(())
            } else {
                ControlFlow::Continue(())
            })
        },
    )?;
    if ended {
        return Ok(());
    }
    while pull(machine, &mut each)? == Pulled::Event {}
    Ok(())
}

/// Runs a program on a machine with encoders, to its end or until the machine stops. `each` gets
/// every entry and returns the counts after it.
///
/// # Errors
///
/// As [`feed`].
pub fn feed_followed(
    source: &mut Source,
    machine: &mut ClosedMicromill,
    mut counts: [i64; AXES],
    mut each: impl FnMut(&ClosedMicromill, &Followed<AXES>) -> io::Result<[i64; AXES]>,
) -> io::Result<()> {
    let config = machine.machine().config();
    let dialect = config.dialect;
    let mut turning = config
        .spindle_counts
        .map(|counts| Turning::new(counts, config.timer_hz));
    let mut pull = |machine: &mut ClosedMicromill| -> io::Result<Pulled> {
        let Some(mut entry) = machine.next_event(&counts) else {
            return Ok(match machine.is_stopped() {
                true => Pulled::End,
                false => Pulled::Nothing,
            });
        };
        if let (Followed::Event(event), Some(turning)) = (&mut entry, &mut turning) {
            *event = turning.timed(event)?;
        }
        counts = each(machine, &entry)?;
        Ok(match entry {
            Followed::Event(Event::Pause(Pause::End { .. })) => Pulled::End,
            _ => Pulled::Event,
        })
    };
    let mut ended = false;
    blocks::each_block(
        source,
        dialect,
        machine,
        |machine| machine.machine().modal(),
        |machine, given, block| {
            while !machine.machine().has_room() {
                if pull(machine)? == Pulled::End {
                    ended = true;
                    return Ok(ControlFlow::Break(()));
                }
            }
            block
                .map_err(Refused::from)
                .and_then(|block| machine.machine_mut().block(&block))
                .map_err(|refused| io::Error::other(format!("line {}: {refused}", given.number)))?;
            Ok(if machine.machine().has_ended() {
                ControlFlow::Break(())
            } else {
                ControlFlow::Continue(())
            })
        },
    )?;
    if ended {
        return Ok(());
    }
    // The machine still checks the axes after the end of the program.
    while pull(machine)? != Pulled::Nothing && !machine.is_stopped() {}
    Ok(())
}

/// Result of an attempt to take an event.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Pulled {
    /// An event.
    Event,
    /// No event: the queue is empty.
    Nothing,
    /// The end of the program.
    End,
}

#[inline]
fn pull<L: Lash<AXES>>(
    machine: &mut Machine<AXES, Path<AXES>, L>,
    each: &mut impl FnMut(&Machine<AXES, Path<AXES>, L>, &Event<AXES>) -> io::Result<()>,
) -> io::Result<Pulled> {
    // By reference for speed: a move would read the event as a whole right after it was written in
    // parts, and the processor would wait for the writes.
    let Some(ref event) = machine.next_event() else {
        return Ok(Pulled::Nothing);
    };
    each(machine, event)?;
    Ok(match event {
        Event::Pause(Pause::End { .. }) => Pulled::End,
        _ => Pulled::Event,
    })
}
