//! Feeds the lines of a checked program to the machine, and passes its events on.

use crate::programs::blocks::{self, Given};
use crate::programs::reading::{Reading, Results, simulated};
use crate::programs::setup::{ClosedEngine, Engine};
use crate::programs::source::Source;
use crate::programs::spindle_time::Turning;
use crate::simulation::work_piece::WorkPiece;
use husillo_backlash::BacklashModel;
use husillo_gcode::{Block, Error};
use husillo_machine::{Alarm, Event, Followed, Pause, Refused};
use husillo_sim::observers::AXES;
use std::io;
use std::ops::ControlFlow;

/// Runs a program to its end. `each` receives the machine and each of its events. A probe touches
/// `piece`. When the program waits for an input, the input has the value that it waits for.
///
/// # Errors
///
/// Reading or writing fails, the machine refuses a line, or a probe finds nothing. The machine
/// refuses no line of a checked program, except a line that depends on the result of a probe.
pub fn feed<L: BacklashModel<AXES> + 'static>(
    source: &mut Source,
    machine: &mut Engine<L>,
    piece: &WorkPiece,
    mut each: impl FnMut(&Engine<L>, &Event<AXES>) -> io::Result<()>,
) -> io::Result<()> {
    let config = machine.config();
    let mut turning = config
        .spindle_counts
        .map(|counts| Turning::new(counts, config.timer_hz));
    let mut each = |machine: &Engine<L>, event: &Event<AXES>| match &mut turning {
        None => each(machine, event),
        Some(turning) => each(machine, &turning.timed(event)?),
    };
    if feed_lines(
        source,
        machine,
        |engine| engine,
        |engine| engine,
        |machine| pull(machine, piece, &mut each),
    )? {
        return Ok(());
    }
    finish(machine)?;
    loop {
        match pull(machine, piece, &mut each)? {
            Pulled::Event => {}
            Pulled::Alarm(alarm) => return Err(io::Error::other(alarm.to_string())),
            Pulled::End | Pulled::Nothing => return Ok(()),
        }
    }
}

/// Runs a program on a machine with encoders, to its end or until the machine stops. `each`
/// receives every event and returns the encoder counts after it.
///
/// # Errors
///
/// As [`feed`].
pub fn feed_followed(
    source: &mut Source,
    machine: &mut ClosedEngine,
    piece: &WorkPiece,
    mut counts: [i64; AXES],
    mut each: impl FnMut(&ClosedEngine, &Followed<AXES>) -> io::Result<[i64; AXES]>,
) -> io::Result<()> {
    let config = machine.machine().config();
    let mut turning = config
        .spindle_counts
        .map(|counts| Turning::new(counts, config.timer_hz));
    let mut pull = |machine: &mut ClosedEngine| -> io::Result<Pulled> {
        touch(machine.machine_mut(), piece);
        let Some(mut entry) = machine.next_event(&counts) else {
            return Ok(match machine.is_stopped() {
                true => Pulled::End,
                false => Pulled::Nothing,
            });
        };
        if let Followed::Event(event) = &entry {
            if turned_back(machine.machine_mut(), event) {
                return Ok(Pulled::Event);
            }
        }
        if let (Followed::Event(event), Some(turning)) = (&mut entry, &mut turning) {
            *event = turning.timed(event)?;
        }
        counts = each(machine, &entry)?;
        Ok(match entry {
            Followed::Event(event) => Pulled::of(machine.machine_mut(), &event),
            _ => Pulled::Event,
        })
    };
    if feed_lines(
        source,
        machine,
        ClosedEngine::machine,
        ClosedEngine::machine_mut,
        &mut pull,
    )? {
        return Ok(());
    }
    finish(machine.machine_mut())?;
    // The machine still checks the axes after the end of the program.
    while pull(machine)? != Pulled::Nothing && !machine.is_stopped() {}
    Ok(())
}

