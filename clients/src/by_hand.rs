//! Machines that are moved by hand, one action after the other.

use std::fmt::Display;
use std::time::Duration;

/// A machine moved by hand.
pub trait ByHand {
    /// What it can do.
    type Action: Display;

    /// Carries out an action. Returns a text about the result.
    ///
    /// # Errors
    ///
    /// A sentence about the failure.
    fn carry_out(&mut self, action: &Self::Action) -> Result<String, String>;

    /// Time since the port was opened. A simulated machine has simulated time.
    fn elapsed(&self) -> Duration;

    /// What a simulated machine has reported on its panel.
    fn panel(&mut self) -> Vec<String>;
}
