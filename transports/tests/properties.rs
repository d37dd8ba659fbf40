//! What holds for every command, reply, byte stream and line.

mod model;

use husillo_transports::nmc::{
    Auxiliary, Baud, Command, Failure, Finding, Frame, Gains, Group, Homing, Host, Items, Mode,
    Module, Order, Outcome, PathPoints, Readings, Receiver, Repeat, Reply, Reset, Status, Step,
    Stop, StopMode, Timing, Trajectory, Verdict, flush_byte,
};
use husillo_transports::rs485::{Echo, Heard};
use model::{Fault, Line};
use proptest::prelude::*;
use proptest::sample::select;

fn trajectory() -> impl Strategy<Value = Trajectory> {
    (
        any::<Option<i32>>(),
        any::<Option<u32>>(),
        any::<Option<u32>>(),
        any::<Option<u8>>(),
        select(vec![Mode::Trapezoid, Mode::Velocity, Mode::Pwm]),
        any::<bool>(),
        any::<bool>(),
    )
        .prop_map(
            |(position, velocity, acceleration, pwm, mode, reverse, start_now)| Trajectory {
                position,
                velocity,
                acceleration,
                pwm,
                mode,
                reverse,
                start_now,
            },
        )
}

fn gains() -> impl Strategy<Value = Gains> {
    (any::<[u16; 5]>(), any::<[u8; 4]>(), any::<Option<u8>>()).prop_map(
        |(words, bytes, step_multiplier)| Gains {
            proportional: words[0],
            derivative: words[1],
            integral: words[2],
            integration_limit: words[3],
            output_limit: bytes[0],
            current_limit: bytes[1],
            error_limit: words[4],
            rate_divisor: bytes[2],
            dead_band: bytes[3],
            step_multiplier,
        },
    )
}

/// Any command of version 10.
fn command() -> impl Strategy<Value = Command> {
    let mode = prop_oneof![
        Just(None),
        Just(Some(StopMode::Off)),
        Just(Some(StopMode::Abrupt)),
        Just(Some(StopMode::Smooth)),
        any::<i32>().prop_map(|position| Some(StopMode::Here(position))),
    ];
    prop_oneof![
        prop_oneof![
            Just(Reset::Zero),
            Just(Reset::Home),
            any::<i32>().prop_map(Reset::To)
        ]
        .prop_map(Command::ResetPosition),
        (0_u8..0x80, 0x80_u8.., any::<bool>()).prop_map(|(address, group, is_leader)| {
            Command::SetAddress {
                address,
                group: Group {
                    address: group,
                    is_leader,
                },
            }
        }),
        any::<u8>().prop_map(|items| Command::DefineStatus(Items(items))),
        any::<u8>().prop_map(|items| Command::ReadStatus(Items(items))),
        trajectory().prop_map(Command::LoadTrajectory),
        Just(Command::StartMotion),
        gains().prop_map(Command::SetGain),
        (any::<bool>(), mode)
            .prop_map(|(amplifier, mode)| Command::StopMotor(Stop { amplifier, mode })),
        any::<u8>().prop_map(Command::IoControl),
        any::<u8>().prop_map(|bits| Command::SetHoming(Homing(bits))),
        select(Baud::ALL.to_vec()).prop_map(Command::SetBaud),
        Just(Command::ClearBits),
        Just(Command::SaveHome),
        proptest::collection::vec(any::<u16>(), 0..8)
            .prop_map(|points| Command::AddPathPoints(PathPoints::new(&points))),
        Just(Command::NoOperation),
        any::<Option<u8>>().prop_map(Command::HardReset),
    ]
}

fn readings() -> impl Strategy<Value = Readings> {
    (any::<[i32; 2]>(), any::<[i16; 2]>(), any::<[u8; 3]>()).prop_map(|(longs, words, bytes)| {
        Readings {
            position: longs[0],
            home: longs[1],
            velocity: words[0],
            position_error: words[1],
            current: bytes[0],
            auxiliary: Auxiliary(bytes[1]),
            path_points: bytes[2],
            kind: 0,
            version: 10,
        }
    })
}

