//! What the driver and the thread of the head share while axes move: a stop, the joystick, and what
//! is read.

use super::work::Event;
use husillo_metrology::heads::{Deflection, Operator};
use std::cell::RefCell;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::Sender;
use std::sync::{Arc, Mutex, PoisonError};

/// What the driver wants of a head that moves.
#[derive(Debug, Default)]
pub(super) struct Hands {
    is_stop_wanted: AtomicBool,
    /// A stop was carried out.
    has_stopped: AtomicBool,
    joystick: Mutex<Option<[Deflection; 3]>>,
    /// A program that waits at M0 may go on.
    is_resumed: AtomicBool,
}

impl Hands {
    /// The head shall stop.
    pub(super) fn stop(&self) {
        self.is_stop_wanted.store(true, Ordering::SeqCst);
    }

    /// Whether it shall stop and does not brake yet.
    pub(super) fn is_stop_wanted(&self) -> bool {
        self.is_stop_wanted.load(Ordering::SeqCst)
    }

    /// The axes brake.
    fn see_to_stop(&self) {
        if self.is_stop_wanted.swap(false, Ordering::SeqCst) {
            self.has_stopped.store(true, Ordering::SeqCst);
        }
    }

    /// Whether there was a stop since the last call. Nothing is to be stopped afterwards.
    pub(super) fn take_stopped(&self) -> bool {
        self.see_to_stop();
        self.has_stopped.swap(false, Ordering::SeqCst)
    }

    /// Deflects the joystick. `None`: it is let go, and the motion ends.
    pub(super) fn steer(&self, joystick: Option<[Deflection; 3]>) {
        *self.held() = joystick;
    }

    /// The joystick.
    pub(super) fn joystick(&self) -> Option<[Deflection; 3]> {
        *self.held()
    }

    /// A program that waits goes on.
    pub(super) fn resume(&self) {
        self.is_resumed.store(true, Ordering::SeqCst);
    }

    /// Whether it shall go on since the last call.
    pub(super) fn take_resumed(&self) -> bool {
        self.is_resumed.swap(false, Ordering::SeqCst)
    }

    fn held(&self) -> std::sync::MutexGuard<'_, Option<[Deflection; 3]>> {
        self.joystick.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// The operator of the line: the driver, in another thread.
#[derive(Debug)]
pub(super) struct Watcher {
    hands: Arc<Hands>,
    events: Sender<Event>,
    /// The bytes of the last command, and those received since then.
    exchange: RefCell<(Vec<u8>, Vec<u8>)>,
}

impl Watcher {
    pub(super) fn new(hands: Arc<Hands>, events: Sender<Event>) -> Self {
        Self {
            hands,
            events,
            exchange: RefCell::default(),
        }
    }

    fn tell(&self, event: Event) {
        // Without the driver nobody needs to know.
        let _ = self.events.send(event);
    }
}

impl Operator for Watcher {
    fn is_stop_wanted(&self) -> bool {
        self.hands.is_stop_wanted()
    }

    fn stop_is_seen_to(&self) {
        self.hands.see_to_stop();
    }

    fn reads(&self, position: [i64; 3], is_pressed: bool) {
        self.tell(Event::At(position, is_pressed));
    }

    fn sent(&self, bytes: &[u8]) {
        let before = self.exchange.replace((bytes.to_vec(), Vec::new()));
        if !before.0.is_empty() {
            self.tell(Event::Exchange(before));
        }
    }

    fn received(&self, bytes: &[u8]) {
        self.exchange.borrow_mut().1.extend_from_slice(bytes);
    }

    fn moves_without_home(&self, axis: char, rate: &str) {
        self.tell(Event::Note(format!(
            "{axis} is not homed: it moves at {rate}, and its travel counts from where it stood"
        )));
    }

    fn stop_is_unanswered(&self) {
        let text = "not every axis has confirmed the stop: be ready to switch off";
        self.tell(Event::Note(text.into()));
    }
}
