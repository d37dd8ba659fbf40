//! The servo network. An event is a byte or a packet of the line.

use core::hint::black_box;

use husillo_transports::nmc::{
    Command, Gains, Items, Module, Readings, Receiver, Reply, Status, Trajectory,
};

use crate::Count;

const PACKETS: u32 = 50;

#[inline(never)]
pub fn all(count: Count<'_>) {
    let load = Command::LoadTrajectory(Trajectory {
        position: Some(-500),
        velocity: Some(65536),
        acceleration: Some(1000),
        ..Trajectory::default()
    });
    let frame = load.frame(1);
    let bytes = frame.bytes();
    let events = PACKETS * bytes.len() as u32;
    count("nmc_receiver_byte", events, &mut || {
        let mut receiver = Receiver::new();
        for _ in 0..PACKETS {
            for byte in black_box(bytes) {
                black_box(receiver.push(*byte));
            }
        }
    });
    // Packets for other modules are followed, but not executed.
    count("nmc_module_byte", events, &mut || {
        let mut module = Module::new(4);
        module.set_enabled(true);
        for _ in 0..PACKETS {
            for byte in black_box(bytes) {
                module.push(*byte);
            }
            black_box(module.take());
        }
    });
    let gains = Command::SetGain(Gains::default());
    let own = gains.frame(0);
    count("nmc_module_exchange", PACKETS, &mut || {
        let mut module = Module::new(4);
        module.set_enabled(true);
        for _ in 0..PACKETS {
            for byte in black_box(own.bytes()) {
                module.push(*byte);
            }
            black_box(module.take());
            module.reply(Status(0x19), black_box(&Readings::default()));
            while let Some(byte) = module.transmit() {
                black_box(byte);
            }
        }
    });
    let reply = [0x09, 0x0C, 0xFE, 0xFF, 0xFF, 0x11];
    count("nmc_reply_decode", PACKETS, &mut || {
        for _ in 0..PACKETS {
            black_box(Reply::decode(black_box(&reply), Items::POSITION));
        }
    });
}
