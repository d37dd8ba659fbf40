//! Any bytes on the servo network, at either end.

use husillo_transports::nmc::{
    Command, Group, Homing, Host, Items, Mode, Module, Order, Outcome, Progress, Readings,
    Receiver, Reset, Status, Timing, Trajectory, Verdict,
};

use crate::bytes::Bytes;

/// A module executes packets with a right checksum and nothing else, whenever it is polled. A reply
/// has the length of its items.
pub fn nmc_module(data: &[u8]) {
    let mut bytes = Bytes::new(data);
    let version = [4, 5, 10][usize::from(bytes.byte() % 3)];
    let mut module = Module::new(version);
    module.set_enabled(true);
    let mut receiver = Receiver::new(); // what stands on the line, whomever it is for
    let mut last = None;
    while !bytes.is_empty() {
        let byte = bytes.byte();
        if receiver.push(byte) == Some(Verdict::Sound) {
            last = Command::decode(receiver.code(), receiver.data(), version);
        }
        let address = receiver.address();
        let is_for_it = address == module.address() || address == module.group().address;
        module.push(byte);
        assert!(!module.is_sending(), "any byte stops a reply");
        if !receiver.is_idle() {
            continue;
        }
        let order = module.take();
        if let Some(Order::Servo(command)) = order {
            assert!(is_for_it);
            assert_eq!(Some(command), last, "only of a sound packet, and once");
        }
        last = None;
        assert_eq!(module.take(), None, "an order is handed out once");
        module.reply(Status(0xFF), &Readings::default());
        let told = std::iter::from_fn(|| module.transmit()).count();
        assert!(told == 0 || (2..=19).contains(&told));
        if matches!(order, Some(Order::Reset(_))) {
            assert_eq!((module.address(), told), (0, 0));
        }
    }
}

/// A host ends every step, whatever it receives and whenever, and sends no more than its retries
/// allow.
pub fn nmc_host(data: &[u8]) {
    let mut bytes = Bytes::new(data);
    let timing = Timing::prompt(Default::default(), u32::from(bytes.byte()) * 16);
    let mut host = Host::new(timing);
    host.adopt(
        1,
        Items(bytes.byte()),
        Group {
            address: 0x81,
            is_leader: true,
        },
    );
    let mut now_us = bytes.i32() as u32;
    for _ in 0..8 {
        let address = [0, 1, 2, 0x81, 0xFF][usize::from(bytes.byte() % 5)];
        if host
            .send_command(address, command(&mut bytes), now_us)
            .is_err()
        {
            continue;
        }
        let mut sent = 0;
        let outcome = loop {
            if let Progress::Done(outcome) = host.poll(now_us) {
                break outcome;
            }
            while host.transmit(now_us).is_some() {
                sent += 1;
            }
            now_us = now_us.wrapping_add(u32::from(bytes.byte()) * 8 + 1);
            if !bytes.is_empty() {
                host.push(bytes.byte(), now_us);
            } else {
                now_us = now_us.wrapping_add(10_000);
            }
            assert!(sent < 2000, "the host never gives up");
        };
        if let Outcome::Answered(reply) | Outcome::Confirmed(reply) = outcome {
            assert!(
                !reply.status.contains(Status::CHECKSUM_ERROR),
                "that one was not executed"
            );
        }
    }
}

fn command(bytes: &mut Bytes<'_>) -> Command {
    match bytes.byte() % 9 {
        0 => Command::ResetPosition(Reset::Zero),
        1 => Command::SetAddress {
            address: bytes.byte() % 33,
            group: Group {
                address: bytes.byte() | 0x80,
                is_leader: bytes.byte() & 1 == 0,
            },
        },
        2 => Command::DefineStatus(Items(bytes.byte())),
        3 => Command::ReadStatus(Items(bytes.byte())),
        4 => Command::LoadTrajectory(Trajectory {
            position: Some(bytes.i32()),
            mode: Mode::Trapezoid,
            start_now: bytes.byte() & 1 == 0,
            ..Trajectory::default()
        }),
        5 => Command::SetHoming(Homing(bytes.byte())),
        6 => Command::StartMotion,
        7 => Command::HardReset(None),
        _ => Command::ClearBits,
    }
}
