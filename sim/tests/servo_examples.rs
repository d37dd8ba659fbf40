//! The worked examples of the protocol on the servo module that ships, with simulated motors.

use husillo_sim::{DcMotorModel, ServoNetwork};

fn bytes(hex: &str) -> Vec<u8> {
    let pairs = hex.split_whitespace();
    pairs
        .map(|pair| u8::from_str_radix(pair, 16).expect("hexadecimal"))
        .collect()
}

/// A motor on which the moves of the examples end at their goals: those gains drive nothing at an
/// error of one count, so where a motor rests depends on its friction and on its supply. The index
/// mark is 2000 counts from the start on either side.
const MOTOR: DcMotorModel = DcMotorModel {
    supply_v: 24.0,
    coulomb_nm: 0.0,
    stiction_nm: 0.0,
    counts_per_revolution: 4000,
    index_counts: 2000,
    ..DcMotorModel::PROTOTYPE
};

/// Servo periods within which every reply arrives.
const WAIT_PERIODS: u32 = 100;
/// Servo periods within which every move ends and the motor stands. Its rest modulo 5 decides
/// whether the loop, which the gains divide by 5, has begun the motion in velocity mode before the
/// smooth stop arrives. In the example it has not: the stop is done at once.
const MOVE_PERIODS: u32 = 50_000;

/// Requests to two modules of version 4, with their replies; after `end` the motion ends first.
/// The rest are sent as soon as the reply is there.
const CONVERSATION: [(&str, &str); 37] =
    include!("../../transports/tests/data/nmc_conversation.rs");

/// Sends a packet and returns the reply. Returns as soon as the reply is there, so that the next
/// packet follows it at once.
fn exchange(network: &mut ServoNetwork, request: &[u8], length: usize) -> Vec<u8> {
    request.iter().for_each(|byte| network.send(*byte));
    let mut heard = Vec::new();
    for _ in 0..WAIT_PERIODS {
        heard.extend(network.tick());
        if length > 0 && heard.len() >= length {
            break;
        }
    }
    heard
}

#[test]
fn the_module_answers_the_worked_examples_byte_by_byte() {
    let mut network = ServoNetwork::new(&[4, 4], MOTOR);
    for (request, reply) in CONVERSATION {
        let wanted = bytes(reply.trim_end_matches("end"));
        let heard = exchange(&mut network, &bytes(request), wanted.len());
        assert_eq!(heard, wanted, "{request}");
        if reply.ends_with("end") {
            (0..MOVE_PERIODS).for_each(|_| drop(network.tick()));
        }
    }
}
