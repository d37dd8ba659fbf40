//! Lines to a controller, and the steps that it reports.

use super::session::Session;
use crate::{StopRequests, Wire};
use husillo_sim::device::micromill::Device;
use husillo_transports::micromill::{Line, Order};

/// Settings of a transmission.
#[derive(Clone, Copy, Debug)]
pub struct Sending {
    /// Rate of the port, bits/s.
    pub bits_per_s: u32,
    /// Longest silence of the host after which a motion ends, ms; 0: it needs no host.
    pub lease_ms: u16,
    /// Send a line while the previous one is made, without a stop between them.
    pub streams: bool,
    /// Report every n-th step; 0 reports none.
    pub every: u16,
    /// Home first.
    pub homes: bool,
}

/// Result of a transmission.
#[derive(Debug, Default)]
pub struct Sent {
    /// Each step reported since homing: its axis, and whether it was forward.
    pub steps: Vec<(u8, bool)>,
    /// Lines that were made.
    pub lines: usize,
}

/// Sends lines and waits until they are made. Before each line, `operator` gets the line and its
/// string, and returns whether to continue.
///
/// # Errors
///
/// A line of the file is refused, the port fails, or `stop` is set. The message about a stop has
/// the position of the motors.
pub fn send(
    wire: Wire<Device>,
    sending: &Sending,
    lines: &[(usize, Line)],
    stop: StopRequests,
    progress: impl FnMut(usize),
    operator: impl FnMut(&Line, &str) -> bool,
) -> Result<Sent, String> {
    let mut session = Session::new(wire, sending.bits_per_s, stop);
    let mut is_counted = false;
    let made = made(
        &mut session,
        sending,
        lines,
        &mut is_counted,
        progress,
        operator,
    );
    match made {
        Err(sentence) if session.is_halted() && sending.every > 0 && is_counted => {
            let [x, y, z] = session
                .net_steps()
                .map(|steps| steps * i64::from(sending.every));
            let from = if sending.homes {
                "machine zero"
            } else {
                "its beginning"
            };
            let about = if sending.every > 1 { "about " } else { "" };
            let lines = session.lines;
            Err(format!(
                "{sentence}; {lines} lines made; motors at {about}x {x} y {y} z {z} steps from \
                 {from}"
            ))
        }
        Err(sentence) => Err(sentence),
        Ok(()) => Ok(Sent {
            steps: session.steps,
            lines: session.lines,
        }),
    }
}

/// Sends everything. Sets `is_counted` when the reported steps begin to give the position.
fn made(
    session: &mut Session,
    sending: &Sending,
    lines: &[(usize, Line)],
    is_counted: &mut bool,
    mut progress: impl FnMut(usize),
    mut operator: impl FnMut(&Line, &str) -> bool,
) -> Result<(), String> {
    session.begin(sending.lease_ms)?;
    session.order(Order::Every(sending.every), "report of steps")?;
    if sending.homes {
        session.order(Order::Home, "homing")?;
    }
    session.steps.clear();
    *is_counted = true;
    if sending.streams {
        session.order(Order::Stream(true), "streaming")?;
    }
    for (done, (number, line)) in lines.iter().enumerate() {
        let text = Order::Line(*line).text();
        let string = String::from_utf8_lossy(text.bytes());
        if matches!(line, Line::Tool(_)) {
            session.finish()?;
        }
        if !operator(line, &string) {
            // After Ctrl-C this returns the message about it.
            session.turn(0)?;
            return Err(match line {
                Line::Tool(tool) => format!("line {number}: stopped before tool {tool}"),
                _ => format!("line {number}: stopped before {string}"),
            });
        }
        let name = format!("line {number}, {string}");
        session.order(Order::Line(*line), &name)?;
        if !sending.streams {
            session.lines += 1;
        }
        progress(done + 1);
    }
    session.finish()?;
    if sending.streams {
        session.order(Order::Stream(false), "no streaming")?;
    }
    Ok(())
}