/// Feeds lines to a machine, `M`, until its program or the text ends. `pull` takes an event from
/// it. Returns whether the program has ended.
fn feed_lines<L: BacklashModel<AXES> + 'static, M>(
    source: &mut Source,
    machine: &mut M,
    engine: impl Fn(&M) -> &Engine<L>,
    engine_mut: impl Fn(&mut M) -> &mut Engine<L>,
    mut pull: impl FnMut(&mut M) -> io::Result<Pulled>,
) -> io::Result<bool> {
    let dialect = engine(machine).config().dialect;
    let mut ended = false;
    blocks::each_block(
        source,
        dialect,
        machine,
        |machine| reading(engine(machine)),
        |machine, given, block| {
            take(engine_mut(machine), given, block)?;
            let has_ended = engine(machine).has_ended();
            // Takes events until there is room for another line, and until the results of this one
            // are known.
            while !engine(machine).has_room() {
                match pull(machine)? {
                    Pulled::End => ended = true,
                    Pulled::Alarm(alarm) => return Err(at_line(given, &alarm)),
                    Pulled::Event => continue,
                    Pulled::Nothing => {}
                }
                return Ok(ControlFlow::Break(()));
            }
            // Any text may follow the end of a program.
            Ok(if has_ended {
                ControlFlow::Break(())
            } else {
                ControlFlow::Continue(())
            })
        },
    )?;
    Ok(ended)
}

/// Passes a block to a machine that has room for it.
fn take<L: BacklashModel<AXES>>(
    machine: &mut Engine<L>,
    given: &Given<'_>,
    block: Result<Block, Error>,
) -> io::Result<()> {
    block
        .map_err(Refused::from)
        .and_then(|block| machine.block(&block))
        .map_err(|refused| at_line(given, &refused))
}

/// Makes the moves that wait for the next corner when the text ends.
fn finish<L: BacklashModel<AXES>>(machine: &mut Engine<L>) -> io::Result<()> {
    machine
        .finish()
        .map_err(|refused| io::Error::other(refused.to_string()))
}

fn at_line(given: &Given<'_>, why: &dyn std::fmt::Display) -> io::Error {
    io::Error::other(format!("line {}: {why}", given.number))
}

/// What expressions can read of a machine.
fn reading<L: BacklashModel<AXES>>(machine: &Engine<L>) -> Reading<'_, AXES> {
    let probed = machine.probed();
    Reading {
        modal: machine.modal(),
        results: Results::new(probed.in_work, probed.is_touched, machine.input_micro()),
    }
}

/// Sets the input of the probe, if the machine needs it.
#[inline]
fn touch<L: BacklashModel<AXES>>(machine: &mut Engine<L>, piece: &WorkPiece) {
    if machine.needs_probe() {
        let steps = machine.position_steps();
        let scales = machine.config().axes.each_ref().map(|axis| axis.scale);
        let at = [0, 1, 2].map(|axis| scales[axis].position(steps[axis]) as f64);
        machine.set_probe(piece.is_touched(at));
    }
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
    /// The program cannot continue.
    Alarm(Alarm),
}

impl Pulled {
    /// The kind of an event. A request for an input is answered.
    #[inline]
    fn of<L: BacklashModel<AXES>>(machine: &mut Engine<L>, event: &Event<AXES>) -> Self {
        match event {
            Event::Pause(Pause::End { .. }) => Self::End,
            Event::Alarm(alarm) => Self::Alarm(*alarm),
            Event::Await { input, until, .. } => {
                machine.answer(Some(simulated(*input, *until)));
                Self::Event
            }
            _ => Self::Event,
        }
    }
}

/// The simulated spindle reverses at once, so no step beyond the ends of a tap is made.
#[inline]
fn turned_back<L: BacklashModel<AXES>>(machine: &mut Engine<L>, event: &Event<AXES>) -> bool {
    let turns = matches!(event, Event::Follow(_)) && machine.awaits_reversal();
    if turns {
        machine.spindle_reversed(false);
    }
    turns
}

#[inline]
fn pull<L: BacklashModel<AXES>>(
    machine: &mut Engine<L>,
    piece: &WorkPiece,
    each: &mut impl FnMut(&Engine<L>, &Event<AXES>) -> io::Result<()>,
) -> io::Result<Pulled> {
    touch(machine, piece);
    // By reference for speed. A copy would read the event as a whole right after it was written in
    // parts, and the processor would wait for these writes.
    let Some(ref event) = machine.next_event() else {
        return Ok(Pulled::Nothing);
    };
    if turned_back(machine, event) {
        return Ok(Pulled::Event);
    }
    each(machine, event)?;
    Ok(Pulled::of(machine, event))
}
