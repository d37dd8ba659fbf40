//! The worked examples of the protocol, and packets of other clients and of real hardware.

mod model;

use husillo_transports::nmc::{
    Auxiliary, Baud, Command, Frame, Gains, Group, Homing, Items, Mode, Receiver, Reply, Reset,
    Status, Stop, StopMode, Trajectory, Verdict,
};
use model::Line;

fn bytes(hex: &str) -> Vec<u8> {
    let digits: Vec<u8> = hex
        .bytes()
        .filter(|digit| *digit != b' ')
        .map(|digit| (digit as char).to_digit(16).expect("hexadecimal") as u8)
        .collect();
    digits
        .chunks(2)
        .map(|pair| pair[0] << 4 | pair[1])
        .collect()
}

/// The command of a whole packet, and its address.
fn parse(packet: &[u8]) -> Option<(u8, Command)> {
    let mut receiver = Receiver::new();
    let mut verdict = None;
    for byte in packet {
        assert_eq!(verdict, None, "the packet ends with its last byte");
        verdict = receiver.push(*byte);
    }
    if verdict != Some(Verdict::Sound) {
        return None;
    }
    let command = Command::decode(receiver.code(), receiver.data(), 4)?;
    Some((receiver.address(), command))
}

/// A conversation with two modules of version 4: request, reply, whether the motion then ends.
const CONVERSATION: [(&str, &str); 37] = include!("data/nmc_conversation.rs");

#[test]
fn the_worked_examples_are_answered_byte_by_byte() {
    let mut line = Line::new(2, 4);
    for (request, reply) in CONVERSATION {
        let ends = reply.ends_with("end");
        let reply = bytes(reply.trim_end_matches("end"));
        assert_eq!(line.exchange(&bytes(request)), reply, "{request}");
        if ends {
            line.modules
                .iter_mut()
                .for_each(|(_, servo)| servo.finish());
        }
    }
    let (far, near) = (&line.modules[0], &line.modules[1]);
    assert!(
        near.1.all.contains(&Command::StartMotion),
        "both of the group start"
    );
    assert_eq!((far.0.address(), near.0.address()), (0, 2), "reset and not");
}

/// The requests of the conversation, as commands.
#[test]
fn the_worked_examples_are_written_byte_by_byte() {
    let load = Trajectory {
        position: Some(-500),
        velocity: Some(65536),
        acceleration: Some(1000),
        mode: Mode::Trapezoid,
        ..Trajectory::default()
    };
    let gains = Gains {
        proportional: 100,
        derivative: 1000,
        output_limit: 255,
        error_limit: 4000,
        rate_divisor: 1,
        ..Gains::default()
    };
    let real_gains = Gains {
        proportional: 200,
        derivative: 1200,
        integral: 150,
        integration_limit: 15,
        output_limit: 75,
        error_limit: 4000,
        rate_divisor: 5,
        ..Gains::default()
    };
    let velocity = Trajectory {
        velocity: Some(67109),
        acceleration: Some(137),
        mode: Mode::Velocity,
        reverse: true,
        start_now: true,
        ..Trajectory::default()
    };
    let duty = Trajectory {
        pwm: Some(128),
        reverse: true,
        start_now: true,
        ..Trajectory::default()
    };
    let address = |address, group, is_leader| Command::SetAddress {
        address,
        group: Group {
            address: group,
            is_leader,
        },
    };
    let stop = |mode| {
        Command::StopMotor(Stop {
            amplifier: true,
            mode,
        })
    };
    let examples = [
        (0xFF, Command::HardReset(None), "aa ff 0f 0e"),
        (0, address(1, 0xFF, false), "aa 00 21 01 ff 21"),
        (0, address(2, 0xFF, false), "aa 00 21 02 ff 22"),
        (0, address(3, 0xFF, false), "aa 00 21 03 ff 23"),
        (1, Command::ReadStatus(Items::DEVICE), "aa 01 13 20 34"),
        (1, Command::NoOperation, "aa 01 0e 0f"),
        (0xFF, Command::SetBaud(Baud::B57600), "aa ff 1a 14 2d"),
        (
            1,
            Command::SetGain(gains),
            "aa 01 e6 64 00 e8 03 00 00 00 00 ff 00 a0 0f 01 00 e5",
        ),
        (
            1,
            Command::SetGain(real_gains),
            "aa 01 e6 c8 00 b0 04 96 00 0f 00 4b 00 a0 0f 05 00 07",
        ),
        (1, stop(Some(StopMode::Off)), "aa 01 17 03 1b"),
        (1, stop(Some(StopMode::Abrupt)), "aa 01 17 05 1d"),
        (1, stop(None), "aa 01 17 01 19"),
        (1, Command::ClearBits, "aa 01 0b 0c"),
        (1, Command::ResetPosition(Reset::Zero), "aa 01 00 01"),
        (1, Command::DefineStatus(Items(0x1F)), "aa 01 12 1f 32"),
        (1, Command::DefineStatus(Items::NONE), "aa 01 12 00 13"),
        (1, Command::IoControl(0x0C), "aa 01 18 0c 25"),
        (
            1,
            Command::LoadTrajectory(load),
            "aa 01 d4 17 0c fe ff ff 00 00 01 00 e8 03 00 00 e0",
        ),
        (1, Command::StartMotion, "aa 01 05 06"),
        (1, Command::ReadStatus(Items(0x0D)), "aa 01 13 0d 21"),
        (1, Command::SetHoming(Homing::INDEX), "aa 01 19 08 22"),
        (
            1,
            Command::SetHoming(Homing::INDEX.with(Homing::SMOOTH)),
            "aa 01 19 28 42",
        ),
        (
            1,
            Command::LoadTrajectory(velocity),
            "aa 01 94 f6 25 06 01 00 89 00 00 00 40",
        ),
        (1, stop(Some(StopMode::Smooth)), "aa 01 17 09 21"),
        (
            1,
            stop(Some(StopMode::Here(1000))),
            "aa 01 57 11 e8 03 00 00 54",
        ),
        (1, Command::LoadTrajectory(duty), "aa 01 24 c8 80 6d"),
        (1, Command::SaveHome, "aa 01 0c 0d"),
        (1, address(1, 0x81, true), "aa 01 21 01 01 24"),
        (2, address(2, 0x81, false), "aa 02 21 02 81 a6"),
        (0x81, Command::NoOperation, "aa 81 0e 8f"),
        (0x81, Command::StartMotion, "aa 81 05 86"),
        (1, Command::HardReset(None), "aa 01 0f 10"),
    ];
    for (to, command, packet) in examples {
        let packet = bytes(packet);
        assert_eq!(command.frame(to).bytes(), packet, "{command:?}");
        assert_eq!(parse(&packet), Some((to, command)));
        assert!(command.is_in_range(4));
    }
}

