//! Any commands, bytes and faults at a servo module with a motor.

use husillo_controllers::ServoModule;
use husillo_machine::ServoInputs;
use husillo_transports::nmc::{
    Baud, Command, Gains, Group, Homing, Items, Mode, Order, Reset, Stop, StopMode, Trajectory,
};

use crate::bytes::Bytes;

/// Number of periods for which a trapezoid is observed.
const PERIODS: u8 = 64;

/// Behaviour of the motor and its surroundings, from period to period.
struct Bench {
    counts: i32,
    inputs: ServoInputs,
    /// Whether the motor follows the drive.
    follows: bool,
    bounds: Bounds,
}

/// The limits of the drive that the module received, tracked from order to order. Bounds that only
/// grow would soon allow everything.
#[derive(Default)]
struct Bounds {
    output_limit: u8,
    error_limit: u32,
    rate_divisor: u8,
    /// The drive that a servo with a divided rate may still hold from its last sample under the
    /// limits of that time, and for how many periods.
    held: u8,
    held_periods: u8,
    /// The duty loaded last, and whether a start would apply it.
    duty: u8,
    is_duty_loaded: bool,
    /// The duty started last, unless the servo is on.
    started: u8,
}

/// A module receives packets, good and damaged, in any order, while its motor follows, sticks,
/// loses its supply or reaches a switch.
///
/// - The drive never exceeds the output limit in force (with a divided rate: from the next sample
///   on), or the duty that was started. It is zero while amplifier, supply or servo are off and no
///   PWM is set.
/// - An active servo is never farther from its command than the error limit in force.
/// - A trapezoid never commands a position outside the range from its start to its goal.
/// - A switch that a search waits for latches the position of the motor and stops it there: nothing
///   is commanded beyond.
/// - A damaged packet changes nothing but the reply.
pub fn servo(data: &[u8]) {
    let mut bytes = Bytes::new(data);
    let version = [4, 5, 10][usize::from(bytes.byte() % 3)];
    let mut module = ServoModule::new(version);
    module.link().set_enabled(true);
    let mut bench = Bench {
        counts: bytes.i32(),
        inputs: ServoInputs {
            has_power: true,
            ..ServoInputs::default()
        },
        follows: true,
        bounds: Bounds::default(), // gains are 0 after power-up
    };
    for _ in 0..64 {
        if bytes.is_empty() {
            break;
        }
        match bytes.byte() % 8 {
            // Raw bytes, which may be half a packet of another module.
            0 => {
                for _ in 0..bytes.byte() % 24 {
                    module.link().push(bytes.byte());
                }
            }
            1 => {
                let mut deaf = module;
                damaged(&mut module, &mut bytes);
                bench.inputs.counts = bench.counts;
                let inputs = bench.inputs;
                assert_eq!(module.tick(&inputs), deaf.tick(&inputs));
                assert_eq!(*module.axis(), *deaf.axis());
            }
            2 => {
                let flags = bytes.byte();
                bench.follows = flags & 1 != 0;
                bench.inputs.limit_1 = flags & 2 != 0;
                bench.inputs.limit_2 = flags & 4 != 0;
                bench.inputs.index = flags & 8 != 0;
                bench.inputs.has_power = flags & 0x30 != 0x30;
                bench.inputs.current = bytes.byte();
            }
            3 => {
                // The motor is turned by hand, or the encoder loses its position.
                bench.counts = bench.counts.wrapping_add(bytes.i32());
            }
            4 => trapezoid(&mut module, &mut bench, &mut bytes),
            _ => {
                let command = command(&mut bytes);
                let address = module.link().address();
                for byte in command.frame(address).bytes() {
                    module.link().push(*byte);
                }
            }
        }
        for _ in 0..1 + bytes.byte() % 8 {
            bench.tick(&mut module);
        }
    }
}

