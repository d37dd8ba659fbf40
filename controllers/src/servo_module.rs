//! A servo module: the network interface and its axis, with bytes on one side and a motor on the
//! other.

use husillo_pid::{Drive, RateRule, ServoGains, ServoLaw, TotalLimit};
use husillo_planner::ServoMotion;
use husillo_transports::nmc::{
    Auxiliary, Baud, Command, Gains, Homing, Mode, Module, Order, Readings, Reset, Status, Stop,
    StopMode, Trajectory, reported_velocity,
};

use crate::controller::{Controller, Timed};
use husillo_machine::{ServoAxis, ServoEvents, ServoInputs, ServoStop};

/// A servo period of the original chip, 512 us.
const PERIOD_TICKS: u32 = 512;

/// Output of one servo period.
#[derive(Copy, Clone, Debug, Eq, PartialEq)]
pub struct ServoModuleOutput {
    /// The drive of the motor.
    pub drive: Drive,
    /// Level of the enable output of the amplifier.
    pub amplifier: bool,
    /// The new rate of the line, if it changes.
    pub baud: Option<Baud>,
}

/// A PIC-SERVO module (J. R. Kerr, data sheet, 1999; versions 4, 5 and 10) without its pins. It
/// takes received bytes and readings, and returns bytes to send and the drive of a motor.
///
/// ```text
/// command line ──► receive ┐                      ┌──► transmit ──► status line
///                          ├──► tick, each 0.512 ms
/// encoder, limits ─────────┘                      └──► drive, amplifier
/// ```
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct ServoModule {
    link: Module,
    axis: ServoAxis,
    /// Values of the last Load Trajectory. They apply if the next one omits a value.
    goal: i32,
    velocity: u32,
    acceleration: u32,
    duty: u8,
    amplifier: bool,
}

impl ServoModule {
    /// Creates a module in its state after power-up. `version` is 4 for the original chip.
    pub fn new(version: u8) -> Self {
        Self {
            link: Module::new(version),
            axis: ServoAxis::new(servo_law(&Gains::default(), version)),
            goal: 0,
            velocity: 0,
            acceleration: 0,
            duty: 0,
            amplifier: false,
        }
    }

    /// Returns the network interface of the module: ADDR_IN, received bytes and the reply.
    pub fn link(&mut self) -> &mut Module {
        &mut self.link
    }

    /// Returns the axis.
    pub const fn axis(&self) -> &ServoAxis {
        &self.axis
    }

    /// Runs one servo period: executes the received command, moves the axis, and prepares the
    /// reply.
    pub fn tick(&mut self, inputs: &ServoInputs) -> ServoModuleOutput {
        let drive = self.axis.tick(inputs);
        let baud = match self.link.take() {
            Some(Order::Servo(command)) => {
                self.execute(command);
                None
            }
            Some(Order::Baud(baud)) => Some(baud),
            Some(Order::Reset(_)) => {
                // The network interface has reset itself.
                let link = self.link;
                *self = Self {
                    link,
                    ..Self::new(link.version())
                };
                Some(Baud::default())
            }
            None => None,
        };
        if self.link.owes_reply() {
            let (status, readings) = (self.status(), self.readings());
            self.link.reply(status, &readings);
        }
        ServoModuleOutput {
            drive: if self.amplifier {
                drive
            } else {
                Drive::default()
            },
            amplifier: self.amplifier,
            baud,
        }
    }

    fn execute(&mut self, command: Command) {
        match command {
            Command::ResetPosition(reset) => {
                let position = match reset {
                    Reset::Zero => 0,
                    // Modulo 2^32.
                    Reset::Home => self.axis.position().wrapping_sub(self.axis.home()),
                    Reset::To(position) => position,
                };
                // During a move to a goal this has no effect.
                self.axis.set_position(position);
            }
            Command::LoadTrajectory(trajectory) => self.load(&trajectory),
            Command::StartMotion => self.start(),
            Command::SetGain(gains) => self.axis.set_law(servo_law(&gains, self.link.version())),
            Command::StopMotor(stop) => self.stop(stop),
            Command::SetHoming(homing) => self.search(homing),
            Command::ClearBits => self.axis.clear(),
            Command::SaveHome => self.axis.save_home(),
            // I/O pins belong to the owner, and the path mode is not implemented (see the README).
            // The link handles the other commands.
            _ => {}
        }
    }

    fn load(&mut self, trajectory: &Trajectory) {
        let relative = trajectory.is_relative() && self.link.version() >= 10;
        if let Some(position) = trajectory.position {
            self.goal = if relative {
                // Modulo 2^32.
                self.goal.wrapping_add(position)
            } else {
                position
            };
        }
        self.velocity = trajectory.velocity.unwrap_or(self.velocity);
        self.acceleration = trajectory.acceleration.unwrap_or(self.acceleration);
        self.duty = trajectory.pwm.unwrap_or(self.duty);
        let (velocity, acceleration) = (self.velocity, self.acceleration);
        self.axis.load(match trajectory.mode {
            Mode::Trapezoid => ServoMotion::Trapezoid {
                goal: self.goal,
                velocity,
                acceleration,
            },
            Mode::Velocity => ServoMotion::Velocity {
                velocity,
                acceleration,
                reverse: trajectory.reverse,
            },
            Mode::Pwm => ServoMotion::Pwm {
                duty: self.duty,
                reverse: trajectory.reverse,
            },
        });
        if trajectory.start_now {
            self.start();
        }
    }

