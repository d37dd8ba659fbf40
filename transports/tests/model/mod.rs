//! A servo without dynamics, and a line of modules and a host that may lose, flip and double bytes.
//! Virtual time.
#![allow(dead_code)]

use husillo_transports::nmc::{
    Auxiliary, CYCLE_US, Command, Homing, Host, Mode, Module, Order, Outcome, Progress, Readings,
    Reset, Status, Step, StopMode, Trajectory,
};

/// Moves at once when it is told that time has gone by.
#[derive(Debug, Clone, Default)]
pub struct Servo {
    pub position: i32,
    pub home: i32,
    pub goal: i32,
    pub loaded: Trajectory,
    pub moving: bool,
    pub servo_on: bool,
    pub position_error: bool,
    pub homing: Homing,
    pub waits_for_home: bool,
    /// Bits of the auxiliary status for acceleration and slew done.
    pub profile: u8,
    /// Commands executed that must not be repeated.
    pub executed: Vec<Command>,
    pub all: Vec<Command>,
    pub path_points: u8,
    pub follows_path: bool,
    pub gains: Option<husillo_transports::nmc::Gains>,
}

impl Servo {
    pub fn new() -> Servo {
        Servo {
            position_error: true,
            ..Servo::default()
        }
    }

    pub fn execute(&mut self, command: Command) {
        self.all.push(command);
        if !matches!(command.repeat(1), husillo_transports::nmc::Repeat::Free) {
            self.executed.push(command);
        }
        match command {
            Command::ResetPosition(Reset::Zero) => self.position = 0,
            Command::ResetPosition(Reset::To(position)) => self.position = position,
            Command::ResetPosition(Reset::Home) => {
                self.position = self.position.wrapping_sub(self.home);
                self.home = 0;
            }
            Command::LoadTrajectory(trajectory) => {
                self.loaded = trajectory;
                if trajectory.start_now {
                    self.start();
                }
            }
            Command::StartMotion => self.start(),
            Command::StopMotor(stop) => match stop.mode {
                Some(StopMode::Off) => {
                    self.servo_on = false;
                    self.position_error = true;
                    self.moving = false;
                }
                Some(StopMode::Here(position)) => {
                    self.servo_on = true;
                    self.position = position;
                    self.moving = false;
                }
                Some(_) => {
                    self.servo_on = true;
                    self.moving = false;
                }
                None => {}
            },
            Command::SetHoming(homing) => {
                self.homing = homing;
                self.waits_for_home = !homing.is_cancel();
            }
            Command::ClearBits => self.position_error = !self.servo_on,
            Command::SaveHome => self.home = self.position,
            Command::SetGain(gains) => self.gains = Some(gains),
            Command::AddPathPoints(points) => match points.points().len() {
                0 => self.follows_path = true,
                more => self.path_points = self.path_points.saturating_add(more as u8),
            },
            _ => {}
        }
    }

    fn start(&mut self) {
        match self.loaded.mode {
            Mode::Pwm => {
                self.servo_on = false;
                self.position_error = true;
                return;
            }
            Mode::Trapezoid => {
                let by = self.loaded.position.unwrap_or(self.goal);
                let is_relative = self.loaded.is_relative();
                self.goal = if is_relative {
                    self.goal.wrapping_add(by)
                } else {
                    by
                };
            }
            Mode::Velocity => {
                let away = if self.loaded.reverse {
                    -100_000
                } else {
                    100_000
                };
                self.goal = self.position.wrapping_add(away);
            }
        }
        self.servo_on = true;
        self.moving = true;
        self.profile = 0;
    }

    /// The motion comes to its end; an index at every 2000 counts is met on the way.
    pub fn finish(&mut self) {
        if !self.moving {
            return;
        }
        let index = self.goal / 2000 * 2000;
        if self.waits_for_home && self.homing.contains(Homing::INDEX) && index != 0 {
            self.home = index;
            self.waits_for_home = false;
        }
        self.position = self.goal;
        self.moving = false;
        self.profile = 0x18;
    }

    pub fn status(&self) -> Status {
        let bit = |is_set, status: Status| if is_set { status.0 } else { 0 };
        Status(
            bit(!self.moving, Status::MOVE_DONE)
                | Status::POWER_ON.0
                | bit(self.position_error, Status::POSITION_ERROR)
                | bit(self.waits_for_home, Status::HOME_IN_PROGRESS),
        )
    }

    pub fn readings(&self) -> Readings {
        let servo = if self.servo_on {
            Auxiliary::SERVO_ON.0
        } else {
            0
        };
        let path = if self.follows_path {
            Auxiliary::PATH_MODE.0
        } else {
            0
        };
        Readings {
            position: self.position,
            home: self.home,
            auxiliary: Auxiliary(servo | path | self.profile),
            path_points: self.path_points,
            ..Readings::default()
        }
    }
}

