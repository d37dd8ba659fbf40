//! A machine moved by hand.

use super::action::Action;
use super::session::{Heard, Session};
use crate::{ByHand, StopRequests, Wire};
use husillo_sim::device::grbl::Device;
use husillo_transports::grbl::{SETTINGS, State};
use std::time::Duration;

/// Speed of a move if none is given, mm/min.
const FEED: f64 = 600.0;

/// A session, and the speed of the next move.
#[derive(Debug)]
pub struct Hand {
    session: Session,
    feed: f64,
}

impl Hand {
    /// Connects. Nothing moves.
    ///
    /// # Errors
    ///
    /// Returns a sentence about the port or the controller.
    pub fn new(wire: Wire<Device>, stop: StopRequests) -> Result<Self, String> {
        let mut session = Session::new(wire, stop);
        session.begin()?;
        Ok(Self {
            session,
            feed: FEED,
        })
    }

    /// Moves, and waits for the end of the move.
    fn jog(&mut self, distance: u8, axes: &str) -> Result<(), String> {
        let feed = self.feed;
        self.session
            .request(&format!("$J=G21G{distance}{axes}F{feed}"))?;
        loop {
            if self.session.is_stopped() {
                return Err(self.session.halt());
            }
            match self.session.turn()? {
                Some(Heard::Alarm(number)) => return Err(self.session.alarmed(number)),
                Some(Heard::Started(_)) => return Err("the controller was reset".into()),
                Some(Heard::Status(status)) => match status.state {
                    State::Jog => {}
                    State::Idle => return Ok(()),
                    state => {
                        return Err(format!("the move has ended in the state {}", state.name()));
                    }
                },
                _ => {}
            }
        }
    }

    /// The settings, one on a line.
    fn settings(&mut self) -> Result<String, String> {
        let lines = self.session.request("$$")?;
        let explained = lines.iter().map(|line| {
            let number = line
                .strip_prefix('$')
                .and_then(|rest| rest.split('=').next()?.parse().ok());
            let known = SETTINGS
                .iter()
                .find(|setting| Some(setting.number) == number);
            match known {
                Some(setting) if setting.unit.is_empty() => format!("{line} ({})", setting.name),
                Some(setting) => format!("{line} ({}, {})", setting.name, setting.unit),
                None => line.clone(),
            }
        });
        Ok(explained.collect::<Vec<_>>().join("\n"))
    }
}

impl ByHand for Hand {
    type Action = Action;

    /// The text about the result contains the position.
    fn carry_out(&mut self, action: &Action) -> Result<String, String> {
        match action {
            Action::Home => {
                self.session.request("$H")?;
            }
            Action::Unlock => {
                self.session.request("$X")?;
            }
            Action::By(axes) => self.jog(91, axes)?,
            Action::To(axes) => self.jog(90, axes)?,
            Action::Feed(feed) => {
                self.feed = *feed;
                return Ok("for the next moves".into());
            }
            Action::Zero(letters) => {
                let words: String = letters.chars().map(|axis| format!("{axis}0")).collect();
                // P0 is the present work coordinate system.
                self.session.request(&format!("G10L20P0{words}"))?;
            }
            Action::Stop => self.session.stand()?,
            Action::Where => {}
            Action::Settings => return self.settings(),
            Action::Set(number, value) => {
                self.session.request(&format!("${number}={value}"))?;
                return Ok("stored".into());
            }
        }
        let state = self.session.fresh_status()?.state.name();
        self.session.expect_work_zero()?;
        Ok(format!("{state}; {}", self.session.stands()))
    }

    fn elapsed(&self) -> Duration {
        self.session.elapsed()
    }

    fn panel(&mut self) -> Vec<String> {
        self.session.panel()
    }
}