    /// Version 4 starts a trapezoid from standstill only. A trapezoid that arrives while the axis
    /// moves waits in the buffer for the next start.
    fn start(&mut self) {
        let waits = self.link.version() < 5
            && self.axis.is_moving()
            && matches!(self.axis.loaded(), Some(ServoMotion::Trapezoid { .. }));
        if !waits {
            self.axis.start();
        }
    }

    fn stop(&mut self, stop: Stop) {
        self.amplifier = stop.amplifier;
        match stop.mode {
            Some(StopMode::Off) => self.axis.stop(ServoStop::Off),
            Some(StopMode::Abrupt) => self.axis.stop(ServoStop::Abrupt),
            Some(StopMode::Smooth) => self.axis.stop(ServoStop::Smooth),
            Some(StopMode::Here(position)) => self.axis.stop(ServoStop::At(position)),
            None => {}
        }
    }

    fn search(&mut self, homing: Homing) {
        let has = |bit: Homing| homing.0 & bit.0 != 0;
        let stop = if has(Homing::MOTOR_OFF) {
            Some(ServoStop::Off)
        } else if has(Homing::ABRUPT) {
            Some(ServoStop::Abrupt)
        } else if has(Homing::SMOOTH) {
            Some(ServoStop::Smooth)
        } else {
            None
        };
        let events = ServoEvents {
            limit_1: has(Homing::LIMIT_1),
            limit_2: has(Homing::LIMIT_2),
            index: has(Homing::INDEX),
            position_error: has(Homing::POSITION_ERROR),
            over_current: has(Homing::OVERCURRENT),
        };
        self.axis.search(events, stop);
    }

    fn status(&self) -> Status {
        let status = self.axis.status();
        let inputs = self.axis.inputs();
        Status(bits(&[
            (Status::MOVE_DONE.0, status.is_done),
            (Status::OVERCURRENT.0, status.over_current),
            (Status::POWER_ON.0, status.has_power),
            (Status::POSITION_ERROR.0, status.position_error),
            (Status::LIMIT_1.0, inputs.limit_1),
            (Status::LIMIT_2.0, inputs.limit_2),
            (Status::HOME_IN_PROGRESS.0, status.is_searching),
        ]))
    }

    fn readings(&self) -> Readings {
        let status = self.axis.status();
        let inputs = self.axis.inputs();
        Readings {
            position: self.axis.position(),
            current: inputs.current,
            // Converts whole counts to 16.16, modulo 2^32.
            velocity: reported_velocity(self.axis.velocity() << 16),
            auxiliary: Auxiliary(bits(&[
                (Auxiliary::INDEX.0, inputs.index),
                (Auxiliary::POSITION_WRAP.0, status.wrapped),
                (Auxiliary::SERVO_ON.0, status.is_on),
                (Auxiliary::ACCELERATION_DONE.0, status.is_acceleration_done),
                (Auxiliary::SLEW_DONE.0, status.is_slew_done),
            ])),
            home: self.axis.home(),
            position_error: self.axis.error_counts(),
            ..Readings::default()
        }
    }
}

/// An event of a module is a servo period. It contains the drive of the motor from then on.
impl Controller for ServoModule {
    type Inputs = ServoInputs;
    type Event = ServoModuleOutput;
    type Stops = ();

    fn receive(&mut self, byte: u8) -> bool {
        self.link.push(byte);
        false
    }

    fn stops(&self) {}

    fn next_event(&mut self, machine: u8, inputs: &ServoInputs) -> Option<ServoModuleOutput> {
        (machine == 0).then(|| self.tick(inputs))
    }

    fn transmit(&mut self) -> Option<u8> {
        self.link.transmit()
    }

    fn reset(&mut self) {
        *self = Self::new(self.link.version());
    }
}

impl Timed for ServoModuleOutput {
    fn wait_ticks(&self) -> Option<u32> {
        Some(PERIOD_TICKS)
    }
}

/// Returns a byte with the bits of the true flags.
fn bits(of: &[(u8, bool)]) -> u8 {
    of.iter()
        .filter(|(_, is_set)| *is_set)
        .fold(0, |all, (bit, _)| all | bit)
}

/// Returns the servo law of a module of this version with these gains. From version 10 on, the
/// divisor applies to the derivative only.
pub fn servo_law(gains: &Gains, version: u8) -> ServoLaw {
    let gains = ServoGains {
        proportional: gains.proportional,
        derivative: gains.derivative,
        integral: gains.integral,
        integral_limit: gains.integration_limit,
        output_limit: gains.output_limit,
        current_limit: gains.current_limit,
        error_limit: gains.error_limit,
        rate_divisor: gains.rate_divisor,
        dead_band: gains.dead_band,
    };
    let rate = if version >= 10 {
        RateRule::Derivative
    } else {
        RateRule::Loop
    };
    ServoLaw::new(&gains, rate, TotalLimit::BeforeScaling)
}
