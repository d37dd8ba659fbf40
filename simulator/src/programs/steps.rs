//! `husillo steps`: writes the step events as CSV.

use crate::programs::feeder;
use crate::programs::setup::MappedEngine;
use crate::programs::source::Source;
use crate::simulation::work_piece::WorkPiece;
use husillo_machine::Event;
use husillo_sim::observers::AXES;
use husillo_stepper::{Drive, Levels, Motors};
use std::io::{self, Write};

/// Writes `event,wait_ticks,dx,dy,dz`, one row per event, with further axes after Z. Dwells are
/// rows with zero deltas and the number of the event before them. With motors, each row ends with
/// the new inputs of their drivers, `lx,ly,lz`; bit 0 is the first input of a driver. A step of a
/// step and direction driver is then several rows. All of them have zero deltas except that of the
/// rising edge.
///
/// # Errors
///
/// Reading or writing fails.
pub fn write(
    source: &mut Source,
    machine: &mut MappedEngine,
    piece: &WorkPiece,
    mut motors: Option<Motors<AXES, Drive>>,
    out: &mut impl Write,
) -> io::Result<u64> {
    let axes = *machine.config().dialect.axes();
    out.write_all(b"event,wait_ticks")?;
    let kinds: &[char] = if motors.is_some() {
        &['d', 'l']
    } else {
        &['d']
    };
    for kind in kinds {
        for letter in axes.letters() {
            write!(out, ",{kind}{}", char::from(letter.to_ascii_lowercase()))?;
        }
    }
    out.write_all(b"\n")?;
    let axes = axes.len();
    let mut count = 0_u64;
    let mut changes = Vec::new();
    feeder::feed(source, machine, piece, |_, event| {
        let (wait_ticks, delta) = match event {
            Event::Step(step) => (step.wait_ticks, step.delta),
            Event::Dwell { wait_ticks } => (*wait_ticks, [0; AXES]),
            _ => return Ok(()),
        };
        let is_step = matches!(event, Event::Step(_));
        let Some(motors) = &mut motors else {
            count += u64::from(is_step);
            return write_row(out, count, wait_ticks, &delta[..axes], None);
        };
        let present =
            |wait_ticks: u32, levels: &[Levels; AXES]| changes.push((wait_ticks, *levels));
        if is_step {
            motors.step(wait_ticks, &delta, present);
        } else {
            motors.rest(wait_ticks, present);
        }
        let last = changes.len().saturating_sub(1);
        for (index, (wait_ticks, levels)) in changes.drain(..).enumerate() {
            let is_last = index == last;
            count += u64::from(is_step && is_last);
            let delta = if is_last { delta } else { [0; AXES] };
            write_row(
                out,
                count,
                wait_ticks,
                &delta[..axes],
                Some(&levels[..axes]),
            )?;
        }
        Ok(())
    })?;
    if let Some(motors) = &mut motors {
        motors.end_pulses(|wait_ticks, levels| changes.push((wait_ticks, *levels)));
    }
    for (wait_ticks, levels) in changes {
        write_row(
            out,
            count,
            wait_ticks,
            &[0; AXES][..axes],
            Some(&levels[..axes]),
        )?;
    }
    Ok(count)
}

fn write_row(
    out: &mut impl Write,
    event: u64,
    wait_ticks: u32,
    delta: &[i8],
    levels: Option<&[Levels]>,
) -> io::Result<()> {
    // Room for 20 and 10 digits, three bytes per delta and four per levels.
    let mut row = [0_u8; 96];
    let mut length = 0;
    let mut put = |text: &[u8]| {
        row[length..length + text.len()].copy_from_slice(text);
        length += text.len();
    };
    let mut number = itoa::Buffer::new();
    put(number.format(event).as_bytes());
    put(b",");
    put(number.format(wait_ticks).as_bytes());
    for d in delta {
        put(match d {
            -1 => b",-1",
            0 => b",0",
            _ => b",1",
        });
    }
    for Levels(bits) in levels.into_iter().flatten() {
        put(b",");
        put(number.format(*bits).as_bytes());
    }
    put(b"\n");
    out.write_all(&row[..length])
}
