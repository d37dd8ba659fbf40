//! The operator of a machine, who can stop it and can see the bytes on its line.

/// The operator of a machine. A stop is requested from outside, for example by a signal. The line
/// checks for a request before each of its steps. All methods have defaults: the operator `()`
/// never stops and ignores all reports.
pub trait Operator {
    /// Whether a stop is requested and not carried out yet. Then no step of the line begins.
    fn is_stop_wanted(&self) -> bool {
        false
    }

    /// Called when the motors are being stopped. Clears the request for a stop.
    fn stop_is_seen_to(&self) {}

    /// Called with `true` before motors may run, and with `false` when none runs any more. Between
    /// these calls a program must stop them before it ends.
    fn set_moving(&self, is_moving: bool) {
        let _ = is_moving;
    }

    /// Called with each reading of all axes, also while they move: the position, in amounts of the
    /// scale, and whether the probe is pressed.
    fn reads(&self, position: [i64; 3], is_pressed: bool) {
        let _ = (position, is_pressed);
    }

    /// Called with the bytes that were sent to the modules.
    fn sent(&self, bytes: &[u8]) {
        let _ = bytes;
    }

    /// Called with the bytes that were received from the modules.
    fn received(&self, bytes: &[u8]) {
        let _ = bytes;
    }

    /// Called before an axis that is not homed moves for the first time, at this speed at most.
    fn moves_without_home(&self, axis: char, rate: &str) {
        let _ = (axis, rate);
    }

    /// Called if not every axis has answered the command to stop, so that motors may run on.
    fn stop_is_unanswered(&self) {}
}

impl Operator for () {}

/// An operator for tests, who requests a stop when [`press`](Self::press) is called.
#[cfg(test)]
#[derive(Clone, Debug, Default)]
pub struct StopButton {
    state: std::rc::Rc<std::cell::Cell<(bool, bool)>>,
}

#[cfg(test)]
impl StopButton {
    /// Requests a stop.
    pub fn press(&self) {
        self.state.set((true, self.state.get().1));
    }

    /// Whether a stop was requested and carried out.
    pub fn has_stopped(&self) -> bool {
        self.state.get().1
    }
}

#[cfg(test)]
impl Operator for StopButton {
    fn is_stop_wanted(&self) -> bool {
        self.state.get().0
    }

    fn stop_is_seen_to(&self) {
        let (is_wanted, has_stopped) = self.state.get();
        self.state.set((false, has_stopped || is_wanted));
    }
}
