//! The module's end of the line.

use crate::buffer::Buffer;

use super::command::is_group;
use super::reply::LONGEST_REPLY;
use super::{Baud, Command, Group, Items, Readings, Receiver, Reply, Status, Verdict};

/// What the owner of a [`Module`] must do. The module itself handles addresses, groups and status
/// items.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Order {
    /// A command for the servo: any command except those for addressing, status, rate and reset.
    Servo(Command),
    /// The line continues at this rate.
    Baud(Baud),
    /// Return to the state after power-up, with the configuration byte of version 10. The line
    /// continues at 19200 baud. The module has already reset itself, and ADDR_OUT is high again.
    Reset(Option<u8>),
}

/// The order that waits for the end of the servo cycle.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Pending {
    Nothing,
    /// A damaged packet, or an unknown command.
    Reply,
    Command(Command),
}

/// The module's end of the line: bytes in, one order at the end of each servo cycle, then the bytes
/// of the reply out.
///
/// | when | call |
/// | --- | --- |
/// | ADDR_IN changes | [`set_enabled`](Module::set_enabled) |
/// | a byte arrives | [`push`](Module::push); it cancels any reply, so XMT_EN falls |
/// | end of the servo cycle | [`take`](Module::take), execute, [`reply`](Module::reply) |
/// | the transmitter is free | [`transmit`](Module::transmit); XMT_EN is [`is_sending`](Module::is_sending) until transmission is complete |
///
/// An order is returned once, and only if the checksum of its packet was right. Only one command is
/// stored. A packet that is complete before the last one was taken is dropped without a reply, so
/// the host notices this.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Module {
    version: u8,
    receiver: Receiver,
    /// Whether ADDR_IN is low.
    is_enabled: bool,
    /// Whether ADDR_OUT is low.
    is_addressed: bool,
    address: u8,
    group: Group,
    /// The items of every reply.
    items: Items,
    pending: Pending,
    /// The items of the reply that is due, and whether the packet was valid.
    due: Option<(Items, bool)>,
    sending: Buffer<LONGEST_REPLY>,
    /// Number of these bytes that are sent.
    sent: u8,
}

impl Module {
    /// Creates a module in its state after power-up. It receives nothing until ADDR_IN goes low.
    /// `version` is 4 for the chip of the original. Versions 5 and 10 know more commands.
    pub const fn new(version: u8) -> Module {
        Module {
            version,
            receiver: Receiver::new(),
            is_enabled: false,
            is_addressed: false,
            address: 0,
            group: Group::NONE,
            items: Items::NONE,
            pending: Pending::Nothing,
            due: None,
            sending: Buffer::new(),
            sent: 0,
        }
    }

    /// Sets whether ADDR_IN is low. Only then is the module enabled. A disabled module neither
    /// receives nor answers.
    pub fn set_enabled(&mut self, is_enabled: bool) {
        self.is_enabled = is_enabled;
        if !is_enabled {
            self.receiver.reset();
            self.pending = Pending::Nothing;
            self.cancel();
        }
    }

    /// Whether ADDR_OUT is low. This enables the next module of the daisy chain.
    pub const fn enables_next(&self) -> bool {
        self.is_addressed
    }

    /// Takes a byte of the command line.
    pub fn push(&mut self, byte: u8) {
        if !self.is_enabled {
            return;
        }
        self.cancel();
        let Some(verdict) = self.receiver.push(byte) else {
            return;
        };
        let address = self.receiver.address();
        let is_own = address == self.address;
        let is_group = is_group(address) && address == self.group.address;
        if !(is_own || is_group) || self.pending != Pending::Nothing {
            return;
        }
        let is_sound = verdict == Verdict::Sound;
        let command = if is_sound {
            Command::decode(self.receiver.code(), self.receiver.data(), self.version)
        } else {
            None
        };
        let replies = is_own || self.group.is_leader;
        self.due = replies.then_some((self.items, is_sound));
        self.pending = match command {
            Some(command) => Pending::Command(command),
            None => Pending::Reply,
        };
    }

    /// Drops an incomplete packet. This is for an owner that can detect a pause on the line. The
    /// original does not detect one.
    pub fn forget_partial(&mut self) {
        self.receiver.reset();
    }

    /// Returns the order at the end of a servo cycle. The reply follows after the order.
    pub fn take(&mut self) -> Option<Order> {
        let pending = core::mem::replace(&mut self.pending, Pending::Nothing);
        let Pending::Command(command) = pending else {
            return None;
        };
        match command {
            Command::SetAddress { address, group } => {
                self.address = address;
                self.group = group;
                self.is_addressed = true;
                None
            }
            Command::DefineStatus(items) => {
                self.items = items.of_version(self.version);
                self.answer_with(self.items);
                None
            }
            Command::ReadStatus(items) => {
                self.answer_with(items.of_version(self.version));
                None
            }
            Command::NoOperation => None,
            Command::SetBaud(baud) => Some(Order::Baud(baud)),
            Command::HardReset(configuration) => {
                let is_enabled = self.is_enabled;
                *self = Module::new(self.version);
                self.is_enabled = is_enabled;
                Some(Order::Reset(configuration))
            }
            command => Some(Order::Servo(command)),
        }
    }

    /// Whether a reply is due as soon as the order is carried out.
    pub fn owes_reply(&self) -> bool {
        self.pending == Pending::Nothing && self.due.is_some()
    }

    /// Makes the reply, if one is due, from the status and the readings of the servo after the
    /// order. The module itself supplies the bit CHECKSUM_ERROR, the kind and the version.
    pub fn reply(&mut self, status: Status, readings: &Readings) {
        if !self.owes_reply() {
            return;
        }
        let Some((items, is_sound)) = self.due.take() else {
            return;
        };
        let checksum = if is_sound {
            0
        } else {
            Status::CHECKSUM_ERROR.0
        };
        let reply = Reply {
            status: Status((status.0 & !Status::CHECKSUM_ERROR.0) | checksum),
            items,
            readings: Readings {
                kind: 0,
                version: self.version,
                ..*readings
            },
        };
        self.sending = reply.encode();
        self.sent = 0;
    }

    /// Returns the next byte for the status line.
    pub fn transmit(&mut self) -> Option<u8> {
        let byte = self.sending.bytes().get(usize::from(self.sent)).copied();
        if byte.is_some() {
            self.sent = self.sent.wrapping_add(1); // it was below 19
        } else {
            self.cancel_sending();
        }
        byte
    }

    /// Whether bytes wait to be sent.
    pub fn is_sending(&self) -> bool {
        usize::from(self.sent) < self.sending.bytes().len()
    }

    /// Returns the module's own address. It is 0 until the module is addressed.
    pub const fn address(&self) -> u8 {
        self.address
    }

    /// Returns the module's group.
    pub const fn group(&self) -> Group {
        self.group
    }

    /// Returns the items of every reply.
    pub const fn items(&self) -> Items {
        self.items
    }

    /// Returns the module's version.
    pub const fn version(&self) -> u8 {
        self.version
    }

    fn answer_with(&mut self, items: Items) {
        if let Some((due, _)) = &mut self.due {
            *due = items;
        }
    }

    /// Applies the rule for collisions: a module that receives a byte stops its reply.
    fn cancel(&mut self) {
        self.due = None;
        self.cancel_sending();
    }

    fn cancel_sending(&mut self) {
        self.sending.clear();
        self.sent = 0;
    }
}