/// What the line does to a byte.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Fault {
    Lost,
    Flipped(u8),
    Doubled,
}

/// A network: module 0 of the vector is the far end.
pub struct Line {
    pub modules: Vec<(Module, Servo)>,
    /// These do not hear and do not answer.
    pub dead: u32,
    pub now_us: u32,
    character_us: u32,
    /// Bytes on the command line so far, and on the status line.
    pub sent: u64,
    pub told: u64,
    /// Whether motions end by themselves at each cycle.
    pub finishes: bool,
}

impl Line {
    pub fn new(count: usize, version: u8) -> Line {
        let mut line = Line {
            modules: (0..count)
                .map(|_| (Module::new(version), Servo::new()))
                .collect(),
            dead: 0,
            now_us: 0,
            character_us: 87,
            sent: 0,
            told: 0,
            finishes: false,
        };
        line.daisy_chain();
        line
    }

    fn daisy_chain(&mut self) {
        let mut enabled = true;
        for (module, _) in &mut self.modules {
            module.set_enabled(enabled);
            enabled = enabled && module.enables_next();
        }
    }

    fn is_alive(&self, number: usize) -> bool {
        self.dead & (1 << number) == 0
    }

    /// A byte reaches every module.
    pub fn hear(&mut self, byte: u8) {
        for number in 0..self.modules.len() {
            if self.is_alive(number) {
                self.modules[number].0.push(byte);
            }
        }
    }

    /// The end of a servo cycle of every module.
    pub fn cycle(&mut self) {
        for number in 0..self.modules.len() {
            if !self.is_alive(number) {
                continue;
            }
            let (module, servo) = &mut self.modules[number];
            if self.finishes {
                servo.finish();
            }
            match module.take() {
                Some(Order::Servo(command)) => servo.execute(command),
                Some(Order::Reset(_)) => {
                    *servo = Servo {
                        executed: servo.executed.clone(),
                        ..Servo::new()
                    }
                }
                Some(Order::Baud(_)) | None => {}
            }
            module.reply(servo.status(), &servo.readings());
        }
        self.daisy_chain();
    }

    /// One byte time of the status line: what all who talk make of it together.
    pub fn tell(&mut self) -> Option<u8> {
        let mut told: Option<u8> = None;
        for number in 0..self.modules.len() {
            if self.is_alive(number) {
                let byte = self.modules[number].0.transmit();
                told = match (told, byte) {
                    (Some(a), Some(b)) => Some(a & b), // the drivers fight, zeros win
                    (a, b) => a.or(b),
                };
            }
        }
        told
    }

    /// Sends bytes, lets a servo cycle pass and collects what is answered.
    pub fn exchange(&mut self, request: &[u8]) -> Vec<u8> {
        for byte in request {
            self.hear(*byte);
        }
        self.cycle();
        std::iter::from_fn(|| self.tell()).collect()
    }

    /// Runs a step to its outcome. `fault` is called for each byte, with its number and whether it
    /// is on the status line.
    pub fn run(
        &mut self,
        host: &mut Host,
        step: Step,
        fault: &mut impl FnMut(bool, u64) -> Option<Fault>,
    ) -> Outcome {
        host.start(step, self.now_us).expect("an idle host");
        let mut next_cycle_us = self.now_us.wrapping_add(self.now_us % CYCLE_US);
        for _ in 0..2_000_000 {
            if let Progress::Done(outcome) = host.poll(self.now_us) {
                return outcome;
            }
            if let Some(byte) = host.transmit(self.now_us) {
                for heard in damaged(byte, fault(false, self.sent)) {
                    self.hear(heard);
                }
                self.sent += 1;
            }
            self.now_us = self.now_us.wrapping_add(self.character_us);
            if self.now_us.wrapping_sub(next_cycle_us) < u32::MAX / 2 {
                next_cycle_us = self.now_us.wrapping_add(CYCLE_US);
                self.cycle();
            }
            if let Some(byte) = self.tell() {
                for heard in damaged(byte, fault(true, self.told)) {
                    host.push(heard, self.now_us);
                }
                self.told += 1;
            }
        }
        panic!("the host hangs");
    }

    /// As `run`, on a good line.
    pub fn do_step(&mut self, host: &mut Host, step: Step) -> Outcome {
        self.run(host, step, &mut |_, _| None)
    }
}

fn damaged(byte: u8, fault: Option<Fault>) -> Vec<u8> {
    match fault {
        None => vec![byte],
        Some(Fault::Lost) => vec![],
        Some(Fault::Flipped(bit)) => vec![byte ^ (1 << (bit % 8))],
        Some(Fault::Doubled) => vec![byte, byte],
    }
}
