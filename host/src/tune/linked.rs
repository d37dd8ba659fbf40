//! An axis behind a line of modules, real or simulated.

use super::rig::{Rig, Sample, profile};
use crate::cmm::file::{AxisFile, CmmFile};
use crate::cmm::line::Line;
use crate::cmm::trouble::Trouble;
use husillo_transports::nmc::{
    CYCLE_US, Command, Gains, Items, Mode, Reply, Reset, Status, Stop, StopWay, Trajectory,
};

/// A module at the other end of a line.
pub struct Linked {
    line: Line,
    module: u8,
    rate_divisor: u8,
}

/// What every reading asks for.
const READ: Items = Items::POSITION.with(Items::CURRENT);

impl Linked {
    /// Starts the line: flush, reset, addresses, rate.
    ///
    /// # Errors
    ///
    /// No answer, fewer modules than the machine has, no motor power.
    pub fn start(mut line: Line, machine: &CmmFile, file: &AxisFile) -> Result<Self, Trouble> {
        let modules = line.start_up(machine.baud)?.modules;
        if modules < file.module {
            return Err(Trouble::NoModule {
                wanted: file.module,
                modules,
            });
        }
        let mut linked = Self {
            line,
            module: file.module,
            rate_divisor: file.gains.rate_divisor,
        };
        linked.command(Command::ResetPosition(Reset::Zero))?;
        // A period for what the module reads.
        linked.command(Command::ReadStatus(READ))?;
        let reply = linked.command(Command::ReadStatus(READ))?;
        if !reply.status.contains(Status::POWER_ON) {
            return Err(Trouble::NoPower { axis: file.letter });
        }
        Ok(linked)
    }

    fn command(&mut self, command: Command) -> Result<Reply, Trouble> {
        self.line.command(self.module, command)
    }

    fn stop(&mut self, amplifier: bool, way: StopWay) -> Result<(), Trouble> {
        let way = Some(way);
        self.command(Command::StopMotor(Stop { amplifier, way }))?;
        Ok(())
    }
}

impl Rig for Linked {
    fn set_gains(&mut self, gains: &Gains) -> Result<(), Trouble> {
        self.rate_divisor = gains.rate_divisor.max(1);
        self.command(Command::SetGain(*gains))?;
        Ok(())
    }

    fn engage(&mut self) -> Result<(), Trouble> {
        self.stop(true, StopWay::Abrupt)?;
        self.command(Command::ClearBits)?;
        Ok(())
    }

    fn hold(&mut self, position: i32) -> Result<(), Trouble> {
        self.stop(true, StopWay::Here(position))
    }

    fn go_to(&mut self, goal: i32, rate: u32, acceleration: u32) -> Result<(), Trouble> {
        let cycle_s = f64::from(CYCLE_US) * 1e-6 * f64::from(self.rate_divisor);
        let [velocity, acceleration] = profile(rate, acceleration, cycle_s);
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

    fn drive(&mut self, pwm: i16) -> Result<(), Trouble> {
        self.command(Command::LoadTrajectory(Trajectory {
            pwm: Some(pwm.unsigned_abs().min(255) as u8),
            mode: Mode::Pwm,
            reverse: pwm < 0,
            start_now: true,
            ..Trajectory::default()
        }))?;
        Ok(())
    }

    fn release(&mut self) -> Result<(), Trouble> {
        self.stop(false, StopWay::Off)
    }

    fn sample(&mut self) -> Result<Sample, Trouble> {
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
