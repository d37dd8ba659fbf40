//! The serial port on USB of an ESP32-C3, which is part of the chip: the link of its boards.
//!
//! With the feature `buffered`, the bytes for the host wait for the end of their line and are sent
//! as one packet. Otherwise each byte is a packet. If the host takes no packet, because no program
//! has opened the port, further bytes are dropped.
//!
//! Source: ESP32-C3 Technical Reference Manual, USB Serial/JTAG controller.

use super::timer::{CLOCKS_PER_US, clock};
use crate::{
    Shared,
    registers::{read, set},
};

const USB: usize = 0x6004_3000;
const FIFO: usize = USB;
const STATE: usize = USB + 0x04;
const INTERRUPT_RAW: usize = USB + 0x08;
const INTERRUPT_ENABLE: usize = USB + 0x10;
const INTERRUPT_CLEAR: usize = USB + 0x14;
/// Bits of `STATE`: the packet is complete, there is room for a byte, a byte was received.
const COMPLETE: u32 = 1;
const HAS_ROOM: u32 = 1 << 1;
const HAS_BYTE: u32 = 1 << 2;
/// Bits of the interrupts: a packet came, and the host has taken one.
const CAME: u32 = 1 << 2;
const TAKEN: u32 = 1 << 3;
/// Number of the source of interrupts.
pub const SOURCE: usize = 26;
/// The most bytes of a packet. The host takes one of 64 bytes for the part of a longer message.
const PACKET_BYTES: u8 = 63;
/// A host that has not taken a packet after this time does not listen.
const PATIENCE: u32 = 50_000 * CLOCKS_PER_US;

/// The packet for the host.
struct Packet {
    bytes: u8,
    /// It is complete, and the host has not taken it yet.
    is_complete: bool,
    completed: u32,
}

static PACKET: Shared<Packet> = Shared::new(Packet {
    bytes: 0,
    is_complete: false,
    completed: 0,
});

/// Enables the interrupt of received packets.
pub fn start() {
    set(INTERRUPT_CLEAR, CAME);
    set(INTERRUPT_ENABLE, CAME);
}

/// Sends a byte, if the packet has room for it. If the host does not listen, the byte is dropped
/// and reported as sent.
pub fn send(byte: u8) -> bool {
    PACKET.with(|packet| {
        if packet.is_complete {
            let is_late = clock().wrapping_sub(packet.completed) > PATIENCE;
            // `HAS_ROOM` may be late after a packet. A host that starts anew may drop a packet.
            let is_taken = read(INTERRUPT_RAW) & TAKEN != 0 || is_late;
            if !is_taken || read(STATE) & HAS_ROOM == 0 {
                return is_late;
            }
            packet.is_complete = false;
            packet.bytes = 0;
        }
        set(FIFO, byte.into());
        packet.bytes = packet.bytes.wrapping_add(1);
        // Without the feature, the bytes are answers of a protocol that has no lines.
        let is_answer = cfg!(not(feature = "buffered"));
        if is_answer || byte == b'\n' || packet.bytes == PACKET_BYTES {
            set(INTERRUPT_CLEAR, TAKEN);
            set(STATE, COMPLETE);
            packet.is_complete = true;
            packet.completed = clock();
        }
        true
    })
}

/// USB has no rate.
pub fn baud(_: u32) {}

/// Always true, because the chip buffers the bytes.
pub fn is_sent() -> bool {
    true
}

/// Takes the bytes of a packet from the host.
pub fn on_interrupt() {
    set(INTERRUPT_CLEAR, CAME);
    while read(STATE) & HAS_BYTE != 0 {
        crate::heard(read(FIFO) as u8);
    }
}
