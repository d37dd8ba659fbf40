//! The line of the modules as a wire: rates, byte times, replies that are cut off, modules that
//! are deaf after a reset, and modules of another kind.

mod common;

use common::{ask, send};
use husillo_sim::{DcMotorModel, IoInputs, NetworkModule, ServoNetwork};
use husillo_transports::nmc::{Baud, Command, EVERY_GROUP, Group, Items};

const PERIOD_S: f64 = husillo_sim::SERVO_PERIOD_S;

/// Modules with addresses from 1 on, at the far end first, on a host of 19200 bits/s.
fn started(modules: usize) -> ServoNetwork {
    let mut network = ServoNetwork::new(&vec![4; modules], DcMotorModel::PROTOTYPE);
    network.set_host_rate(Some(19200));
    address(&mut network, modules);
    network
}

fn address(network: &mut ServoNetwork, modules: usize) {
    for address in 1..=modules as u8 {
        let set = Command::SetAddress {
            address,
            group: Group::NONE,
        };
        let reply = ask(network, 0, set);
        assert_eq!(reply.len(), 2, "module {address}");
    }
}

#[test]
fn a_reply_takes_the_time_of_its_bytes() {
    for (baud, rate) in [(Baud::B19200, 19200), (Baud::B115200, 115_200)] {
        let mut network = started(1);
        send(&mut network, EVERY_GROUP, Command::SetBaud(baud));
        (0..100).for_each(|_| drop(network.tick()));
        network.set_host_rate(Some(rate));
        // 5 bytes there, up to a servo period, and 14 bytes back.
        let shortest_s = 190.0 / f64::from(rate);
        let longest_s = shortest_s + 3.0 * PERIOD_S;
        send(&mut network, 1, Command::ReadStatus(Items(0x1f)));
        let (mut bytes, mut periods) = (0, 0);
        while bytes < 14 {
            bytes += network.tick().len();
            periods += 1;
            assert!(periods < 100);
        }
        let took_s = f64::from(periods) * PERIOD_S;
        assert!(
            (shortest_s..longest_s).contains(&took_s),
            "{took_s} s at {rate}, not {shortest_s}"
        );
    }
}

#[test]
fn set_baud_changes_the_module_that_it_names() {
    let mut network = started(2);
    let reply = ask(&mut network, 1, Command::SetBaud(Baud::B57600));
    assert_ne!(reply, [0x19, 0x19], "the reply has the new rate already");
    let rates = [0, 1].map(|module| network.baud(module));
    assert_eq!(rates, [Some(Baud::B57600), Some(Baud::B19200)]);
    // Each answers at its own rate only.
    for (rate, answers) in [(19200, 2), (57600, 1)] {
        network.set_host_rate(Some(rate));
        // What it has heard of the other rate may have left half a packet behind.
        (0..40).for_each(|_| network.send(0));
        (0..100).for_each(|_| drop(network.tick()));
        for address in 1..=2 {
            let reply = ask(&mut network, address, Command::NoOperation);
            let wanted: &[u8] = if address == answers {
                &[0x19, 0x19]
            } else {
                &[]
            };
            assert_eq!(reply, wanted, "module {address} at {rate}");
        }
    }
}

#[test]
fn a_hard_reset_returns_to_19200() {
    let mut network = started(1);
    send(&mut network, EVERY_GROUP, Command::SetBaud(Baud::B57600));
    (0..100).for_each(|_| drop(network.tick()));
    network.set_host_rate(Some(57600));
    assert_eq!(ask(&mut network, 1, Command::NoOperation), [0x19, 0x19]);
    ask(&mut network, 1, Command::HardReset(None));
    assert_eq!(network.baud(0), Some(Baud::B19200));
    assert!(ask(&mut network, 0, Command::NoOperation).is_empty());
}

