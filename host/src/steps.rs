//! `husillo steps`: the step events as CSV.

use crate::feeder;
use crate::setup::Mill;
use crate::source::Source;
use husillo_machine::{Event, Motors};
use husillo_stepper::{Drive, Levels};
use std::io::{self, Write};

/// Writes `event,wait_ticks,dx,dy,dz`, one row an event; dwells are rows with zero deltas that share the number of the
/// event before them. With motors each row ends with the inputs of their drivers from then on, `lx,ly,lz`: bit 0 is a driver's first input.
///
/// # Errors
///
/// Reading or writing fails.
pub fn write(
    source: &mut Source,
    machine: &mut Mill,
    mut motors: Option<Motors<3, Drive>>,
    out: &mut impl Write,
) -> io::Result<u64> {
    out.write_all(b"event,wait_ticks,dx,dy,dz")?;
    out.write_all(if motors.is_some() {
        b",lx,ly,lz\n"
    } else {
        b"\n"
    })?;
    let mut count = 0_u64;
    let mut numbers = [itoa::Buffer::new(), itoa::Buffer::new()];
    feeder::feed(source, machine, |_, event| {
        let (wait_ticks, delta) = match event {
            Event::Step(step) => {
                count += 1;
                (step.wait_ticks, step.delta)
            }
            Event::Dwell { wait_ticks } => (*wait_ticks, [0; 3]),
            _ => return Ok(()),
        };
        let [number, wait] = &mut numbers;
        let mut row = [0_u8; 64];
        let mut length = 0;
        let mut put = |text: &[u8]| {
            row[length..length + text.len()].copy_from_slice(text);
            length += text.len();
        };
        put(number.format(count).as_bytes());
        put(b",");
        put(wait.format(wait_ticks).as_bytes());
        for d in delta {
            put(match d {
                -1 => b",-1",
                0 => b",0",
                _ => b",1",
            });
        }
        if let Some(motors) = &mut motors {
            let levels = match event {
                Event::Step(step) => motors.step(&step.delta),
                _ => motors.rest(u64::from(wait_ticks)),
            };
            for Levels(bits) in levels {
                put(b",");
                put(wait.format(*bits).as_bytes());
            }
        }
        put(b"\n");
        out.write_all(&row[..length])
    })?;
    Ok(count)
}
