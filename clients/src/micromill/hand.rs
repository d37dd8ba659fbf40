//! A mill moved by hand.

use super::action::{Action, Leg, Pace};
use super::session::{Session, why};
use crate::{StopRequests, Wire};
use husillo_sim::device::micromill::Device;
use husillo_transports::micromill::{Axis, Order, Outcome};
use std::time::Duration;

/// The longest wait in one turn, us.
const TURN_US: u32 = 50_000;
/// Largest number of steps of one string.
const MOST_STEPS: i32 = 9999;

/// A session, and the positions of the motors by the reported steps.
#[derive(Debug)]
pub struct Hand {
    session: Session,
    place: [i64; 3],
}

impl Hand {
    /// Stops any motion. From now on every motion ends `lease_ms` after the last byte of the host;
    /// with 0 it needs no host.
    ///
    /// # Errors
    ///
    /// A sentence about the port or the controller.
    pub fn new(
        wire: Wire<Device>,
        bits_per_s: u32,
        lease_ms: u16,
        stop: StopRequests,
    ) -> Result<Self, String> {
        let mut session = Session::new(wire, bits_per_s, stop);
        session.begin(lease_ms)?;
        session.order(Order::Every(1), "report of steps")?;
        session.steps.clear();
        Ok(Self {
            session,
            place: [0; 3],
        })
    }

    /// Carries out an action. Returns a text about the result.
    ///
    /// # Errors
    ///
    /// A sentence about the failure.
    pub fn carry_out(&mut self, action: &Action) -> Result<String, String> {
        let made = match action {
            Action::Home => self.ordered(Order::Home),
            Action::Steps(axis, steps) => self.steps(*axis, *steps),
            Action::Jog(ways, legs) => self.moves(Order::Jog(*ways), legs),
            Action::Run(axis, hz, time) => {
                let pace = Pace::Same;
                self.moves(Order::Run(*axis, *hz), &[Leg { pace, time: *time }])
            }
            Action::Backlash(axis, um) => self.ordered(Order::Backlash(*axis, *um)),
            Action::Zero => self.ordered(Order::Zero),
            // Repeated, because the first string of the session may be lost.
            Action::Stop => self.ordered(Order::Stop),
            Action::Where => Ok(()),
        };
        let steps = self.session.steps.len();
        for (place, steps) in self.place.iter_mut().zip(self.session.net_steps()) {
            *place += steps;
        }
        self.session.steps.clear();
        if let Err(sentence) = made {
            let [x, y, z] = self.place;
            return Err(match self.session.is_halted() {
                true => format!("{sentence}; {steps} steps; motors at x {x} y {y} z {z}"),
                false => sentence,
            });
        }
        if *action == Action::Home {
            self.place = [0; 3];
            return Ok("homed".into());
        }
        let [x, y, z] = self.place;
        Ok(format!("{steps} steps; motors at x {x} y {y} z {z}"))
    }

    /// Time since the port was opened.
    pub fn elapsed(&self) -> Duration {
        self.session.elapsed()
    }

    /// What a simulated mill has reported on its panel.
    pub fn panel(&mut self) -> Vec<String> {
        self.session.panel()
    }

    fn ordered(&mut self, order: Order) -> Result<(), String> {
        let text = order.text();
        self.session
            .order(order, &String::from_utf8_lossy(text.bytes()))
    }

    fn steps(&mut self, axis: Axis, steps: i32) -> Result<(), String> {
        let mut left = steps;
        while left != 0 {
            let part = left.clamp(-MOST_STEPS, MOST_STEPS);
            self.ordered(Order::Steps(axis, part as i16))?; // four digits
            left -= part;
        }
        Ok(())
    }

    /// Carries out a motion without an end: parts of a given duration, with changes of speed.
    fn moves(&mut self, order: Order, legs: &[Leg]) -> Result<(), String> {
        if !self.session.start(order) {
            return Err("the string before it has not ended".into());
        }
        for leg in legs {
            match leg.pace {
                Pace::Same => {}
                Pace::Faster => self.say(Order::Faster)?,
                Pace::Slower => self.say(Order::Slower)?,
            }
            self.wait(leg.time)?;
        }
        self.say(Order::Stop)?;
        loop {
            match self.session.turn(TURN_US)? {
                None => {}
                Some(Outcome::Done) => return Ok(()),
                Some(outcome) => return Err(why(outcome).into()),
            }
        }
    }

    /// Keeps a motion going for a time.
    fn wait(&mut self, time: Duration) -> Result<(), String> {
        let mut left_us = time.as_micros() as u64; // an hour at most
        let mut last = self.session.now();
        while left_us > 0 {
            let turn_us = left_us.min(TURN_US.into()) as u32;
            over(self.session.turn(turn_us)?)?;
            let now = self.session.now();
            left_us = left_us.saturating_sub(u64::from(now.wrapping_sub(last)));
            last = now;
        }
        Ok(())
    }

    /// Sends an order during a motion, after the previous string was confirmed.
    fn say(&mut self, order: Order) -> Result<(), String> {
        while !self.session.start(order) {
            over(self.session.turn(TURN_US)?)?;
        }
        Ok(())
    }
}

/// The message about a motion that ended early.
fn over(outcome: Option<Outcome>) -> Result<(), String> {
    match outcome {
        None => Ok(()),
        Some(Outcome::Stopped) => {
            let why = "the mill stopped on its own: the end of the travel, a switch, or no byte of \
                       the host in time";
            Err(why.into())
        }
        Some(outcome) => Err(why(outcome).into()),
    }
}
