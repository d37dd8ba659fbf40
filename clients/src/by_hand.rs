//! Machines that are moved by hand, one action after the other.

use std::fmt::Display;
use std::time::Duration;

/// A machine moved by hand.
pub trait ByHand {
    /// An action that the machine can carry out.
    type Action: Display;

    /// Carries out an action. Returns a text about the result.
    ///
    /// # Errors
    ///
    /// Returns a sentence about the failure.
    fn carry_out(&mut self, action: &Self::Action) -> Result<String, String>;

    /// Time since the port was opened. For a simulated machine this is simulated time.
    fn elapsed(&self) -> Duration;

    /// The lines that a simulated machine has reported on its panel since the last call.
    fn panel(&mut self) -> Vec<String>;
}
