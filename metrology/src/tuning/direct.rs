//! The simulated axis without a link. It is read in every servo period.

use super::rig::{Rig, Sample};
use crate::error::Error;
use crate::heads::per_period;
use husillo_controllers::servo_law;
use husillo_machine::{ServoAxis, ServoInputs, ServoStop};
use husillo_pid::Drive;
use husillo_planner::ServoMotion;
use husillo_sim::{DcMotor, DcMotorModel, FULL_CURRENT_A, SERVO_PERIOD_S};
use husillo_transports::nmc::{CYCLE_US, Gains, Status};

/// Version of the module whose servo law is used: the original module.
const VERSION: u8 = 4;

/// Servo law and motor without the link of a module.
#[derive(Debug)]
pub struct Direct {
    axis: ServoAxis,
    motor: DcMotor,
    drive: Drive,
    rate_divisor: u8,
    ticks: u64,
}

impl Direct {
    /// A motor at rest, with its servo off.
    pub fn new(model: DcMotorModel) -> Self {
        let mut direct = Self {
            axis: ServoAxis::new(servo_law(&Gains::default(), VERSION)),
            motor: DcMotor::new(model),
            drive: Drive::default(),
            rate_divisor: 1,
            ticks: 0,
        };
        // The first period reads the position.
        direct.tick();
        direct
    }

    fn tick(&mut self) {
        let duty = f64::from(self.drive.signed()) / 255.0;
        self.motor.advance(duty, 0.0, SERVO_PERIOD_S);
        self.drive = self.axis.tick(&ServoInputs {
            counts: self.motor.counts() as i32, // modulo 2^32, as the counter of a module
            current: self.current(),
            has_power: true,
            ..ServoInputs::default()
        });
        self.ticks += 1;
    }

    fn current(&self) -> u8 {
        // The cast saturates as the converter does.
        (self.motor.current_a().abs() / FULL_CURRENT_A * 255.0) as u8
    }

    fn start(&mut self, motion: ServoMotion) {
        self.axis.load(motion);
        self.axis.start();
    }
}

impl Rig for Direct {
    fn set_gains(&mut self, gains: &Gains) -> Result<(), Error> {
        self.rate_divisor = gains.rate_divisor.max(1);
        self.axis.set_law(servo_law(gains, VERSION));
        Ok(())
    }

    fn engage(&mut self) -> Result<(), Error> {
        self.axis.stop(ServoStop::Abrupt);
        self.axis.clear();
        Ok(())
    }

    fn hold(&mut self, position: i32) -> Result<(), Error> {
        self.axis.stop(ServoStop::At(position));
        Ok(())
    }

    fn go_to(&mut self, goal: i32, rate: u32, acceleration: u32) -> Result<(), Error> {
        let cycle_s = SERVO_PERIOD_S * f64::from(self.rate_divisor);
        let (velocity, acceleration) = per_period(rate, acceleration.into(), cycle_s);
        self.start(ServoMotion::Trapezoid {
            goal,
            velocity,
            acceleration,
        });
        Ok(())
    }

    fn drive(&mut self, pwm: i16, _: i32) -> Result<(), Error> {
        let duty = pwm.unsigned_abs().min(255) as u8;
        let reverse = pwm < 0;
        self.start(ServoMotion::Pwm { duty, reverse });
        // The duty acts in the period of its command, like the output of the servo law that it
        // replaces.
        self.drive = Drive {
            pwm: duty,
            is_reverse: reverse,
        };
        Ok(())
    }

    fn release(&mut self) -> Result<(), Error> {
        self.axis.stop(ServoStop::Off);
        Ok(())
    }

    fn sample(&mut self) -> Result<Sample, Error> {
        self.tick();
        let status = self.axis.status();
        let bits = [
            (Status::MOVE_DONE, status.is_done),
            (Status::OVERCURRENT, status.over_current),
            (Status::POWER_ON, status.has_power),
            (Status::POSITION_ERROR, status.position_error),
        ];
        let set = bits.into_iter().filter(|(_, is_set)| *is_set);
        Ok(Sample {
            us: self.now_us(),
            position: self.axis.position(),
            current: self.current(),
            status: Status(set.fold(0, |all, (bit, _)| all | bit.0)),
        })
    }

    fn now_us(&self) -> u64 {
        self.ticks * u64::from(CYCLE_US)
    }
}