impl Bench {
    /// Runs one period.
    fn tick(&mut self, module: &mut ServoModule) {
        self.inputs.counts = self.counts;
        // The motor is driven before the received order is executed.
        let order = { *module.link() }.take();
        let output = module.tick(&self.inputs);
        while module.link().transmit().is_some() {}
        self.bounds.check(module, output.drive.pwm);
        match order {
            Some(order) => self.bounds.follow(order),
            None => self.bounds.check_error(module),
        }
        if !output.amplifier {
            assert_eq!(output.drive.pwm, 0, "the amplifier is off");
        }
        if !self.inputs.has_power {
            // A command of this period may switch the servo on until the next one, which switches
            // it off again.
            assert_eq!(output.drive.pwm, 0, "no supply, no drive");
        }
        if self.follows {
            // As far as commanded, without delay; or as far as driven.
            let axis = module.axis();
            let ahead = axis.commanded().wrapping_sub(axis.position());
            self.counts = self.counts.wrapping_add(ahead);
        }
    }
}

impl Bounds {
    /// Checks a drive, before the order of this period is applied.
    fn check(&mut self, module: &ServoModule, drive: u8) {
        let most = self.output_limit.max(self.started).max(self.held);
        assert!(drive <= most, "{drive} above {most}");
        if module.axis().status().is_on {
            self.started = 0;
        }
        self.held_periods = self.held_periods.saturating_sub(1);
        if self.held_periods == 0 {
            self.held = 0;
        }
    }

    /// Checks a period without an order. An order might have switched the servo on after its error
    /// was evaluated, or changed its position.
    fn check_error(&self, module: &ServoModule) {
        let axis = module.axis();
        if axis.status().is_on && self.rate_divisor <= 1 && self.held_periods == 0 {
            let error = axis.commanded().wrapping_sub(axis.position());
            let most = self.error_limit;
            assert!(error.unsigned_abs() <= most, "{error} counts of {most}");
        }
    }

    fn follow(&mut self, order: Order) {
        match order {
            Order::Servo(Command::SetGain(gains)) => {
                self.held = self.held.max(self.output_limit);
                self.held_periods = self.held_periods.max(self.rate_divisor);
                self.output_limit = gains.output_limit;
                self.error_limit = gains.error_limit.min(0x7FFF).into();
                self.rate_divisor = gains.rate_divisor;
            }
            Order::Servo(Command::LoadTrajectory(load)) => {
                self.duty = load.pwm.unwrap_or(self.duty);
                self.is_duty_loaded = load.mode == Mode::Pwm;
                if load.start_now {
                    self.start();
                }
            }
            Order::Servo(Command::StartMotion) => self.start(),
            Order::Reset(_) => *self = Self::default(),
            _ => {}
        }
    }

    fn start(&mut self) {
        if self.is_duty_loaded {
            (self.started, self.is_duty_loaded) = (self.duty, false);
        }
    }
}

/// Switches the servo on and runs a trapezoid from the present position: it stays between both
/// ends.
fn trapezoid(module: &mut ServoModule, bench: &mut Bench, bytes: &mut Bytes<'_>) {
    let say = |module: &mut ServoModule, command: Command| {
        let address = module.link().address();
        module.link().forget_partial();
        for byte in command.frame(address).bytes() {
            module.link().push(*byte);
        }
    };
    let gains = Gains {
        proportional: 100,
        error_limit: 0x3FFF,
        output_limit: 255,
        rate_divisor: 1,
        ..Gains::default()
    };
    (bench.follows, bench.inputs.has_power) = (true, true);
    bench.tick(module);
    let on = Stop {
        amplifier: true,
        mode: Some(StopMode::Abrupt),
    };
    for command in [
        Command::SetHoming(Homing::default()),
        Command::SetGain(gains),
        Command::StopMotor(on),
        Command::ResetPosition(Reset::Zero),
    ] {
        say(module, command);
        bench.tick(module);
    }
    let goal = bytes.i32().max(-i32::MAX);
    let velocity = bytes.i32() as u32 & 0x7FFF_FFFF;
    let acceleration = bytes.i32() as u32 & 0x7FFF_FFFF;
    say(
        module,
        Command::LoadTrajectory(Trajectory {
            position: Some(goal),
            velocity: Some(velocity),
            acceleration: Some(acceleration),
            mode: Mode::Trapezoid,
            start_now: true,
            ..Trajectory::default()
        }),
    );
    let begin = module.axis().commanded();
    // The search is armed together with the move, so that the switch may close in any period of it.
    let switch_at = bytes.byte() % (2 * PERIODS);
    bench.tick(module);
    let search = Homing::LIMIT_1.with(Homing::ABRUPT);
    say(module, Command::SetHoming(search));
    let mut stopped = None;
    for period in 0..PERIODS {
        let was_searching = module.axis().status().is_searching;
        if period == switch_at {
            bench.inputs.limit_1 ^= true;
        }
        bench.tick(module);
        if was_searching && period == switch_at {
            assert!(!module.axis().status().is_searching, "the switch was met");
            stopped = Some(module.axis().home());
        }
        assert!(stopped.is_none_or(|at| at == module.axis().commanded()));
        let commanded = module.axis().commanded();
        assert!(
            (begin.min(goal)..=begin.max(goal)).contains(&commanded),
            "{commanded} on the way from {begin} to {goal}"
        );
    }
}

