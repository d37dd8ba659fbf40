//! The bytes of a network on their line, in the order of their ends.

use super::ServoNetwork;
use super::node::{Byte, Node};

impl ServoNetwork {
    /// Carries the bytes of both directions that end until `end_ns`, in their order.
    pub(super) fn carry(&mut self, end_ns: u64) -> Vec<u8> {
        let mut heard = Vec::new();
        loop {
            let ends = self.nodes.iter().filter_map(|node| node.saying);
            let said_ns = ends.map(|byte| byte.end_ns).min();
            let sent_ns = self.to_modules.front().map(|(byte, _)| byte.end_ns);
            let next_ns = said_ns.into_iter().chain(sent_ns).min();
            match next_ns {
                Some(next_ns) if next_ns <= end_ns => {
                    self.now_ns = next_ns;
                    if said_ns == next_ns.into() {
                        heard.extend(self.hear(next_ns));
                    } else if let Some((byte, rate)) = self.to_modules.pop_front() {
                        self.arrive(byte, rate);
                    }
                }
                _ => return heard,
            }
        }
    }

    /// Carries the waiting bytes up to the end of a packet, without transmission times.
    pub(super) fn carry_packet(&mut self, end_ns: u64) {
        self.now_ns = end_ns;
        while let Some((byte, _)) = self.to_modules.pop_front() {
            let is_complete = self.account.note_sent(byte.value);
            for heard in self.there.carry(byte.value) {
                self.deliver(heard);
            }
            if is_complete {
                return;
            }
        }
    }

    /// A byte of the host has arrived.
    fn arrive(&mut self, byte: Byte, rate: Option<u32>) {
        self.account.note_sent(byte.value);
        let heard = self.there.carry(byte.value);
        heard.into_iter().for_each(|heard| {
            self.account.note_received(heard);
            self.push(heard, |node| node.understands(rate));
        });
        self.enable();
        let bit_ns = (byte.end_ns - byte.start_ns) / 10;
        let others = self.nodes.iter_mut().filter(|node| !node.understands(rate));
        others.for_each(|node| node.overhear(byte, bit_ns));
    }

    /// A byte reaches all modules.
    pub(super) fn deliver(&mut self, byte: u8) {
        self.account.note_received(byte);
        self.push(byte, |_| true);
    }

    fn push(&mut self, byte: u8, wanted: impl Fn(&Node) -> bool) {
        self.enable();
        let now_ns = self.now_ns;
        let nodes = self.nodes.iter_mut().filter(|node| wanted(node));
        nodes.for_each(|node| node.push(byte, now_ns));
    }

    /// Delivers the bytes that end at `now_ns` to the host. Returns the bytes that it receives.
    fn hear(&mut self, now_ns: u64) -> Vec<u8> {
        let mut together: Option<Byte> = None;
        let mut is_understood = true;
        for node in &mut self.nodes {
            let Some(byte) = node.saying.filter(|byte| byte.end_ns == now_ns) else {
                continue;
            };
            is_understood &= node.understands(self.host_rate);
            // A low level wins over a high one.
            let value = together.map_or(byte.value, |other| other.value & byte.value);
            together = Some(Byte { value, ..byte });
            node.say(now_ns);
        }
        let Some(byte) = together else {
            return Vec::new();
        };
        let heard = if is_understood {
            self.back.carry(byte.value)
        } else {
            let bit_ns = (byte.end_ns - byte.start_ns) / 10;
            let own_ns = self.host_bit_ns();
            self.ear.byte(byte.value, byte.start_ns, bit_ns, own_ns)
        };
        self.account.note_reply(byte.value, &heard);
        heard
    }

    /// The replies of a period, without transmission times.
    pub(super) fn whole_replies(&mut self) -> Vec<u8> {
        let replies = self.nodes.iter_mut();
        let replies: Vec<Vec<u8>> = replies
            .map(|node| std::iter::from_fn(|| node.transmit()).collect())
            .collect();
        let mut heard = Vec::new();
        for byte in together(&replies) {
            let carried = self.back.carry(byte);
            self.account.note_reply(byte, &carried);
            heard.extend(carried);
        }
        heard
    }
}

/// Bytes on the line when several modules drive it: low wins.
fn together(replies: &[Vec<u8>]) -> Vec<u8> {
    let longest = replies.iter().map(Vec::len).max().unwrap_or(0);
    (0..longest)
        .map(|place| {
            let bytes = replies.iter().filter_map(|reply| reply.get(place));
            bytes.fold(0xff, |all, byte| all & byte)
        })
        .collect()
}
