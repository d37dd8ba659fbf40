//! Ctrl-C while motors run.

use crate::console::stop::{INTERRUPTED, on_request};
use husillo_metrology::heads::Operator;
use std::cell::RefCell;
use std::fmt::Write;
use std::rc::Rc;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// A request of the user or the system to end the program.
#[derive(Clone, Debug, Default)]
pub struct Interrupt {
    is_asked: Arc<AtomicBool>,
    /// Whether motors may run. The program then ends only after they are stopped.
    is_moving: Arc<AtomicBool>,
    has_stopped: Arc<AtomicBool>,
}

impl Interrupt {
    /// Starts to listen. Ctrl-C ends the program at once while nothing moves. Otherwise it sets
    /// [`is_asked`](Self::is_asked).
    ///
    /// # Errors
    ///
    /// The system refuses to pass Ctrl-C on.
    pub fn listen() -> Result<Self, String> {
        let interrupt = Self::default();
        let heard = interrupt.clone();
        on_request(move || {
            if !heard.is_moving.load(Ordering::SeqCst) {
                eprintln!("interrupted: nothing was moving");
                crate::output::exit(INTERRUPTED);
            }
            heard.ask();
        })?;
        Ok(interrupt)
    }

    /// Requests the end.
    pub fn ask(&self) {
        self.is_asked.store(true, Ordering::SeqCst);
    }

    /// Whether the end is requested and the motors are not yet stopped.
    pub fn is_asked(&self) -> bool {
        self.is_asked.load(Ordering::SeqCst)
    }

    /// Sets whether motors may run from now on.
    pub fn set_moving(&self, is_moving: bool) {
        self.is_moving.store(is_moving, Ordering::SeqCst);
    }

    /// Takes the request: the caller stops the motors now. It is cleared, so that the commands of
    /// the stop can be sent.
    pub fn see_to(&self) {
        if self.is_asked.swap(false, Ordering::SeqCst) {
            self.has_stopped.store(true, Ordering::SeqCst);
        }
    }

    /// Whether the end was requested and the motors were stopped.
    pub fn has_stopped(&self) -> bool {
        self.has_stopped.load(Ordering::SeqCst)
    }
}

/// The user at the terminal, next to the machine.
#[derive(Clone, Debug)]
pub struct User {
    interrupt: Interrupt,
    /// Whether all bytes are shown on standard error.
    is_raw: bool,
    /// Bytes received since the last transmission. They arrive in pieces of any length, and are
    /// shown in one line.
    heard: Rc<RefCell<Vec<u8>>>,
}

impl User {
    /// A user who may interrupt. If `is_raw`, standard error shows all bytes.
    pub fn new(interrupt: &Interrupt, is_raw: bool) -> Self {
        Self {
            interrupt: interrupt.clone(),
            is_raw,
            heard: Rc::default(),
        }
    }

    /// Shows what was received.
    fn show_heard(&self) {
        let heard = self.heard.take();
        self.show('<', &heard);
    }

    fn show(&self, sign: char, bytes: &[u8]) {
        if self.is_raw && !bytes.is_empty() {
            let mut text = String::from(sign);
            for byte in bytes {
                // Writing to a string does not fail.
                let _ = write!(text, " {byte:02x}");
            }
            eprintln!("{text}");
        }
    }
}

impl Operator for User {
    fn is_stop_wanted(&self) -> bool {
        self.interrupt.is_asked()
    }

    fn stop_is_seen_to(&self) {
        self.interrupt.see_to();
    }

    fn set_moving(&self, is_moving: bool) {
        self.show_heard();
        self.interrupt.set_moving(is_moving);
    }

    fn sent(&self, bytes: &[u8]) {
        self.show_heard();
        self.show('>', bytes);
    }

    fn received(&self, bytes: &[u8]) {
        if self.is_raw {
            self.heard.borrow_mut().extend_from_slice(bytes);
        }
    }

    fn moves_without_home(&self, axis: char, rate: &str) {
        self.show_heard();
        eprintln!(
            "note: {axis} is not homed: it moves at {rate}, and its travel counts from where it \
             stood"
        );
    }

    fn stop_is_unanswered(&self) {
        eprintln!("warning: not every axis has confirmed the stop: be ready to switch off");
    }
}

impl Drop for User {
    fn drop(&mut self) {
        self.show_heard();
    }
}
