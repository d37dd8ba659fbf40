//! The worked examples of the protocol on the servo module that ships, with simulated motors.

use husillo_sim::{DcMotorModel, ServoChain};

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
const CONVERSATION: [(&str, &str); 37] = [
    ("00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00", ""),
    ("aa ff 0f 0e", ""),
    ("aa 00 21 01 ff 21", "19 19"),
    ("aa 00 21 02 ff 22", "19 19"),
    ("aa 00 21 03 ff 23", ""),
    ("aa 01 13 20 34", "19 00 04 1d"),
    ("aa 01 0e 0f", "19 19"),
    ("aa 01 0e 10", "1b 1b"),
    ("aa 01 0e 0f", "19 19"),
    ("aa ff 1a 14 2d", ""),
    (
        "aa 01 e6 64 00 e8 03 00 00 00 00 ff 00 a0 0f 01 00 e5",
        "19 19",
    ),
    (
        "aa 01 e6 c8 00 b0 04 96 00 0f 00 4b 00 a0 0f 05 00 07",
        "19 19",
    ),
    ("aa 01 17 03 1b", "19 19"),
    ("aa 01 17 05 1d", "19 19"),
    ("aa 01 0b 0c", "09 09"),
    ("aa 01 00 01", "09 09"),
    (
        "aa 01 12 1f 32",
        "09 00 00 00 00 00 00 00 04 00 00 00 00 0d",
    ),
    ("aa 01 12 00 13", "09 09"),
    ("aa 01 18 0c 25", "09 09"),
    (
        "aa 01 d4 17 0c fe ff ff 00 00 01 00 e8 03 00 00 e0",
        "09 09",
    ),
    ("aa 01 05 06", "08 08 end"),
    ("aa 01 13 0d 21", "09 0c fe ff ff 00 00 1c 2d"),
    ("aa 01 19 08 22", "89 89"),
    (
        "aa 01 d4 97 c4 09 00 00 a0 86 01 00 64 00 00 00 c4",
        "88 88 end",
    ),
    ("aa 01 13 11 25", "09 c4 09 00 00 d0 07 00 00 ad"),
    ("aa 01 94 f6 25 06 01 00 89 00 00 00 40", "08 08"),
    ("aa 01 17 09 21", "09 09"),
    ("aa 01 57 11 e8 03 00 00 54", "09 09"),
    ("aa 01 24 c8 80 6d", "19 19"),
    ("aa 01 0c 0d", "19 19"),
    ("aa 01 21 01 01 24", "19 19"),
    ("aa 02 21 02 81 a6", "19 19"),
    ("aa 81 0e 8f", "19 19"),
    ("aa 81 05 86", "19 19"),
    ("aa ff 0e 0d", ""),
    ("aa 01 0f 10", ""),
    ("aa 01 0e 0f", ""), // the module has no address any more
];

/// Sends a packet and returns the reply. Returns as soon as the reply is there, so that the next
/// packet follows it at once.
fn exchange(chain: &mut ServoChain, request: &[u8], length: usize) -> Vec<u8> {
    request.iter().for_each(|byte| chain.send(*byte));
    let mut heard = Vec::new();
    for _ in 0..WAIT_PERIODS {
        heard.extend(chain.tick());
        if length > 0 && heard.len() >= length {
            break;
        }
    }
    heard
}

#[test]
fn the_module_answers_the_worked_examples_byte_by_byte() {
    let mut chain = ServoChain::new(&[4, 4], MOTOR);
    for (request, reply) in CONVERSATION {
        let wanted = bytes(reply.trim_end_matches("end"));
        let heard = exchange(&mut chain, &bytes(request), wanted.len());
        assert_eq!(heard, wanted, "{request}");
        if reply.ends_with("end") {
            (0..MOVE_PERIODS).for_each(|_| drop(chain.tick()));
        }
    }
}
