//! Sends a program to a Grbl controller, and prints each state that it reports.
//!
//! ```sh
//! cargo run -p husillo-clients --example grbl_program                  # a simulated controller
//! cargo run -p husillo-clients --example grbl_program -- /dev/ttyUSB0  # a machine: it moves!
//! ```

use husillo_clients::StopRequests;
use husillo_clients::grbl::{BAUD, Heard, Operator, Pacing, Sender, open};
use husillo_transports::grbl::Realtime;

/// A square of 2 mm.
const PROGRAM: [&str; 6] = [
    "G21 G91 G94",
    "G1 X2 F300",
    "G1 Y2",
    "G1 X-2",
    "G1 Y-2",
    "G90",
];

/// Prints what the controller says, and never intervenes.
struct Watcher;

impl Operator for Watcher {
    fn hear(&mut self, heard: &Heard) {
        match heard {
            Heard::Status(status) => println!("{}", status.state.name()),
            Heard::Text(text) => println!("{text}"),
            _ => {}
        }
    }

    fn progress(&mut self, lines: usize) {
        println!("{lines} of {} lines answered", PROGRAM.len());
    }

    fn command(&mut self) -> Option<Realtime> {
        None
    }

    fn agrees(&mut self, _: &str) -> Option<bool> {
        Some(true)
    }
}

fn main() -> Result<(), String> {
    let port = std::env::args().nth(1).unwrap_or("sim".to_owned());
    // A handler of signals keeps a clone of this, and stops the machine with it.
    let stop = StopRequests::default();
    let mut sender = Sender::new(open(&port, BAUD)?, Pacing::Counted, stop)?;
    let lines: Vec<_> = (1..).zip(PROGRAM.map(str::to_owned)).collect();
    let sent = sender.send(&lines, &mut Watcher)?;
    println!("{} lines carried out", sent.lines);
    println!("{}", sender.session().stands());
    Ok(())
}