fn addressed(version: u8, address: u8) -> Module {
    let mut module = Module::new(version);
    module.set_enabled(true);
    let command = Command::SetAddress {
        address,
        group: Group::NONE,
    };
    command
        .frame(0)
        .bytes()
        .iter()
        .for_each(|byte| module.push(*byte));
    assert_eq!(module.take(), None);
    module
}

/// The packets in a stream that follow the rules, found without the state machine of the receiver:
/// (address, code, data, valid).
fn packets(stream: &[u8]) -> Vec<(u8, u8, Vec<u8>, bool)> {
    let mut found = Vec::new();
    let mut rest = stream;
    while let Some(start) = rest.iter().position(|byte| *byte == 0xAA) {
        let packet = &rest[start..];
        let Some(command) = packet.get(2) else { break };
        let length = usize::from(command >> 4);
        let Some(sum) = packet.get(3 + length) else {
            break;
        };
        let body = &packet[1..3 + length];
        let computed = body.iter().fold(0_u8, |sum, byte| sum.wrapping_add(*byte));
        found.push((
            packet[1],
            command & 15,
            packet[3..3 + length].to_vec(),
            *sum == computed,
        ));
        rest = &packet[4 + length..];
    }
    found
}

proptest! {
    /// What is written is read as the same command, and its packet has the length that its third
    /// byte states.
    #[test]
    fn commands_survive_the_line(command in command(), address: u8) {
        let frame = command.frame(address);
        let mut receiver = Receiver::new();
        let mut verdicts = frame.bytes().iter().map(|byte| receiver.push(*byte));
        prop_assert!(
            verdicts.by_ref().take(frame.bytes().len() - 1).all(|verdict| verdict.is_none())
        );
        prop_assert_eq!(verdicts.next(), Some(Some(Verdict::Sound)));
        drop(verdicts);
        prop_assert_eq!(receiver.address(), address);
        prop_assert_eq!(Command::decode(receiver.code(), receiver.data(), 10), Some(command));
    }

    /// What a module tells is what the host reads, item by item.
    #[test]
    fn replies_survive_the_line(readings in readings(), status: u8, items: u8) {
        let mut module = addressed(10, 1);
        let request = Command::ReadStatus(Items(items)).frame(1);
        request.bytes().iter().for_each(|byte| module.push(*byte));
        prop_assert_eq!(module.take(), None);
        module.reply(Status(status), &readings);
        let told: Vec<u8> = std::iter::from_fn(|| module.transmit()).collect();
        prop_assert_eq!(told.len(), Items(items).length() + 2);
        let reply = Reply::decode(&told, Items(items)).expect("a sound reply");
        prop_assert_eq!(reply.status.0, status & !Status::CHECKSUM_ERROR.0);
        for (item, is_equal) in [
            (Items::POSITION, reply.readings.position == readings.position),
            (Items::CURRENT, reply.readings.current == readings.current),
            (Items::VELOCITY, reply.readings.velocity == readings.velocity),
            (Items::AUXILIARY, reply.readings.auxiliary == readings.auxiliary),
            (Items::HOME, reply.readings.home == readings.home),
            (Items::DEVICE, (reply.readings.kind, reply.readings.version) == (0, 10)),
            (Items::POSITION_ERROR, reply.readings.position_error == readings.position_error),
            (Items::PATH_POINTS, reply.readings.path_points == readings.path_points),
        ] {
            prop_assert!(is_equal || !Items(items).contains(item), "{:?}", item);
        }
    }

    /// Any stream, taken at any moments: the orders are exactly those of its valid packets for this
    /// module, each once and in order. Of packets that end before the last one was taken, none is
    /// half taken.
    #[test]
    fn every_order_has_a_sound_packet(
        stream in proptest::collection::vec(
            prop_oneof![Just(0xAA_u8), 0_u8..4, any::<u8>()],
            0..400,
        ),
        commands in proptest::collection::vec((command(), any::<prop::sample::Index>()), 0..6),
    ) {
        let mut stream = stream;
        for (command, place) in commands {
            let place = place.index(stream.len() + 1);
            let frame = command.frame(1);
            stream.splice(place..place, frame.bytes().iter().copied());
        }
        let mut module = addressed(10, 1);
        let mut taken = Vec::new();
        for byte in &stream {
            module.push(*byte);
            if let Some(Order::Servo(command)) = module.take() {
                taken.push(command);
            }
            module.reply(Status(0), &Readings::default());
            if module.address() != 1 || module.group() != Group::NONE {
                break; // another address from here on
            }
        }
        let sound: Vec<Command> = packets(&stream)
            .into_iter()
            .filter(|(address, .., sound)| *sound && (*address == 1 || *address == 0xFF))
            .filter_map(|(_, code, data, _)| Command::decode(code, &data, 10))
            .filter(|command| !matches!(
                command,
                Command::SetAddress { .. } | Command::DefineStatus(_) | Command::ReadStatus(_)
                    | Command::NoOperation | Command::SetBaud(_) | Command::HardReset(_)
            ))
            .collect();
        prop_assert!(sound.starts_with(&taken), "{taken:?} of {sound:?}");
    }

    /// One wrong bit anywhere in a packet that the host sends makes no other command of it. The
    /// flush after it, or after a lost, doubled or cut byte, completes none.
    #[test]
    fn no_single_fault_makes_another_command(
        command in command(),
        address in 1_u8..=32,
        place: prop::sample::Index,
        kind in 0_u8..11,
    ) {
        let frame = command.frame(address);
        let place = place.index(frame.bytes().len());
        // A whole packet in the data, laid bare by a lost header: see the documentation.
        prop_assume!(!frame.bytes()[1..].contains(&0xAA));
        let mut stream = Vec::new();
        for (number, byte) in frame.bytes().iter().enumerate() {
            match kind {
                _ if number != place => stream.push(*byte),
                bit @ 0..=7 => stream.push(byte ^ (1 << bit)),
                8 => {}
                9 => stream.extend([*byte, *byte]),
                _ => break,
            }
        }
        let whole = stream.starts_with(frame.bytes());
        let exact = stream.len();
        stream.extend([flush_byte(&frame); 20]);
        let mut receiver = Receiver::new();
        for (number, byte) in stream.iter().enumerate() {
            if receiver.push(*byte) == Some(Verdict::Sound) && !whole {
                let of_shorter = number < exact;
                let heard = Command::decode(receiver.code(), receiver.data(), 10);
                let refused = command.repeat(address) == Repeat::Free
                    || Host::new(
                        Timing::patient(Baud::B19200)
                    ).send_command(address, command, 0).is_err();
                prop_assert!(
                    heard.is_none() || (of_shorter && refused),
                    "{heard:?} of {command:?}",
                );
            }
        }
    }

    /// A host that hears anything at any time ends every step in bounded time, without a panic.
    #[test]
    fn a_host_survives_any_bytes(
        command in command(),
        address in 0_u8..=32,
        bytes in proptest::collection::vec((any::<u8>(), 0_u32..100_000), 0..300),
    ) {
        let mut host = Host::new(Timing::prompt(Baud::B115200, 512));
        host.adopt(address.max(1), Items::POSITION, Group { address: 0x81, is_leader: true });
        if host.send_command(address, command, 0).is_err() {
            return Ok(());
        }
        let mut now_us = u32::MAX - 10_000; // across the wrap
        let mut noise = bytes.into_iter();
        for _ in 0..3000 {
            if let husillo_transports::nmc::Progress::Done(_) = host.poll(now_us) {
                return Ok(());
            }
            while host.transmit(now_us).is_some() {}
            let (byte, later_us) = noise.next().map_or(
                (None, 50_000),
                |(byte, later)| (Some(byte), later),
            );
            now_us = now_us.wrapping_add(later_us);
            if let Some(byte) = byte {
                host.push(byte, now_us);
            }
        }
        prop_assert!(false, "the host hangs");
    }

    /// Whatever is lost, flipped or doubled, up to one byte in ten: a command that must not be
    /// executed twice is not, and the report of the host is true.
    #[test]
    fn retries_execute_nothing_twice(
        commands in proptest::collection::vec(
            prop_oneof![
                Just(Command::ResetPosition(Reset::Zero)),
                Just(Command::SaveHome),
                Just(Command::SetHoming(Homing::INDEX)),
                Just(Command::AddPathPoints(PathPoints::new(&[4, 8]))),
                (1_i32..5000).prop_map(|by| Command::LoadTrajectory(Trajectory {
                    position: Some(by),
                    mode: Mode::Trapezoid,
                    reverse: true, // relative
                    start_now: true,
                    ..Trajectory::default()
                })),
            ],
            1..5,
        ),
        faults in proptest::collection::vec((any::<bool>(), 0_u64..250, 0_u8..3), 0..25),
    ) {
        let mut line = Line::new(1, 10);
        let mut host = Host::new(Timing::prompt(Baud::B115200, 512));
        let address = Command::SetAddress { address: 1, group: Group::NONE };
        line.do_step(&mut host, Step::Request { address: 0, command: address });
        let device = Command::ReadStatus(Items::DEVICE);
        line.do_step(&mut host, Step::Request { address: 1, command: device });
        line.modules[0].1.position = 20_000;
        line.modules[0].1.home = 777;
        let (sent, told) = (line.sent, line.told);
        for command in commands {
            line.modules[0].1.finish();
            let servo = &line.modules[0].1;
            let is_so_already = match command {
                Command::SaveHome => servo.home == servo.position,
                Command::ResetPosition(_) => servo.position == 0,
                _ => false,
            };
            let before = line.modules[0].1.executed.len();
            let outcome =
                line.run(&mut host, Step::Request { address: 1, command }, &mut |is_reply, number| {
                let first = if is_reply { told } else { sent };
                let kind = faults.iter().find(
                    |(on_reply, place, _)| *on_reply == is_reply && *place + first == number
                )?.2;
                Some(match kind {
                    0 => Fault::Lost,
                    1 => Fault::Flipped((number % 8) as u8),
                    _ => Fault::Doubled,
                })
            });
            let done = line.modules[0].1.executed.len() - before;
            if is_so_already {
                continue; // saying it twice changes nothing
            }
            prop_assert!(done <= 1, "{command:?} {done} times");
            match outcome {
                Outcome::Answered(_) | Outcome::Confirmed(_) => prop_assert_eq!(done, 1),
                Outcome::Failed(Failure::Uncertain) => {}
                Outcome::Failed(_) => prop_assert_eq!(done, 0, "{:?}: {:?}", command, outcome),
                Outcome::Sent => prop_assert!(false, "it answers"),
            }
        }
    }

    /// Two equal readings never say that a command was executed that changes them.
    #[test]
    fn equal_readings_prove_no_execution(command in command(), readings in readings(), status: u8) {
        let reply = Reply { status: Status(status), items: Items(0xFF), readings };
        if command != Command::AddPathPoints(PathPoints::default()) {
            prop_assert_ne!(command.finding(&reply, &reply), Finding::Executed);
        }
    }

    /// Own bytes are dropped in order, other bytes in between come through, and a wrong one is a
    /// collision.
    #[test]
    fn echoes_are_dropped(
        message in proptest::collection::vec(any::<u8>(), 1..40),
        wrong: Option<prop::sample::Index>,
    ) {
        let mut echo = Echo::<4>::new(true);
        let wrong = wrong.map(|index| index.index(message.len()));
        let mut heard = message.iter().enumerate();
        for byte in &message {
            while !echo.sent(*byte) {
                let (place, own) = heard.next().expect("what is sent is heard");
                if wrong == Some(place) {
                    prop_assert_eq!(echo.received(!own), Heard::Collision);
                    prop_assert_eq!(
                        echo.received(1),
                        Heard::Foreign(1),
                        "nothing is expected after it",
                    );
                    return Ok(());
                }
                prop_assert_eq!(echo.received(*own), Heard::Echo);
            }
        }
        prop_assert!(!echo.silence());
        prop_assert!(echo.silence());
    }
}

/// Frames of too much data are cut, never longer than 19 bytes.
#[test]
fn no_frame_is_too_long() {
    assert_eq!(Frame::new(1, 0xFF, &[7; 40]).bytes().len(), 19);
    assert_eq!(PathPoints::new(&[1; 40]).points().len(), 7);
}