/// A byte that a module hears ends its reply, so two commands back to back have one answer.
#[test]
fn a_command_without_a_pause_ends_the_reply_before_it() {
    let mut network = started(1);
    send(&mut network, 1, Command::ReadStatus(Items(0x1f)));
    send(&mut network, 1, Command::ReadStatus(Items::DEVICE));
    let heard: Vec<u8> = (0..100).flat_map(|_| network.tick()).collect();
    assert!(heard.ends_with(&[0x19, 0, 4, 0x1d]), "{heard:02x?}");
    assert!(heard.len() < 4 + 3, "{heard:02x?}");
    // In the middle of the reply as well. The first command has ended after 2.6 ms.
    send(&mut network, 1, Command::ReadStatus(Items(0x1f)));
    let mut heard: Vec<u8> = (0..12).flat_map(|_| network.tick()).collect();
    assert!((3..10).contains(&heard.len()), "{heard:02x?}");
    send(&mut network, 1, Command::ReadStatus(Items::DEVICE));
    heard.extend((0..100).flat_map(|_| network.tick()));
    assert!(heard.ends_with(&[0x19, 0, 4, 0x1d]), "{heard:02x?}");
    assert!(heard.len() < 4 + 13, "{heard:02x?}");
}

#[test]
fn a_module_is_deaf_for_a_time_after_a_reset() {
    // In servo periods of 0.512 ms.
    for (reset_ms, after, answers) in [(0, 10, true), (300, 400, false), (300, 600, true)] {
        let motor = DcMotorModel::PROTOTYPE;
        let mut network = ServoNetwork::new(&[4; 2], motor).with_reset_ms(reset_ms);
        send(&mut network, EVERY_GROUP, Command::HardReset(None));
        (0..10 + after).for_each(|_| drop(network.tick()));
        let set = Command::SetAddress {
            address: 1,
            group: Group::NONE,
        };
        let reply = ask(&mut network, 0, set);
        assert_eq!(reply.len(), if answers { 2 } else { 0 }, "{reset_ms} ms");
    }
}

#[test]
fn without_byte_times_a_reply_is_there_in_the_same_period() {
    let mut network = ServoNetwork::new(&[4], DcMotorModel::PROTOTYPE).without_byte_times();
    address(&mut network, 1);
    send(&mut network, 1, Command::ReadStatus(Items(0x1f)));
    send(&mut network, 1, Command::NoOperation);
    assert_eq!(network.tick().len(), 14);
    assert_eq!(network.tick(), [0x19, 0x19]);
}

/// The network of a centrifuge: a servo module and a module with inputs and outputs.
#[test]
fn modules_of_another_kind_are_on_the_same_line() {
    let modules = [
        NetworkModule::Servo {
            version: 4,
            motor: DcMotorModel::PROTOTYPE,
        },
        NetworkModule::Io { version: 2 },
    ];
    let mut network = ServoNetwork::of_modules(&modules);
    address(&mut network, 2);
    assert_eq!(
        ask(&mut network, 1, Command::ReadStatus(Items::DEVICE)),
        [0x19, 0, 4, 0x1d]
    );
    assert_eq!(
        ask(&mut network, 2, Command::ReadStatus(Items::DEVICE)),
        [0, 2, 2, 4]
    );
    let inputs = IoInputs {
        pins: 0x0801,
        analogue: [9, 0, 0],
        pulses: 0,
    };
    network.connect(1, inputs);
    // The position of a servo module is the pins here, the current the first analogue input.
    let reply = ask(&mut network, 2, Command::ReadStatus(Items(0x03)));
    assert_eq!(reply, [0, 0x01, 0x08, 9, 0x12]);
    assert!(network.motor(1).is_none() && network.axis(1).is_none());
    // Its rate follows a command to the group of all.
    send(&mut network, EVERY_GROUP, Command::SetBaud(Baud::B57600));
    (0..100).for_each(|_| drop(network.tick()));
    let rates = [0, 1].map(|module| network.baud(module));
    assert_eq!(rates, [Some(Baud::B57600); 2]);
    assert_eq!(network.outputs(1), Some((0, [0; 2])));
    // Pin 10 becomes an output, and high. The second packet ends only the reply to the first.
    for byte in [
        0xaa, 0x02, 0x20, 0xff, 0x0b, 0x2c, 0xaa, 0x02, 0x26, 0, 4, 0x2c,
    ] {
        network.send(byte);
    }
    (0..100).for_each(|_| drop(network.tick()));
    assert_eq!(network.outputs(1), Some((0x400, [0; 2])));
}
