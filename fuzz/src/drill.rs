//! Any bytes on the link of the drill, at either end.

use husillo_transports::drill::{Axis, Device, Host, Order, Progress, Rules, Step, Timing};

use crate::bytes::Bytes;

/// Steps of a host in virtual time, with a device at the other end and a line that loses, adds and
/// changes bytes.
///
/// - The host ends every step, and never reports more work as done than was begun.
/// - The device makes at most as many records per run as its memory holds.
/// - Whatever happened, a reset by hand is noticed and brings both to rest.
pub fn drill(data: &[u8]) {
    let mut bytes = Bytes::new(data);
    let flags = bytes.byte();
    let rules = Rules {
        begins_when_full: flags & 1 != 0,
        ends_when_empty: flags & 2 != 0,
        stops_at_border: flags & 4 != 0,
        zero_is_no_move: flags & 8 != 0,
        stops_spindle: flags & 64 != 0,
        z_is_depth: flags & 16 != 0,
        has_extras: flags & 32 != 0,
    };
    let mut device = Device::<8>::new(rules);
    let timing = Timing {
        run_us: 1_000_000,
        home_us: 1_000_000,
        ..Timing::of(2400, 0)
    };
    let mut host = Host::new(timing, 8);
    let mut now_us = bytes.i32() as u32;
    for _ in 0..48 {
        if bytes.is_empty() {
            break;
        }
        let step = step(&mut bytes);
        run(&mut host, &mut device, step, &mut now_us, Some(&mut bytes));
        assert!(host.done_bytes() <= host.begun_bytes());
    }
    device = Device::new(rules);
    assert!(run(
        &mut host,
        &mut device,
        Step::AwaitBoot,
        &mut now_us,
        None
    ));
    assert!(run(&mut host, &mut device, Step::Clear, &mut now_us, None));
    assert!(run(&mut host, &mut device, Step::Test, &mut now_us, None));
}

/// Runs a step; returns whether it succeeded.
fn run(
    host: &mut Host,
    device: &mut Device<8>,
    step: Step,
    now_us: &mut u32,
    mut faults: Option<&mut Bytes<'_>>,
) -> bool {
    if host.start(step, *now_us).is_err() {
        return false;
    }
    let mut damage = |byte: u8| match faults.as_mut().map(|bytes| bytes.byte()) {
        Some(1) => vec![],
        Some(2) => vec![byte, byte],
        Some(place @ 3..=10) => vec![byte ^ (1 << (place - 3))],
        Some(11) => vec![b'B', byte],
        _ => vec![byte],
    };
    for _ in 0..400 {
        if let Progress::Done(outcome) = host.poll(*now_us) {
            return outcome == husillo_transports::drill::Outcome::Done;
        }
        if let Some(byte) = host.transmit(*now_us) {
            damage(byte).into_iter().for_each(|byte| device.push(byte));
        }
        let stored = device.stored().len();
        let mut orders = 0;
        while let Some(order) = device.take() {
            let is_of_program =
                matches!(order, Order::Move(Axis::X | Axis::Y, _) | Order::Drill(_));
            orders += usize::from(is_of_program);
            if order == Order::Teach {
                device.teach([1, 2]);
            }
            // The host is silent in the middle of some work.
            if device.lease_us().is_some_and(|us| us < 1_000_000) {
                device.expire();
            }
            device.done();
        }
        // Two bytes of the last record may be left over from the previous part.
        assert!(orders <= stored.div_ceil(3), "{orders} of {stored} bytes");
        *now_us = now_us.wrapping_add(9000);
        while let Some(byte) = device.transmit() {
            damage(byte)
                .into_iter()
                .for_each(|byte| host.push(byte, *now_us));
        }
        *now_us = now_us.wrapping_add(20_000);
    }
    panic!("the host never ends {step:?}");
}

fn step(bytes: &mut Bytes<'_>) -> Step {
    match bytes.byte() % 23 {
        0 => Step::Resync,
        1 => Step::Test,
        2 => Step::Clear,
        3 => Step::Home,
        4 => Step::Begin,
        5..=9 => Step::Store(bytes.byte()),
        10 => Step::End,
        11 => Step::Execute,
        12 => Step::Manual(bytes.byte()),
        13 => Step::Key(bytes.byte()),
        14 => Step::Advance(bytes.byte()),
        15 => Step::Teach,
        16 => Step::Spindle(bytes.byte() & 1 != 0),
        17 => Step::Read(u16::from_le_bytes([bytes.byte(), bytes.byte()])),
        18 => Step::Help,
        19 => Step::ManualKept(bytes.byte()),
        20 => Step::Lease(bytes.byte()),
        21 => Step::Empty,
        _ => Step::Quit,
    }
}