/// A packet with one wrong byte.
fn damaged(module: &mut ServoModule, bytes: &mut Bytes<'_>) {
    let address = module.link().address();
    let frame = command(bytes).frame(address);
    let length = frame.bytes().len();
    // Not the header or the length, after which other bytes would form the packet.
    let place = length - 1 - usize::from(bytes.byte()) % (length - 3).max(1);
    let wrong = bytes.byte().max(1);
    module.link().forget_partial();
    for (at, byte) in frame.bytes().iter().enumerate() {
        let heard = if at == place { byte ^ wrong } else { *byte };
        module.link().push(heard);
    }
}

fn command(bytes: &mut Bytes<'_>) -> Command {
    match bytes.byte() % 14 {
        0 => Command::ResetPosition(Reset::Zero),
        1 => Command::ResetPosition(
            [Reset::Home, Reset::To(bytes.i32())][usize::from(bytes.byte() & 1)],
        ),
        2 => Command::SetAddress {
            address: bytes.byte() % 33,
            group: Group {
                address: bytes.byte() | 0x80,
                is_leader: bytes.byte() & 1 == 0,
            },
        },
        3 => Command::DefineStatus(Items(bytes.byte())),
        4 => Command::ReadStatus(Items(bytes.byte())),
        5 | 6 => Command::LoadTrajectory(load(bytes)),
        7 => Command::StartMotion,
        8 => Command::SetGain(Gains {
            proportional: bytes.i32() as u16,
            derivative: bytes.i32() as u16,
            integral: bytes.i32() as u16,
            integration_limit: bytes.i32() as u16,
            output_limit: bytes.byte(),
            current_limit: bytes.byte(),
            error_limit: bytes.i32() as u16,
            rate_divisor: bytes.byte(),
            dead_band: bytes.byte(),
            ..Gains::default()
        }),
        9 | 10 => Command::StopMotor(Stop {
            amplifier: bytes.byte() & 3 != 0,
            mode: [
                None,
                Some(StopMode::Off),
                Some(StopMode::Abrupt),
                Some(StopMode::Smooth),
                Some(StopMode::Here(bytes.i32())),
            ][usize::from(bytes.byte() % 5)],
        }),
        11 => Command::SetHoming(Homing(bytes.byte())),
        12 => [Command::ClearBits, Command::SaveHome][usize::from(bytes.byte() & 1)],
        _ => [
            Command::HardReset(None),
            Command::SetBaud(Baud::B115200),
            Command::NoOperation,
        ][usize::from(bytes.byte() % 3)],
    }
}

fn load(bytes: &mut Bytes<'_>) -> Trajectory {
    let fields = bytes.byte();
    Trajectory {
        position: (fields & 1 != 0).then(|| bytes.i32()),
        velocity: (fields & 2 != 0).then(|| bytes.i32() as u32),
        acceleration: (fields & 4 != 0).then(|| bytes.i32() as u32),
        pwm: (fields & 8 != 0).then(|| bytes.byte()),
        mode: [Mode::Trapezoid, Mode::Velocity, Mode::Pwm][usize::from(bytes.byte() % 3)],
        reverse: fields & 0x40 != 0,
        start_now: fields & 0x80 != 0,
    }
}
