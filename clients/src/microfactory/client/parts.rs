//! Commands in parts: a caller begins a motion, asks where the machine is, and stops it.
//!
//! A panel has to answer its operator while the machine moves. So none of these calls waits for the
//! end of a motion. The caller asks at least every 50 ms: each question renews the lease.

use super::{Answer, Client, letter};
use crate::Wire;
use husillo_sim::device::{Emulation as _, microfactory as device};
use husillo_sim::text::counted;
use husillo_transports::microfactory::{Status, figure_check, move_bytes};
use std::fmt;
use std::time::Duration;

/// A motion of the device.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Motion {
    /// Homes X, then Y, then Z.
    Home,
    /// Turns a motor by steps.
    Steps {
        /// 0 to 3: X, Y, Z, spindle.
        motor: u8,
        /// Forward, or clockwise.
        forward: bool,
        /// 1 to 255.
        count: u8,
    },
    /// Turns a motor while it is repeated: see [`Client::repeat_jog`].
    Jog {
        /// 0 to 3: X, Y, Z, spindle.
        motor: u8,
        /// Forward, or clockwise.
        forward: bool,
    },
    /// Feeds Y until the tool touches, then cuts the stored figure.
    Figure,
}

impl fmt::Display for Motion {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let name = |motor: u8| ["x", "y", "z", "c"].get(usize::from(motor)).unwrap_or(&"?");
        let sign = |forward: bool| if forward { '+' } else { '-' };
        match *self {
            Self::Home => f.write_str("home"),
            Self::Steps {
                motor,
                forward,
                count,
            } => write!(f, "{} {}{count}", name(motor), sign(forward)),
            Self::Jog { motor, forward } => write!(f, "{}{}", name(motor), sign(forward)),
            Self::Figure => f.write_str("figure"),
        }
    }
}

impl Client {
    /// Brings the device to rest from any state, and sets its lease. After an emergency stop it is
    /// at rest, and its status says so.
    ///
    /// # Errors
    ///
    /// A sentence: the device does not answer, or has no lease.
    pub fn bring_to_rest(&mut self) -> Result<Status, String> {
        let status = self.talk(|client| {
            client.rest()?;
            client.begin_lease()?;
            // A device that was reset has forgotten its home.
            client.is_homed = false;
            client.ask()
        })?;
        self.is_reached = true;
        Ok(status)
    }

    /// Begins a motion. The lease is set again before, because a reset ends it.
    ///
    /// # Errors
    ///
    /// A sentence: the link failed, or the device refuses. Its status may have the reason.
    pub fn begin(&mut self, motion: Motion) -> Result<(), String> {
        self.talk(Self::begin_lease)?;
        let table = self.table;
        match motion {
            Motion::Home => {
                // A reset and the begin of homing look alike.
                self.is_homed = false;
                self.command(&[table.home])
            }
            Motion::Steps {
                motor,
                forward,
                count,
            } => self.command(&[
                table.steps,
                letter(&table, motor, forward),
                count,
                table.run,
            ]),
            Motion::Jog { motor, forward } => {
                self.command(&[table.manual, letter(&table, motor, forward)])
            }
            Motion::Figure => self.command(&[table.figure]),
        }
    }

    /// Repeats a jog, which ends half a second after its last repetition. Returns whether it goes
    /// on: a closed switch ends it.
    ///
    /// # Errors
    ///
    /// A sentence: the link failed.
    pub fn repeat_jog(&mut self, motor: u8, forward: bool) -> Result<bool, String> {
        let letter = letter(&self.table, motor, forward);
        Ok(self.talk(|client| client.send(letter))? == Answer::Taken)
    }

    /// Asks the device what it does and where it is. Takes 22 ms at 9600 bits/s.
    ///
    /// # Errors
    ///
    /// A sentence: there is no answer, or the device was reset.
    pub fn status(&mut self) -> Result<Status, String> {
        self.ask()
    }

    /// Stops at once. What the device reports afterwards is the answer.
    ///
    /// # Errors
    ///
    /// A sentence: there is no answer.
    pub fn halt(&mut self) -> Result<Status, String> {
        self.talk(|client| client.rest().and_then(|()| client.ask()))
    }

    /// The emergency stop: nothing moves until the reset of the panel.
    ///
    /// # Errors
    ///
    /// A sentence: it was not confirmed.
    pub fn stop_for_good(&mut self) -> Result<String, String> {
        self.emergency()
    }

    /// Begins to store a figure: the device forgets the one before.
    ///
    /// # Errors
    ///
    /// A sentence: the link failed, or the device stores no figures.
    pub fn clear_figure(&mut self) -> Result<(), String> {
        let clear = self.table.clear;
        match self.talk(|client| client.send(clear))? {
            Answer::Taken => Ok(()),
            Answer::Rejected => {
                Err("the device stores no figures: it cuts its own (`husillo jog figure`)".into())
            }
        }
    }

    /// Stores the next move of a figure. Takes 11 ms at 9600 bits/s.
    ///
    /// # Errors
    ///
    /// A sentence: the link failed, or the memory of the device is full. The figure is then stored
    /// again from its begin, after [`Client::halt`].
    pub fn store_move(&mut self, delta: [i16; 2]) -> Result<(), String> {
        let mut bytes = vec![self.table.line];
        bytes.extend(move_bytes(delta));
        self.command(&bytes)
    }

    /// Ends a figure. The device compares its number of moves and their check.
    ///
    /// # Errors
    ///
    /// A sentence: the link failed, or the device has got another figure.
    pub fn keep_figure(&mut self, moves: &[[i16; 2]]) -> Result<(), String> {
        let count = u16::try_from(moves.len()).map_err(|_| {
            format!(
                "a figure of {}: the device has room for {}",
                counted(moves.len(), "move"),
                device::ROOM
            )
        })?;
        let mut bytes = vec![self.table.keep];
        bytes.extend(count.to_le_bytes());
        bytes.extend(figure_check(moves).to_le_bytes());
        self.command(&bytes)
    }

    /// What a homing has found: a sentence about steps that were lost since the one before.
    ///
    /// # Errors
    ///
    /// A sentence: there is no answer.
    pub fn lost_steps(&mut self) -> Result<Option<String>, String> {
        self.lost()
    }

    /// Waits while nothing is asked. A byte that arrives meanwhile is dropped.
    ///
    /// # Errors
    ///
    /// A sentence: the port failed.
    pub fn wait(&mut self, time: Duration) -> Result<(), String> {
        let end = self.elapsed() + time;
        while let Some(left) = end
            .checked_sub(self.elapsed())
            .filter(|left| !left.is_zero())
        {
            self.get(left)?;
        }
        Ok(())
    }

    /// Presses the reset at the panel of a simulated device. Returns whether there is one.
    pub fn press_reset(&mut self) -> bool {
        match &mut self.wire {
            Wire::Simulated { device, .. } => {
                device.control("reset");
                true
            }
            Wire::Real { .. } => false,
        }
    }
}
