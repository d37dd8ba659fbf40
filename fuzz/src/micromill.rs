//! Any bytes on the link of the micro mill, at either end.

use husillo_transports::micromill::{
    Answer, Device, Host, HostTiming, Line, Order, Outcome, Progress,
};

use crate::bytes::Bytes;

/// Strings of a host in virtual time, with a device at the other end and a line that loses, adds
/// and changes bytes.
///
/// - An order that the device accepts can be written and read back unchanged.
/// - The host ends every string.
/// - On a good line afterwards both communicate, whatever happened before.
pub fn micromill(data: &[u8]) {
    let mut bytes = Bytes::new(data);
    let mut device = Device::<64>::new();
    let timing = HostTiming {
        motion_us: 1_000_000,
        ..HostTiming::of(9600)
    };
    let mut host = Host::new(timing);
    let mut now_us = bytes.i32() as u32;
    // A motion may last longer than the string that began it, if its host gave up.
    let mut moves_left = 0;
    for _ in 0..32 {
        if bytes.is_empty() {
            break;
        }
        let mut string = [0; 12];
        string.fill_with(|| bytes.byte());
        let order = order(&string);
        run(
            &mut host,
            &mut device,
            order,
            &mut now_us,
            &mut moves_left,
            Some(&mut bytes),
        );
    }
    // A part of a lost string may remain in the device; the next string is then corrupted.
    let mut understood = 0;
    for _ in 0..4 {
        let outcome = run(
            &mut host,
            &mut device,
            Order::Lease(500),
            &mut now_us,
            &mut moves_left,
            None,
        );
        understood += usize::from(outcome == Outcome::Done);
    }
    assert!(understood >= 3, "{understood}");
}

/// The order in these bytes: as a string if they are one, otherwise by number.
fn order(string: &[u8]) -> Order {
    let end = string.iter().position(|byte| *byte == b';');
    let read = Order::read(
        string
            .get(..end.unwrap_or(string.len()))
            .unwrap_or_default(),
    );
    read.unwrap_or(match string[0] % 8 {
        0 => Order::Stop,
        1 => Order::Jog([1, 0, -1]),
        2 => Order::Stream(string[1] & 1 != 0),
        3 => Order::Home,
        4 => Order::Faster,
        5 => Order::Every(u16::from(string[1])),
        _ => Order::Line(Line::Arc {
            clockwise: string[1] & 1 != 0,
            to: [i32::from(string[2]) << 15, -i32::from(string[3])],
            centre: [0, i32::from(string[4])],
            feed: u16::from(string[5]).max(1),
        }),
    })
}

fn run(
    host: &mut Host,
    device: &mut Device<64>,
    order: Order,
    now_us: &mut u32,
    moves_left: &mut u32,
    mut faults: Option<&mut Bytes<'_>>,
) -> Outcome {
    let mut damage = |byte: u8| match faults.as_mut().map(|bytes| bytes.byte()) {
        Some(1) => vec![],
        Some(2) => vec![byte, byte],
        Some(place @ 3..=10) => vec![byte ^ (1 << (place - 3))],
        Some(11) => vec![Answer::Ready.byte(), byte],
        Some(12) => vec![b'A', byte],
        _ => vec![byte],
    };
    assert!(host.start(order, *now_us), "the last string has ended");
    for _ in 0..20_000 {
        if let Progress::Over(outcome) = host.poll(*now_us) {
            return outcome;
        }
        *now_us = now_us.wrapping_add(1100);
        if let Some(byte) = host.transmit(*now_us) {
            for byte in damage(byte) {
                let Some(heard) = device.push(byte) else {
                    continue;
                };
                let text = heard.text();
                let (_, string) = text.bytes().split_last().expect("a string has its end");
                assert_eq!(Order::read(string), Some(heard));
                match heard {
                    Order::Stop if *moves_left > 0 => {
                        *moves_left = 0;
                        device.answer(Answer::Stopped);
                    }
                    Order::Stop | Order::Lease(_) => device.answer(Answer::Taken),
                    Order::Faster | Order::Slower | Order::Renew => {}
                    _ if *moves_left > 0 => device.answer(Answer::Refused),
                    _ => {
                        if device.is_streaming() && matches!(heard, Order::Line(_)) {
                            device.answer(Answer::Taken);
                        }
                        *moves_left = 5;
                    }
                }
                device.set_motion(*moves_left > 0, matches!(heard, Order::Jog(_)));
            }
        }
        if *moves_left > 0 && device.has_room(1) {
            device.step(husillo_transports::micromill::Axis::Z, false);
            *moves_left -= 1;
            if *moves_left == 0 {
                device.answer(Answer::Done);
                device.set_motion(false, false);
            }
        }
        if let Some(byte) = device.transmit() {
            for byte in damage(byte) {
                host.push(byte, *now_us);
            }
        }
    }
    panic!("the host never ends {order:?}");
}
