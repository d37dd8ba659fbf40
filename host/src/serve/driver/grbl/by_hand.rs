//! Lines and moves by hand.

use super::{Driver, Purpose, WAITING};
use crate::serve::axes::{Axes, LETTERS, feed, words};
use crate::serve::reply::Reply;
use crate::serve::request::Frame;
use husillo_transports::grbl::{Realtime, State};

/// Longest line by hand, characters.
const LONGEST: usize = 255;

impl Driver<'_> {
    /// Sends a line for a page, if the controller takes lines.
    pub(super) fn by_hand(
        &mut self,
        line: &str,
        reply: Reply,
        purpose: impl FnOnce(Reply) -> Purpose,
    ) {
        match self.takes_lines() {
            Ok(()) => self.send(line, purpose(reply)),
            Err(why) => reply.error(why),
        }
    }

    /// Whether the controller takes and answers lines by hand.
    ///
    /// # Errors
    ///
    /// A sentence about why not.
    pub(super) fn takes_lines(&self) -> Result<(), String> {
        if self.session.is_held() {
            return Err("the controller answers no line while it is held: resume or STOP".into());
        }
        if self.running.course.is_active() && !self.is_changing() {
            return Err("a program runs".into());
        }
        if self.sequence.is_some() {
            return Err("a macro or a move that probes runs".into());
        }
        if self.jogging.is_active() {
            return Err("the machine jogs".into());
        }
        match self.waiting.len() < WAITING {
            true => Ok(()),
            false => Err("too many lines wait".into()),
        }
    }

    /// Whether a new move by hand may begin.
    ///
    /// # Errors
    ///
    /// A sentence about why not.
    pub(super) fn is_free(&self) -> Result<(), String> {
        self.takes_lines()?;
        match self.session.state() {
            Some(State::Idle | State::Jog | State::Tool) => Ok(()),
            Some(State::Alarm) => Err("the controller is locked: home or unlock".into()),
            state => {
                let name = state.map_or("unknown", State::name);
                Err(format!("the machine is in the state {name}"))
            }
        }
    }

    /// Homes all axes, or one.
    pub(super) fn home(&mut self, axis: Option<char>, reply: Reply) {
        let line = match axis {
            None => "$H".to_owned(),
            Some(axis) if LETTERS.contains(&axis) => format!("$H{}", axis.to_ascii_uppercase()),
            Some(axis) => return reply.error(format!("there is no axis `{axis}`")),
        };
        self.by_hand(&line, reply, Purpose::Home);
    }

    /// Moves by a distance.
    pub(super) fn step(&mut self, by: &Axes, speed: f64, reply: Reply) {
        let line = self.is_free().and_then(|()| {
            let by = by.checked(self.state.axes.len())?;
            Ok(format!("$J=G21G91{}F{:.1}", words(&by), feed(speed)?))
        });
        self.move_along(line, reply);
    }

    /// Moves to a position.
    pub(super) fn go(&mut self, to: &Axes, frame: Frame, speed: f64, reply: Reply) {
        let line = self.is_free().and_then(|()| {
            let to = to.checked(self.state.axes.len())?;
            let frame = if frame == Frame::Machine { "G53" } else { "" };
            Ok(format!(
                "$J=G21G90{frame}{}F{:.1}",
                words(&to),
                feed(speed)?
            ))
        });
        self.move_along(line, reply);
    }

    fn move_along(&mut self, line: Result<String, String>, reply: Reply) {
        match line {
            Ok(line) => self.send(line, Purpose::Asked(reply)),
            Err(why) => reply.error(why),
        }
    }

    /// Sends a line that the operator has typed.
    ///
    /// # Errors
    ///
    /// The controller is lost.
    pub(super) fn line(&mut self, text: &str, reply: Reply) -> Result<(), String> {
        let text = text.trim();
        // A line of one of these bytes means the byte.
        let byte = match text {
            "!" => Some(Realtime::Hold),
            "~" => Some(Realtime::Resume),
            "?" => Some(Realtime::Status),
            _ => None,
        };
        if let Some(byte) = byte {
            reply.ok();
            return self.put(byte);
        }
        let is_plain = |c: char| (c.is_ascii_graphic() || c == ' ') && !"!?~".contains(c);
        if text.is_empty() || text.len() > LONGEST || !text.chars().all(is_plain) {
            reply.error("a line has 1 to 255 characters of ASCII, without ! ? ~");
            return Ok(());
        }
        let is_home = text
            .get(..2)
            .is_some_and(|head| head.eq_ignore_ascii_case("$h"));
        let purpose = if is_home {
            Purpose::Home
        } else {
            Purpose::Asked
        };
        self.by_hand(text, reply, purpose);
        Ok(())
    }
}
