//! Lines that the operator types.

use crate::console::stop::stops_asked;
use std::io::{self, BufRead};
use std::sync::mpsc::{self, Receiver, RecvTimeoutError};
use std::sync::{Mutex, PoisonError};
use std::time::Duration;

/// Interval of the checks for Ctrl-C while a line is typed.
const LOOK: Duration = Duration::from_millis(50);

/// The next line of standard input. `None` at its end, or if Ctrl-C was pressed more than `before`
/// times ([`stops_asked`]).
pub fn typed_line(before: u32) -> Option<String> {
    static TYPED: Mutex<Option<Receiver<String>>> = Mutex::new(None);
    let mut typed = TYPED.lock().unwrap_or_else(PoisonError::into_inner);
    // Ctrl-C does not interrupt a read of standard input: another thread reads.
    let typed = typed.get_or_insert_with(typed_lines);
    loop {
        match typed.recv_timeout(LOOK) {
            Ok(line) => return Some(line),
            Err(RecvTimeoutError::Disconnected) => return None,
            Err(RecvTimeoutError::Timeout) if stops_asked() > before => return None,
            Err(RecvTimeoutError::Timeout) => {}
        }
    }
}

/// The lines of standard input as they are typed, up to its end.
pub fn typed_lines() -> Receiver<String> {
    let (sender, receiver) = mpsc::channel();
    std::thread::spawn(move || {
        for line in io::stdin().lock().lines().map_while(Result::ok) {
            if sender.send(line).is_err() {
                break;
            }
        }
    });
    receiver
}
