//! Lines that the operator types.

use crate::console::stop::stops_asked;
use std::io::{self, BufRead, Read};
use std::sync::mpsc::{self, Receiver, RecvTimeoutError, TryRecvError};
use std::sync::{Mutex, PoisonError};
use std::time::Duration;

/// Interval of the checks for Ctrl-C while a line is typed.
const LOOK: Duration = Duration::from_millis(50);

/// The lines of standard input, from the first question on.
static TYPED: Mutex<Option<Receiver<String>>> = Mutex::new(None);

/// The next line of standard input. `None` at its end, or if Ctrl-C was pressed more than `before`
/// times ([`stops_asked`]).
pub fn typed_line(before: u32) -> Option<String> {
    let mut typed = TYPED.lock().unwrap_or_else(PoisonError::into_inner);
    // Ctrl-C does not interrupt a read of standard input: another thread reads.
    next_line(typed.get_or_insert_with(typed_lines), before)
}

/// What the operator has typed.
#[derive(Debug, PartialEq, Eq)]
pub enum Typed {
    Nothing,
    Line(String),
    /// Standard input has ended.
    End,
}

/// The next line of standard input, if it is complete.
pub fn typed() -> Typed {
    let mut typed = TYPED.lock().unwrap_or_else(PoisonError::into_inner);
    match typed.get_or_insert_with(typed_lines).try_recv() {
        Ok(line) => Typed::Line(line),
        Err(TryRecvError::Empty) => Typed::Nothing,
        Err(TryRecvError::Disconnected) => Typed::End,
    }
}

/// The next of these lines, as [`typed_line`].
pub fn next_line(lines: &Receiver<String>, before: u32) -> Option<String> {
    loop {
        match lines.recv_timeout(LOOK) {
            Ok(line) => return Some(line),
            Err(RecvTimeoutError::Disconnected) => return None,
            Err(RecvTimeoutError::Timeout) if stops_asked() > before => return None,
            Err(RecvTimeoutError::Timeout) => {}
        }
    }
}

/// The lines of standard input as they are typed, up to its end.
pub fn typed_lines() -> Receiver<String> {
    // A lock cannot be given to another thread.
    lines_of(io::BufReader::new(io::stdin()))
}

/// The lines of the terminal, where standard input is something else. `None`: there is no terminal.
pub fn terminal_lines() -> Option<Receiver<String>> {
    let terminal = std::fs::File::open("/dev/tty").ok()?;
    Some(lines_of(io::BufReader::new(terminal)))
}

/// Lines that may wait for the program. What types them waits when there are more.
const WAITING: usize = 16;
/// Longest line, bytes. The rest of a longer one is taken for another line.
const LONGEST: u64 = 1 << 16;

fn lines_of(mut reader: impl BufRead + Send + 'static) -> Receiver<String> {
    let (sender, receiver) = mpsc::sync_channel(WAITING);
    std::thread::spawn(move || {
        let mut line = Vec::new();
        while let Ok(1..) = reader.by_ref().take(LONGEST).read_until(b'\n', &mut line) {
            let text = String::from_utf8_lossy(&line);
            if sender
                .send(text.trim_end_matches(['\r', '\n']).to_owned())
                .is_err()
            {
                break;
            }
            line.clear();
        }
    });
    receiver
}
