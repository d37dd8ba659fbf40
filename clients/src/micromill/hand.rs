//! A mill moved by hand.

use super::action::{Action, Leg, Pace};
use super::position::{self, Frame};
use super::session::{Session, why};
use crate::{ByHand, StopRequests, Wire};
use husillo_sim::device::micromill::Device;
use husillo_sim::text::counted;
use husillo_transports::micromill::{Axis, Order, Outcome, State};
use std::time::Duration;

/// The longest wait in one turn, us.
const TURN_US: u32 = 50_000;
/// Largest number of steps of one string.
const MOST_STEPS: i32 = 9999;
/// Why a position is unknown.
const UNREPORTED: &str = "the controller does not report where it is";

/// A session, and the state that the controller has reported.
#[derive(Debug)]
pub struct Hand {
    session: Session,
    /// `None`: the controller does not report its state.
    state: Option<State>,
    frame: Frame,
}

impl Hand {
    /// Stops any motion, and asks for the state of the controller. From now on every motion ends
    /// `lease_ms` after the last byte of the host. With 0 a motion needs no host. Positions are
    /// reported in `frame`.
    ///
    /// # Errors
    ///
    /// Returns a sentence about the port or the controller.
    pub fn new(
        wire: Wire<Device>,
        bits_per_s: u32,
        lease_ms: u16,
        frame: Frame,
        stop: StopRequests,
    ) -> Result<Self, String> {
        let mut session = Session::new(wire, bits_per_s, stop);
        session.begin(lease_ms)?;
        session.order(Order::Every(1), "report of steps")?;
        let state = session.state()?;
        session.steps.clear();
        Ok(Self {
            session,
            state,
            frame,
        })
    }

    fn made(&mut self, action: &Action) -> Result<(), String> {
        match action {
            Action::Home => self.ordered(Order::Home),
            Action::Steps(axis, steps) => self.steps(*axis, *steps),
            Action::Jog(ways, legs) => self.moves(Order::Jog(*ways), legs),
            Action::Run(axis, hz, time) => {
                let pace = Pace::Same;
                self.moves(Order::Run(*axis, *hz), &[Leg { pace, time: *time }])
            }
            Action::Backlash(axis, um) => self.ordered(Order::Backlash(*axis, *um)),
            Action::Zero => self.ordered(Order::Zero),
            // The order is repeated, because the first string of the session may be lost.
            Action::Stop => self.ordered(Order::Stop),
            Action::Where => Ok(()),
        }
    }

    /// The text about an action that was carried out.
    fn done(&self, action: &Action, steps: usize, stands: &str) -> String {
        match (action, &self.state) {
            (Action::Home, _) => "homed".into(),
            (Action::Where, Some(state)) => {
                let homed = match state.is_homed {
                    true => "homed",
                    false => "not homed",
                };
                format!("{homed}\n{}", position::report(state, &self.frame))
            }
            (Action::Where, None) => {
                format!("position, work zero and backlash are unknown: {UNREPORTED}")
            }
            _ => format!("{}; {stands}", counted(steps, "step")),
        }
    }

    /// The session.
    #[cfg(test)]
    pub const fn session(&mut self) -> &mut Session {
        &mut self.session
    }

    /// The state that the controller has reported.
    #[cfg(test)]
    pub const fn state(&self) -> Option<State> {
        self.state
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

    /// Carries out a motion that has no end of its own. It has parts of a given duration, with
    /// changes of speed between them.
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

impl ByHand for Hand {
    type Action = Action;

    /// The text about a failure contains the position if the controller has stopped.
    fn carry_out(&mut self, action: &Action) -> Result<String, String> {
        let made = self.made(action);
        let (steps, net) = (self.session.steps.len(), self.session.net_steps());
        self.session.steps.clear();
        let before = self.state;
        let asked = match &made {
            Ok(()) if before.is_some() => self.session.state(),
            // After any failure the position may have changed.
            Err(_) if before.is_some() => Ok(self.session.state_after()),
            _ => Ok(None),
        };
        let (made, state) = match (made, asked) {
            (made, Ok(state)) => (made, state),
            (Ok(()), Err(sentence)) => (Err(sentence), self.session.state_after()),
            (made, Err(_)) => (made, None),
        };
        self.state = state;
        // After homing or with another backlash, the steps count from another position.
        let is_same = !matches!(action, Action::Home | Action::Backlash(..));
        let uncounted = before
            .zip(state)
            .filter(|(before, now)| is_same && before.is_homed == now.is_homed)
            .and_then(|(before, now)| position::uncounted(&before, &net, &now));
        let stands = match (&state, before) {
            (Some(state), _) => position::motors(state),
            (None, Some(_)) => "the position is unknown".into(),
            (None, None) => {
                let [x, y, z] = net;
                format!("motors moved by x {x} y {y} z {z}, {UNREPORTED}")
            }
        };
        let moved = counted(steps, "step");
        match (made, uncounted) {
            (Err(sentence), None) => Err(format!("{sentence}; {moved}; {stands}")),
            (Err(sentence), Some(other)) => Err(format!("{sentence}; {moved}; {stands}; {other}")),
            (Ok(()), Some(other)) => Err(format!("{moved}; {stands}; {other}")),
            (Ok(()), None) => {
                let done = self.done(action, steps, &stands);
                let homed = before.zip(state).filter(|_| *action == Action::Home);
                Ok(
                    match homed.and_then(|(before, now)| position::lost(&before, &net, &now)) {
                        Some(lost) => format!("{done}; {lost}"),
                        None => done,
                    },
                )
            }
        }
    }

    fn elapsed(&self) -> Duration {
        self.session.elapsed()
    }

    fn panel(&mut self) -> Vec<String> {
        self.session.panel()
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::micromill::{BAUD, LEASE_MS, LengthUnit};
    use husillo_controllers::MicromillConfig;
    use husillo_sim::device::Emulation as _;

    fn hand(device: Device) -> Hand {
        let frame = Frame {
            config: MicromillConfig::MICROMILL.machine,
            unit: LengthUnit::Millimetres,
        };
        let wire = Wire::simulated(device);
        Hand::new(wire, BAUD, LEASE_MS, frame, StopRequests::default()).unwrap()
    }

    /// Without encoders only homing shows lost steps. It shows them to another program, too.
    #[test]
    fn homing_shows_steps_that_were_lost_since_the_last_one() {
        let mut hand = hand(Device::new(BAUD));
        let moves = [(Axis::X, 300), (Axis::X, -120), (Axis::Y, 77), (Axis::Z, 5)];
        let went = |hand: &mut Hand| {
            for (axis, steps) in moves {
                hand.carry_out(&Action::Steps(axis, steps)).unwrap();
            }
        };
        assert_eq!(hand.carry_out(&Action::Home), Ok("homed".into()));
        went(&mut hand);
        assert_eq!(hand.carry_out(&Action::Home), Ok("homed".into()));
        went(&mut hand);
        hand.session().device().control("block y");
        hand.carry_out(&Action::Steps(Axis::Y, 40)).unwrap();
        hand.session().device().control("unblock y");
        let device = std::mem::replace(hand.session().device(), Device::new(BAUD));
        let mut hand = self::hand(device);
        let homed = hand.carry_out(&Action::Home).unwrap();
        let lost = "homed; before homing the motors were x +0 y -40 z +0 steps";
        assert!(homed.starts_with(lost), "{homed}");
        assert_eq!(hand.carry_out(&Action::Home), Ok("homed".into()));
    }
}
