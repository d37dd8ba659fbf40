//! What noise does to the packets of a line.

use husillo_transports::nmc::{Frame, Receiver, Verdict, unseen_pairs_in_halves};

/// Effects of noise on the packets of a line.
#[derive(Copy, Clone, Debug, Default, PartialEq, Eq)]
pub struct Damage {
    /// Wrong bits, including those in silence.
    pub wrong_bits: u64,
    /// Number of replies sent.
    pub replies: u64,
    /// Pairs of wrong bits in replies, in halves, that the checksum does not detect: see
    /// `husillo_transports::nmc::unseen_pairs_in_halves`.
    pub pairs_in_halves: u64,
    /// Replies that arrived damaged.
    pub damaged_replies: u64,
    /// Damaged replies with the right length and checksum, which are undetectable.
    pub unseen_replies: u64,
    /// Commands that modules accepted, but that the host did not send in this form.
    pub unseen_commands: u64,
}

/// Compares what was sent with what arrived.
#[derive(Clone, Debug)]
pub(super) struct Account {
    pub(super) damage: Damage,
    /// Receivers of the packets as sent and as received.
    receivers: [Receiver; 2],
    /// The last complete packet sent.
    sent: Option<Frame>,
    /// The present reply, as sent and as received.
    said: Vec<u8>,
    heard: Vec<u8>,
    /// Bits of silence since its last byte.
    quiet_bits: u64,
}

impl Account {
    pub(super) fn new() -> Account {
        Account {
            damage: Damage::default(),
            receivers: [Receiver::new(), Receiver::new()],
            sent: None,
            said: Vec::new(),
            heard: Vec::new(),
            quiet_bits: 0,
        }
    }

    /// Notes a byte that the host sends. Returns whether it completes a packet.
    pub(super) fn note_sent(&mut self, byte: u8) -> bool {
        let [sent, _] = &mut self.receivers;
        let verdict = sent.push(byte);
        if verdict == Some(Verdict::Sound) {
            self.sent = Some(frame(sent));
        }
        verdict.is_some()
    }

    /// Notes a byte that reaches the modules.
    pub(super) fn note_received(&mut self, byte: u8) {
        let [_, received] = &mut self.receivers;
        if received.push(byte) == Some(Verdict::Sound) && self.sent != Some(frame(received)) {
            self.damage.unseen_commands += 1;
        }
    }

    /// Notes a byte of a reply, and what arrives of it.
    pub(super) fn note_reply(&mut self, byte: u8, heard: &[u8]) {
        self.said.push(byte);
        self.heard.extend_from_slice(heard);
        self.quiet_bits = 0;
    }

    /// Notes silence after a reply, and what arrives in it. A byte that is late may end in the
    /// silence. So a reply ends only after the time of a character.
    pub(super) fn note_silence(&mut self, bits: u64, heard: &[u8]) {
        if self.said.is_empty() {
            return;
        }
        self.heard.extend_from_slice(heard);
        self.quiet_bits += bits;
        if self.quiet_bits >= 10 {
            self.end_reply();
        }
    }

    /// The reply is complete.
    pub(super) fn end_reply(&mut self) {
        let (said, heard) = (
            std::mem::take(&mut self.said),
            std::mem::take(&mut self.heard),
        );
        if said.is_empty() {
            return;
        }
        let has_its_sum = heard.split_last().is_some_and(|(sum, rest)| {
            *sum == rest.iter().fold(0, |sum: u8, byte| sum.wrapping_add(*byte))
        });
        let is_damaged = heard != said;
        let is_unseen = is_damaged && heard.len() == said.len() && has_its_sum;
        self.damage.replies += 1;
        self.damage.pairs_in_halves += u64::from(unseen_pairs_in_halves(said.len() as u16));
        self.damage.damaged_replies += u64::from(is_damaged);
        self.damage.unseen_replies += u64::from(is_unseen);
    }
}

fn frame(receiver: &Receiver) -> Frame {
    Frame::new(receiver.address(), receiver.code(), receiver.data())
}
