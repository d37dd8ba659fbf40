//! For programs that wait with `nb::block!`: an axis that searches.

use core::fmt;

use husillo_pid::Regulator;

use crate::ServoAxis;

/// Why a search of [`ServoAxis::poll_search`] is over without its event.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum NotFound {
    /// The motion has come to its goal before.
    AtGoal,
    /// The servo is off: no power, or the position error went beyond its limit.
    Off,
}

impl fmt::Display for NotFound {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            NotFound::AtGoal => "not found on the way",
            NotFound::Off => "the servo went off",
        })
    }
}

impl core::error::Error for NotFound {}

impl<R: Regulator> ServoAxis<R> {
    /// Whether a search ([`search`](ServoAxis::search), then a motion) has found its event and has come to a stand: the position of the
    /// event, counts. For homing and for touches, asked after each [`tick`](ServoAxis::tick).
    ///
    /// # Errors
    /// `WouldBlock` while it searches or moves; [`NotFound`] where neither will end with the event.
    pub fn poll_search(&self) -> nb::Result<i32, NotFound> {
        let status = self.status();
        match (status.is_searching, status.is_done) {
            (false, true) => Ok(self.home()),
            (true, _) if !status.is_on => Err(nb::Error::Other(NotFound::Off)),
            (true, true) => Err(nb::Error::Other(NotFound::AtGoal)),
            (_, false) => Err(nb::Error::WouldBlock),
        }
    }
}
