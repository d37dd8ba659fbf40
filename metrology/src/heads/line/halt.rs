//! A stop for modules that another program has set up and left running.

use super::Line;
use crate::error::Error;
use crate::heads::head::{READ, stop};
use crate::heads::{AxisSettings, Machine, Port};
use husillo_transports::nmc::{Baud, EVERY_GROUP, Group, Items, Reply, StopMode};

/// Silence after which all replies to the stop commands have ended, us.
const SILENCE_US: u32 = 50_000;

impl<P: Port> Line<P> {
    /// Stops every axis of the machine abruptly, with its servo on, and waits until each axis is at
    /// rest. Returns their readings with the latched positions. The modules keep their addresses,
    /// positions and settings.
    ///
    /// For a machine whose program was killed. The modules answer at the rate of the machine or, if
    /// they were not started up, at the rate after a reset.
    ///
    /// # Errors
    ///
    /// [`Error`] of the axis that does not confirm. The stop was sent to all axes at both rates.
    pub fn halt(&mut self, machine: &Machine) -> Result<Vec<Reply>, Error> {
        match self.halt_at(machine.baud, &machine.axes) {
            Err(_) if machine.baud != Baud::default() => {
                self.halt_at(Baud::default(), &machine.axes)
            }
            halted => halted,
        }
    }

    fn halt_at(&mut self, baud: Baud, axes: &[AxisSettings]) -> Result<Vec<Reply>, Error> {
        self.port.set_baud(baud)?;
        self.host.set_timing(self.port.timing_of_known(baud));
        let command = stop(StopMode::Abrupt);
        let addresses = axes.iter().map(|axis| axis.module);
        // A long sequence of zeros completes a command that was cut off. The first command after it
        // may be lost. So a command is sent to the group of all modules first, and then one to each
        // module.
        self.port.send(&[0; 20])?;
        for address in [EVERY_GROUP].into_iter().chain(addresses.clone()) {
            self.port.send(command.frame(address).bytes())?;
            // The wait is limited, so that a line that is never silent does not delay the next
            // stop.
            let end_us = self.port.elapsed_us() + 2 * u64::from(SILENCE_US);
            while self.port.elapsed_us() < end_us && !self.port.receive(SILENCE_US)?.is_empty() {}
        }
        let group = Group {
            address: EVERY_GROUP,
            is_leader: false,
        };
        addresses
            .map(|address| {
                self.host.adopt(address, Items::NONE, group);
                self.read_twice(address, READ.with(Items::AUXILIARY), 0)
            })
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::heads::Head;
    use crate::simulated::{SimulatedNetwork, SimulatedPort, three_axes};
    use husillo_transports::nmc::{Command, Mode, Trajectory};

    /// A network whose program was killed while all axes move, at the rate of the machine.
    fn abandoned(machine: &Machine) -> SimulatedPort {
        let network = SimulatedNetwork::new(&[4; 3], &[], None).unwrap();
        let mut head = Head::start(Line::new(SimulatedPort::new(network)), machine, 1).unwrap();
        for axis in &machine.axes {
            let far = Trajectory {
                position: Some(50_000),
                velocity: Some(30_000),
                acceleration: Some(300),
                mode: Mode::Trapezoid,
                start_now: true,
                ..Trajectory::default()
            };
            let command = Command::LoadTrajectory(far);
            head.line.command(axis.module, command).unwrap();
        }
        let mut port = head.line.into_port();
        port.receive(300_000).unwrap();
        port
    }

    fn counts(port: &mut SimulatedPort) -> [i64; 3] {
        [0, 1, 2].map(|module| port.network.servo_network().motor(module).unwrap().counts())
    }

    #[test]
    fn axes_that_a_killed_program_left_moving_are_stopped() {
        let fast = Machine {
            baud: Baud::B115200,
            ..three_axes()
        };
        for machine in [three_axes(), fast] {
            let mut port = abandoned(&machine);
            let before = counts(&mut port);
            let mut line = Line::new(port);
            let start_us = line.elapsed_us();
            let replies = line.halt(&machine).unwrap();
            let positions = replies.iter().map(|reply| reply.readings.position);
            let positions: Vec<i32> = positions.collect();
            assert!(line.elapsed_us() - start_us < 700_000);
            let mut port = line.into_port();
            let halted = counts(&mut port);
            for _ in 0..2000 {
                port.network.tick();
            }
            let later = counts(&mut port);
            for (axis, position) in positions.iter().enumerate() {
                assert!(before[axis] > 100, "{before:?}");
                assert!(
                    halted[axis].abs_diff(later[axis]) <= 1,
                    "{halted:?} {later:?}"
                );
                // Nothing was reset.
                assert!(
                    later[axis].abs_diff(i64::from(*position)) <= 1,
                    "{positions:?}"
                );
            }
        }
    }

    /// The next start-up finds the modules as usual.
    #[test]
    fn a_stop_of_a_line_after_a_reset_reports_the_silence() {
        let network = SimulatedNetwork::new(&[4; 3], &[], None).unwrap();
        let mut line = Line::new(SimulatedPort::new(network));
        assert!(matches!(line.halt(&three_axes()), Err(Error::Link { .. })));
        assert_eq!(line.start_up(Baud::B19200).unwrap().modules, 3);
    }
}
