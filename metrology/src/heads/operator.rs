//! Who stands before the machine: may stop it, and sees what goes on.

/// The operator of a machine. A stop is asked for from outside, such as by a signal; the line asks
/// for it before each of its steps. Nothing of it has to be there: `()` never stops and sees
/// nothing.
pub trait Operator {
    /// Whether a stop is wanted that nobody has seen to. No step of the line begins then.
    fn is_stop_wanted(&self) -> bool {
        false
    }

    /// Somebody stops the motors now: a stop that was wanted is wanted no more.
    fn stop_is_seen_to(&self) {}

    /// Whether motors may run from now on: a program that ends then has to stop them first.
    fn set_moving(&self, is_moving: bool) {
        let _ = is_moving;
    }

    /// Bytes went to the modules.
    fn sent(&self, bytes: &[u8]) {
        let _ = bytes;
    }

    /// Bytes came from the modules.
    fn received(&self, bytes: &[u8]) {
        let _ = bytes;
    }

    /// Not every axis has answered the command to stop: motors may run on.
    fn stop_is_unanswered(&self) {}
}

impl Operator for () {}

/// An operator of tests, who asks for a stop when told to.
#[cfg(test)]
#[derive(Clone, Debug, Default)]
pub struct StopButton {
    state: std::rc::Rc<std::cell::Cell<(bool, bool)>>,
}

#[cfg(test)]
impl StopButton {
    /// Asks for a stop.
    pub fn press(&self) {
        self.state.set((true, self.state.get().1));
    }

    /// Whether a stop was asked for and seen to.
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
