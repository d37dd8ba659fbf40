//! Result of a search, for programs that wait with `nb::block!`.

use core::fmt;

use husillo_pid::Regulator;

use crate::ServoAxis;

/// Reason why a search by [`ServoAxis::poll_search`] ended without its event.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum NotFound {
    /// The motion reached its goal first.
    AtGoal,
    /// The servo is off: there is no power, or the position error exceeded its limit.
    Off,
}

impl fmt::Display for NotFound {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            NotFound::AtGoal => "the motion reached its goal without the event",
            NotFound::Off => "the servo switched off during the search",
        })
    }
}

impl core::error::Error for NotFound {}

impl<R: Regulator> ServoAxis<R> {
    /// Polls a search ([`search`](ServoAxis::search), then a motion), for homing and for touches.
    /// Call it after each [`tick`](ServoAxis::tick). Returns the position of the event in counts
    /// once the axis stands.
    ///
    /// # Errors
    /// `WouldBlock` while it searches or moves; [`NotFound`] when the search ended without the
    /// event.
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
