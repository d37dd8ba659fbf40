//! An axis behind a line of modules, real or simulated.

use super::rig::{Rig, Sample};
use crate::error::Error;
use crate::heads::per_period;
use crate::heads::{AxisSettings, Line, Machine, Port};
use husillo_transports::nmc::{
    CYCLE_US, Command, Gains, Items, Mode, Reply, Reset, Status, Stop, StopMode, Trajectory,
};

/// A module on a line.
#[derive(Debug)]
pub struct Linked<P> {
    line: Line<P>,
    module: u8,
    gains: Gains,
    /// During a drive, the duty for which the gains are set.
    duty: Option<u8>,
}

/// Highest limit of the position error that a module accepts, counts.
const ERROR_LIMIT_MOST: u16 = 0x3FFF;

/// Items of every reading.
const READ: Items = Items::POSITION.with(Items::CURRENT);

impl<P: Port> Linked<P> {
    /// Starts the line: flush, reset, addresses, baud rate.
    ///
    /// # Errors
    ///
    /// There is no answer, no servo module at this address, or no motor power.
    pub fn start(mut line: Line<P>, machine: &Machine, file: &AxisSettings) -> Result<Self, Error> {
        line.start_servos(machine.baud, [file.module])?;
        let mut linked = Self {
            line,
            module: file.module,
            gains: file.gains,
            duty: None,
        };
        linked.command(Command::ResetPosition(Reset::Zero))?;
        // The first reading gives the module a period to read its inputs.
        linked.command(Command::ReadStatus(READ))?;
        let reply = linked.command(Command::ReadStatus(READ))?;
        if !reply.status.contains(Status::POWER_ON) {
            return Err(Error::NoPower { axis: file.letter });
        }
        Ok(linked)
    }

    fn command(&mut self, command: Command) -> Result<Reply, Error> {
        self.line.command(self.module, command)
    }

    fn stop(&mut self, amplifier: bool, mode: StopMode) -> Result<(), Error> {
        let mode = Some(mode);
        self.command(Command::StopMotor(Stop { amplifier, mode }))?;
        Ok(())
    }
}

impl<P: Port> Rig for Linked<P> {
    fn set_gains(&mut self, gains: &Gains) -> Result<(), Error> {
        self.gains = *gains;
        self.duty = None;
        self.command(Command::SetGain(*gains))?;
        Ok(())
    }

    fn engage(&mut self) -> Result<(), Error> {
        self.stop(true, StopMode::Abrupt)?;
        self.command(Command::ClearBits)?;
        Ok(())
    }

    fn hold(&mut self, position: i32) -> Result<(), Error> {
        self.stop(true, StopMode::Here(position))
    }

    fn go_to(&mut self, goal: i32, rate: u32, acceleration: u32) -> Result<(), Error> {
        let cycle_s = f64::from(CYCLE_US) * 1e-6 * f64::from(self.gains.rate_divisor.max(1));
        let (velocity, acceleration) = per_period(rate, acceleration.into(), cycle_s);
        self.command(Command::LoadTrajectory(Trajectory {
            position: Some(goal),
            velocity: Some(velocity),
            acceleration: Some(acceleration),
            mode: Mode::Trapezoid,
            start_now: true,
            ..Trajectory::default()
        }))?;
        Ok(())
    }

    /// Does not use the PWM mode of the module, because that would continue without the host.
    /// Instead the servo moves to `end` with at most this duty, and holds the axis there. From an
    /// error of two counts on it uses the full duty.
    fn drive(&mut self, pwm: i16, end: i32) -> Result<(), Error> {
        let duty = pwm.unsigned_abs().min(255) as u8;
        if duty == 0 {
            return self.release();
        }
        if self.duty != Some(duty) {
            self.command(Command::SetGain(Gains {
                // 256 is 1 PWM per count. The largest value is 32640 of 32767.
                proportional: u16::from(duty) * 128,
                integral: 0,
                derivative: 0,
                integration_limit: 0,
                output_limit: duty,
                // Enough for a move from one end to the other.
                error_limit: self
                    .gains
                    .error_limit
                    .saturating_mul(2)
                    .min(ERROR_LIMIT_MOST),
                dead_band: 0,
                ..self.gains
            }))?;
            self.duty = Some(duty);
        }
        self.hold(end)
    }

    fn release(&mut self) -> Result<(), Error> {
        self.stop(false, StopMode::Off)
    }

    fn sample(&mut self) -> Result<Sample, Error> {
        let reply = self.command(Command::ReadStatus(READ))?;
        Ok(Sample {
            us: self.now_us(),
            position: reply.readings.position,
            current: reply.readings.current,
            status: reply.status,
        })
    }

    fn now_us(&self) -> u64 {
        self.line.elapsed_us()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simulated::{SimulatedNetwork, SimulatedPort, one_axis};

    /// The host is silent after a drive: the axis goes to the given end and stays there.
    #[test]
    fn a_drive_ends_without_the_host() {
        let machine = one_axis();
        let file = machine.axes[0];
        for (pwm, end) in [(60, 300), (-60, -300), (255, 150)] {
            let network = SimulatedNetwork::new(&[4], &[], None).unwrap();
            let line = Line::new(SimulatedPort::new(network));
            let mut linked = Linked::start(line, &machine, &file).unwrap();
            linked.set_gains(&file.gains).unwrap();
            linked.engage().unwrap();
            linked.drive(pwm, end).unwrap();
            let start_us = linked.now_us();
            let mut farthest = 0_i32;
            while linked.now_us() < start_us + 5_000_000 {
                let position = linked.sample().unwrap().position;
                farthest = if pwm > 0 {
                    farthest.max(position)
                } else {
                    farthest.min(position)
                };
            }
            let beyond = (farthest - end) * i32::from(pwm.signum());
            assert!((-30..200).contains(&beyond), "{pwm} to {end}: {farthest}");
            let sample = linked.sample().unwrap();
            assert!(
                sample.position.abs_diff(end) < 100,
                "{pwm} to {end}: {sample:?}"
            );
        }
    }
}
