//! Jogging: one axis runs for a given time.

use super::head::{Head, is_done, stop};
use super::port::Port;
use super::straight_move::per_period;
use crate::error::Error;
use husillo_transports::nmc::{Command, Mode, StopMode, Trajectory};

impl<P: Port> Head<P> {
    /// Moves an axis for a time and stops it smoothly. Its speed is that of moves, or that of a
    /// search if it `is_slow` or starts in contact. The jog is a move over the distance that
    /// belongs to the time, within the travel. So the module ends it as requested even without the
    /// host.
    ///
    /// # Errors
    ///
    /// [`Error`]. Then all axes are stopped.
    pub fn jog(
        &mut self,
        coordinate: usize,
        is_positive: bool,
        seconds: f64,
        is_slow: bool,
    ) -> Result<(), Error> {
        let index = self.index(coordinate)?;
        self.supervised(|head| head.run(index, is_positive, seconds, is_slow))
    }

    fn run(
        &mut self,
        index: usize,
        is_positive: bool,
        seconds: f64,
        is_slow: bool,
    ) -> Result<(), Error> {
        let axis = self.axes[index];
        let [low, high] = axis.travel_counts();
        // The axis may stop this far beyond its goal.
        let slack = axis.settings.in_position as i32;
        let mut goal = if is_positive {
            high.saturating_sub(slack)
        } else {
            low.saturating_add(slack)
        };
        if axis.is_at_end && axis.end.is_none() {
            // The axis must stay near its switch until the switch opens.
            let most = self.leaving();
            goal = goal.clamp(
                axis.held.saturating_sub(most),
                axis.held.saturating_add(most),
            );
        }
        if (goal > axis.held) != is_positive || goal == axis.held {
            // The axis is at the end of the travel already.
            return Ok(());
        }
        let mut goals: Vec<i32> = self.axes.iter().map(|axis| axis.held).collect();
        goals[index] = goal;
        self.check_ends(&goals)?;
        let is_touching = self.is_touching()?;
        let axis = self.axes[index];
        let rate = if is_slow || is_touching {
            self.probe.rate.min(axis.settings.rate)
        } else {
            axis.rate(self.probe.rate)
        };
        // A trapezoid of this length begins to brake after this time. The cast saturates.
        let asked = (f64::from(rate) * seconds).ceil() as i32;
        let goal = goal.clamp(
            axis.held.saturating_sub(asked),
            axis.held.saturating_add(asked),
        );
        goals[index] = goal;
        let mut watch = self.watch(&goals);
        self.begin_watch(&mut watch, is_touching)?;
        self.announce(&goals);
        self.head_for(&goals);
        let (velocity, acceleration) =
            per_period(rate, axis.settings.acceleration.into(), self.period_s);
        self.line.command(
            axis.settings.module,
            Command::LoadTrajectory(Trajectory {
                position: Some(goal),
                velocity: Some(velocity),
                acceleration: Some(acceleration),
                mode: Mode::Trapezoid,
                start_now: true,
                ..Trajectory::default()
            }),
        )?;
        let end_us = self.line.elapsed_us() + (seconds * 1e6) as u64;
        while self.line.elapsed_us() < end_us {
            let replies = self.read_moving(&watch)?;
            self.look(&mut watch, &replies)?;
            let reply = &replies[index];
            if is_done(reply) && axis.is_near(reply.readings.position, goal) {
                break;
            }
        }
        self.line
            .command(axis.settings.module, stop(StopMode::Smooth))?;
        let was_armed = self.end_watch(&mut watch)?;
        let replies = self.settle()?;
        if was_armed && self.is_closed(&replies) {
            return Err(self.collision(&watch));
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use crate::heads::{Head, Line, Port};
    use crate::simulated::{SimulatedNetwork, SimulatedPort, one_axis};
    use husillo_transports::nmc::{Baud, Timing};
    use std::cell::{Cell, RefCell};
    use std::io;
    use std::rc::Rc;

    /// A port that the test shares with the head, and whose cable may be pulled.
    #[derive(Clone)]
    struct Pulled {
        port: Rc<RefCell<SimulatedPort>>,
        from_us: Rc<Cell<u64>>,
    }

    impl Pulled {
        fn is_pulled(&self) -> bool {
            self.elapsed_us() >= self.from_us.get()
        }
    }

    impl Port for Pulled {
        fn timing(&self, baud: Baud) -> Timing {
            self.port.borrow().timing(baud)
        }

        fn elapsed_us(&self) -> u64 {
            self.port.borrow().elapsed_us()
        }

        fn set_baud(&mut self, baud: Baud) -> io::Result<()> {
            self.port.borrow_mut().set_baud(baud)
        }

        fn send(&mut self, bytes: &[u8]) -> io::Result<()> {
            match self.is_pulled() {
                true => Ok(()),
                false => self.port.borrow_mut().send(bytes),
            }
        }

        fn receive(&mut self, wait_us: u32) -> io::Result<Vec<u8>> {
            let bytes = self.port.borrow_mut().receive(wait_us)?;
            Ok(if self.is_pulled() { Vec::new() } else { bytes })
        }
    }

    /// The counts of a jog for this time, if the cable is pulled after a second. The present
    /// position is home.
    fn jogged(seconds: f64, is_positive: bool, pulled_us: u64) -> i64 {
        let machine = one_axis();
        let network = SimulatedNetwork::of_machine(&machine, &[], None).unwrap();
        let pulled = Pulled {
            port: Rc::new(RefCell::new(SimulatedPort::new(network))),
            from_us: Rc::new(Cell::new(u64::MAX)),
        };
        let mut head = Head::start(Line::new(pulled.clone()), &machine, 1).unwrap();
        head.axes[0].is_homed = true;
        pulled
            .from_us
            .set(pulled.elapsed_us().saturating_add(pulled_us));
        let ended = head.jog(0, is_positive, seconds, false);
        assert_eq!(ended.is_ok(), pulled_us == u64::MAX, "{ended:?}");
        let mut port = pulled.port.borrow_mut();
        for _ in 0..40_000 {
            port.network.tick();
        }
        port.network.motor(1).unwrap().counts()
    }

    /// At 1200 counts/s: without its host a jog ends at the same position as with it, not at the
    /// end of the travel at 8000 counts.
    #[test]
    fn a_jog_whose_host_is_killed_ends_as_asked() {
        for (seconds, is_positive) in [(3.0, true), (2.0, false)] {
            let wanted = (seconds * 1200.0) as u64;
            for pulled_us in [u64::MAX, 1_000_000] {
                let counts = jogged(seconds, is_positive, pulled_us);
                assert_eq!(counts > 0, is_positive);
                assert!(
                    counts.unsigned_abs().abs_diff(wanted) <= 30,
                    "{counts} of {wanted}"
                );
            }
        }
    }
}
