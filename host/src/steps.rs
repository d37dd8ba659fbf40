//! `husillo steps`: the step events as CSV.

use crate::feeder;
use crate::setup::Mill;
use crate::source::Source;
use husillo_machine::Event;
use std::io::{self, Write};

/// Writes `event,wait_ticks,dx,dy,dz`, one row an event; dwells are rows with zero deltas that share the number of the
/// event before them.
///
/// # Errors
///
/// Reading or writing fails.
pub fn write(source: &mut Source, machine: &mut Mill, out: &mut impl Write) -> io::Result<u64> {
    out.write_all(b"event,wait_ticks,dx,dy,dz\n")?;
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
        let mut row = [0_u8; 48];
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
        put(b"\n");
        out.write_all(&row[..length])
    })?;
    Ok(count)
}
