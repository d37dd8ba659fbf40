//! Servo modules with motors on a simulated line, commanded byte by byte.

mod common;

use common::{ask, switch_on};
use husillo_sim::{DcMotorModel, ServoNetwork, Surroundings};
use husillo_transports::nmc::{Command, Gains, Group, Homing, Items, Mode, Status, Trajectory};

fn run(network: &mut ServoNetwork, periods: u32) {
    for _ in 0..periods {
        network.tick();
    }
}

/// Sets addresses and gains that suit the prototype motor, and switches the servos on.
fn started(modules: usize) -> ServoNetwork {
    started_with(&vec![4; modules])
}

fn started_with(versions: &[u8]) -> ServoNetwork {
    let mut network = ServoNetwork::new(versions, DcMotorModel::PROTOTYPE);
    for address in 1..=versions.len() as u8 {
        let set = Command::SetAddress {
            address,
            group: Group::NONE,
        };
        assert_eq!(ask(&mut network, 0, set), [0x19, 0x19], "module {address}");
        let gains = Gains {
            proportional: 1000,
            derivative: 8000,
            integral: 100,
            integration_limit: 8000,
            output_limit: 255,
            error_limit: 4000,
            rate_divisor: 1,
            ..Gains::default()
        };
        let reply = switch_on(&mut network, address, gains);
        assert_eq!(reply, [0x09, 0x09], "module {address} holds its place");
    }
    network
}

fn trapezoid(goal: i32) -> Command {
    Command::LoadTrajectory(Trajectory {
        position: Some(goal),
        velocity: Some(40_000),
        acceleration: Some(100),
        mode: Mode::Trapezoid,
        start_now: true,
        ..Trajectory::default()
    })
}

#[test]
fn a_move_ends_within_a_count() {
    let mut network = started(2);
    for (goal, address) in [(1000, 1), (-777, 2), (0, 1), (12_345, 2)] {
        ask(&mut network, address, trapezoid(goal));
        run(&mut network, 80_000);
        let axis = network.axis(usize::from(address) - 1).unwrap();
        assert!(axis.status().is_done && axis.status().is_on);
        assert!(
            (axis.position() - goal).abs() <= 1,
            "{} for {goal}",
            axis.position()
        );
    }
    // The other one has not moved.
    assert!((network.axis(0).unwrap().position()).abs() <= 1);
}

#[test]
fn version_4_begins_a_trapezoid_from_standstill_only() {
    for (version, goes_to) in [(4, 1000), (5, -1000)] {
        let mut network = started_with(&[version]);
        ask(&mut network, 1, trapezoid(1000));
        run(&mut network, 500);
        assert!(!network.axis(0).unwrap().status().is_done);
        ask(&mut network, 1, trapezoid(-1000));
        run(&mut network, 10_000);
        let at = network.axis(0).unwrap().commanded();
        assert_eq!(at, goes_to, "version {version}");
        // The motion has waited in the buffer.
        ask(&mut network, 1, Command::StartMotion);
        run(&mut network, 10_000);
        assert_eq!(network.axis(0).unwrap().commanded(), -1000);
    }
}

#[test]
fn a_contact_stores_where_it_was_and_stops() {
    let mut network = started(1);
    let forward = Command::LoadTrajectory(Trajectory {
        velocity: Some(20_000),
        acceleration: Some(100),
        mode: Mode::Velocity,
        start_now: true,
        ..Trajectory::default()
    });
    let search = Homing(Homing::LIMIT_1.0 | Homing::SMOOTH.0);
    let reply = ask(&mut network, 1, Command::SetHoming(search));
    assert_eq!(Status(reply[0]).0 & Status::HOME_IN_PROGRESS.0, 0x80);
    ask(&mut network, 1, forward);
    run(&mut network, 2000);
    let at = network.axis(0).unwrap().position();
    network.surround(
        0,
        Surroundings {
            limit_1: true,
            ..Surroundings::default()
        },
    );
    run(&mut network, 4000);
    let axis = network.axis(0).unwrap();
    assert!(
        (axis.home() - at).abs() <= 1,
        "the home position is that of the contact: {} for {at}",
        axis.home()
    );
    assert!(
        axis.position() > at && axis.status().is_done,
        "it ran on, and stopped"
    );
    let reply = ask(&mut network, 1, Command::ReadStatus(Items::HOME));
    assert_eq!(reply[1..5], axis_home_bytes(&network));
}

fn axis_home_bytes(network: &ServoNetwork) -> [u8; 4] {
    network.axis(0).unwrap().home().to_le_bytes()
}

#[test]
fn a_blocked_axis_gives_up() {
    let mut network = started(1);
    network.surround(
        0,
        Surroundings {
            load_nm: 10.0,
            ..Surroundings::default()
        },
    );
    ask(&mut network, 1, trapezoid(100_000));
    run(&mut network, 40_000);
    let status = network.axis(0).unwrap().status();
    assert!(status.position_error && !status.is_on);
}

#[test]
fn a_damaged_packet_moves_nothing() {
    let mut network = started(1);
    let frame = trapezoid(5000).frame(1);
    let mut bytes = frame.bytes().to_vec();
    bytes[5] ^= 0x10;
    for byte in bytes {
        network.send(byte);
    }
    let reply: Vec<u8> = (0..100).flat_map(|_| network.tick()).collect();
    assert_eq!(Status(reply[0]).0 & Status::CHECKSUM_ERROR.0, 0x02);
    run(&mut network, 2000);
    assert!(network.axis(0).unwrap().position().abs() <= 1);
}

#[test]
fn a_reset_module_is_at_zero_without_servo() {
    let mut network = started(1);
    ask(&mut network, 1, trapezoid(500));
    run(&mut network, 20_000);
    let position = network.axis(0).unwrap().position();
    assert!((position - 500).abs() <= 1, "{position}");
    ask(&mut network, 0xff, Command::HardReset(None));
    let axis = network.axis(0).unwrap();
    assert_eq!(axis.position(), 0);
    assert!(!axis.status().is_on && axis.status().position_error);
}