/// Requests recorded from real clients, and made by the vendor's library.
#[test]
fn packets_of_other_clients_are_understood_and_written_alike() {
    for packet in [
        "aa002101ff21",
        "aa01132034",
        "aaff1a142d",
        "aa01121f32",
        "aa0117021a",
        "aa0117041c",
        "aa01170119",
        "aa010b0c",
        "aa010001",
        "aa01192842",
        "aa01e6c800b00496000f004b00a00f050007",
        "aa01e605006400000000003200e80301006e",
        "aa0194b61283000012010000f3",
        "aa01e66400e80300000000ff00a00f0100e5",
        "aa0117031b",
        "aa0117051d",
        "aa01190822",
        "aa01d497c4090000a086010064000000c4",
        "aa8105 86",
    ] {
        let packet = bytes(packet);
        let (address, command) = parse(&packet).expect("a command");
        assert_eq!(command.frame(address).bytes(), packet);
    }
    // A divisor that is one more than the original's.
    assert_eq!(
        parse(&bytes("aaff1a152e")),
        Some((0xFF, Command::SetBaud(Baud::B57600)))
    );
}

/// A reply of a real module, items 0x1F.
#[test]
fn a_real_reply_is_read() {
    let items = Items(0x1F);
    let reply =
        Reply::decode(&bytes("11 22 25 00 00 4f 00 00 18 e0 05 00 00 a4"), items).expect("a reply");
    assert_eq!(reply.status, Status(0x11));
    assert_eq!(reply.position(), Some(0x2522));
    assert_eq!(reply.readings.current, 0x4F);
    assert_eq!(reply.velocity(), Some(0));
    assert_eq!(reply.auxiliary(), Some(Auxiliary(0x18)));
    assert_eq!(reply.home(), Some(0x5E0));
    assert_eq!(items.length(), 12);
}

/// A client that sums wrongly, to a module at address 1: nothing is executed.
#[test]
fn the_wrong_sum_of_a_real_client_is_refused() {
    let mut line = Line::new(1, 4);
    line.exchange(&bytes("aa 00 21 01 ff 21"));
    let told = line.exchange(&bytes("aa01d49700000000c3f52800d71a000049"));
    assert_eq!(told, bytes("1b 1b"));
    assert!(line.modules[0].1.all.is_empty());
    line.exchange(&bytes("aa01d49700000000c3f52800d71a00003d"));
    assert_eq!(line.modules[0].1.all.len(), 1);
}

/// Packets for modules with inputs and outputs share the framing.
#[test]
fn packets_for_other_modules_are_followed() {
    for packet in ["aa 02 20 ff 0f 30", "aa 02 26 20 00 48", "aa 02 12 03 17"] {
        let packet = bytes(packet);
        let frame = Frame::new(packet[1], packet[2], &packet[3..packet.len() - 1]);
        assert_eq!(frame.bytes(), packet);
    }
    let mut line = Line::new(1, 4);
    line.exchange(&bytes("aa 00 21 01 ff 21"));
    assert_eq!(line.exchange(&bytes("aa 02 26 aa 01 d3")), []);
    assert_eq!(line.exchange(&bytes("aa 01 0e 0f")), bytes("19 19"));
}

#[test]
fn unknown_commands_and_wrong_lengths_are_answered_and_not_executed() {
    let mut line = Line::new(1, 4);
    line.exchange(&bytes("aa 00 21 01 ff 21"));
    for (code, data) in [
        (0xD, &[1, 2][..]), // path points are of version 5
        (0x5, &[1][..]),
        (0x4, &[0x97, 1, 2][..]),
        (0x7, &[0x11][..]),
        (0x7, &[0x01, 0, 0, 0, 0][..]),
        (0x1, &[0x80, 0xFF][..]), // an individual address of groups
        (0xA, &[99][..]),
    ] {
        let told = line.exchange(Frame::new(1, code, data).bytes());
        assert_eq!(told, bytes("19 19"), "{code:x} {data:?}");
    }
    assert!(line.modules[0].1.all.is_empty());
}

#[test]
fn any_byte_stops_a_reply() {
    let mut line = Line::new(1, 4);
    let request = Command::ReadStatus(Items(0x1F)).frame(0);
    request.bytes().iter().for_each(|byte| line.hear(*byte));
    line.cycle();
    assert_eq!(line.tell(), Some(0x19));
    assert!(line.modules[0].0.is_sending());
    line.hear(0);
    assert!(!line.modules[0].0.is_sending());
    assert_eq!(line.tell(), None);
}
