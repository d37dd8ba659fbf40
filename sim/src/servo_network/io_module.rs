//! A module with inputs and outputs on the line of the servo modules.

use husillo_transports::nmc::{Command, Frame, Group, Receiver, Verdict};

use super::node::Change;

/// Kind of a module with inputs and outputs, in its replies.
const KIND: u8 = 2;
/// Twelve pins.
const PINS: u16 = 0x0fff;

/// A packet that is carried out at the end of the period.
#[derive(Clone, Debug)]
enum Pending {
    /// A damaged packet, with the reply that is due.
    Damaged,
    Packet(Frame),
}

/// A PIC-I/O module of J. R. Kerr's network, device type 2: twelve pins, each an input or an
/// output, two PWM outputs, and three analogue inputs.
///
/// | code | command | data |
/// | --- | --- | --- |
/// | 0 | Set I/O Direction | low and high byte; 1 is an input |
/// | 4 | Set PWM | duties of both outputs |
/// | 5 | Synchronous Output | - |
/// | 6 | Set Output | low and high byte |
/// | 7 | Set Synchronous Output | low and high byte, both duties |
/// | 8 | Set Timer Mode | mode |
/// | C | Synchronous Input | - |
///
/// Addressing, status, rate and reset are those of the servo modules. The items of a reply are the
/// pins (2 bytes), three analogue inputs (1 byte each), the timer (4 bytes), type and version, the
/// pins at the last Synchronous Input (2 bytes) and the timer then (4 bytes). An output reads as
/// its own level.
///
/// The timer has 32 bits. Its mode is 0 for off, 1 for a timer, and 3 for a counter of the pulses
/// at its input. 00, 10, 20 or 30 hex is added to divide the counts by 1, 2, 4 or 8. A timer counts
/// the 5 MHz of the instructions of the chip, whose clock has 20 MHz. The available documents do
/// not state the effect of a new mode. Here a new mode sets the count to 0, but the mode off keeps
/// it.
#[derive(Clone, Debug)]
pub(super) struct IoModule {
    version: u8,
    receiver: Receiver,
    is_enabled: bool,
    is_addressed: bool,
    address: u8,
    group: Group,
    items: u8,
    pending: Option<Pending>,
    /// Whether the waiting packet is answered.
    replies: bool,
    sending: Vec<u8>,
    sent: usize,
    pins: Pins,
    timer: Timer,
}

/// Counts of the timer in a servo period of 512 us, at 5 MHz.
const COUNTS: u64 = 2560;

/// The timer of a module.
#[derive(Clone, Copy, Debug, Default)]
struct Timer {
    /// 0 off, 1 timer, 3 counter.
    mode: u8,
    /// The counts are divided by 2 to this power.
    shift: u8,
    /// Counts before the division. 2^64 take 10^5 years.
    counts: u64,
    /// Pulses at the input so far.
    pulses: u32,
    /// The timer at the last Synchronous Input.
    captured: u32,
}

impl Timer {
    /// Begins to count in a mode.
    const fn begin(&mut self, mode: u8) {
        self.mode = mode & 3;
        if mode & 1 == 1 {
            self.shift = mode >> 4 & 3;
            self.counts = 0;
        }
    }

    /// Counts one period. `pulses` is the number of pulses at the input so far.
    fn pass(&mut self, pulses: u32) {
        let new = pulses.wrapping_sub(std::mem::replace(&mut self.pulses, pulses));
        match self.mode {
            1 => self.counts += COUNTS,
            3 => self.counts += u64::from(new),
            _ => {}
        }
    }

    /// The 32 bits of the reading.
    const fn reading(self) -> u32 {
        (self.counts >> self.shift) as u32
    }
}

/// The pins of a module with inputs and outputs.
#[derive(Clone, Copy, Debug)]
struct Pins {
    /// A bit is set for an input.
    directions: u16,
    outputs: u16,
    duties: [u8; 2],
    /// Outputs and duties of the next Synchronous Output.
    next: (u16, [u8; 2]),
    /// Pins at the last Synchronous Input.
    captured: u16,
}

impl Default for Pins {
    fn default() -> Pins {
        Pins {
            directions: PINS,
            outputs: 0,
            duties: [0; 2],
            next: (0, [0; 2]),
            captured: 0,
        }
    }
}

impl Pins {
    /// Levels of all pins; `inputs` are the levels from outside.
    const fn levels(self, inputs: u16) -> u16 {
        (inputs & self.directions | self.outputs & !self.directions) & PINS
    }

    /// Executes a command of the pins. Unknown ones and wrong lengths have no effect.
    fn execute(&mut self, code: u8, data: &[u8], inputs: u16) {
        let word = |low: u8, high: u8| u16::from_le_bytes([low, high]) & PINS;
        match (code, data) {
            (0x0, &[low, high]) => self.directions = word(low, high),
            (0x4, &[one, two]) => self.duties = [one, two],
            (0x5, []) => (self.outputs, self.duties) = self.next,
            (0x6, &[low, high]) => self.outputs = word(low, high),
            (0x7, &[low, high, one, two]) => self.next = (word(low, high), [one, two]),
            (0xC, []) => self.captured = self.levels(inputs),
            _ => {}
        }
    }
}

/// What the pins of a module with inputs and outputs are connected to.
#[derive(Copy, Clone, Debug, Default, PartialEq, Eq)]
pub struct IoInputs {
    /// Levels at the twelve pins, where they are inputs.
    pub pins: u16,
    /// Readings of the three analogue inputs.
    pub analogue: [u8; 3],
    /// Pulses at the input of the counter so far, modulo 2^32.
    pub pulses: u32,
}

impl IoModule {
    /// The state after power-up: all pins are inputs.
    pub(super) fn new(version: u8) -> IoModule {
        IoModule {
            version,
            receiver: Receiver::new(),
            is_enabled: false,
            is_addressed: false,
            address: 0,
            group: Group::NONE,
            items: 0,
            pending: None,
            replies: false,
            sending: Vec::new(),
            sent: 0,
            pins: Pins::default(),
            timer: Timer::default(),
        }
    }

    pub(super) const fn version(&self) -> u8 {
        self.version
    }

    pub(super) fn set_enabled(&mut self, is_enabled: bool) {
        self.is_enabled = is_enabled;
        if !is_enabled {
            self.receiver.reset();
            self.pending = None;
            self.sending.clear();
        }
    }

    pub(super) const fn enables_next(&self) -> bool {
        self.is_addressed
    }

    /// Levels of the outputs; pins that are inputs are 0.
    pub(super) const fn outputs(&self) -> u16 {
        self.pins.levels(0)
    }

    /// Duties of both PWM outputs.
    pub(super) const fn duties(&self) -> [u8; 2] {
        self.pins.duties
    }

    /// Takes a byte of the command line. The byte ends any reply.
    pub(super) fn push(&mut self, byte: u8) {
        if !self.is_enabled {
            return;
        }
        self.replies = false;
        self.sending.clear();
        let Some(verdict) = self.receiver.push(byte) else {
            return;
        };
        let address = self.receiver.address();
        let is_own = address == self.address;
        let is_group = address >= 0x80 && address == self.group.address;
        if !(is_own || is_group) || self.pending.is_some() {
            return;
        }
        self.replies = is_own || self.group.is_leader;
        self.pending = Some(match verdict {
            Verdict::Sound => Pending::Packet(Frame::new(
                address,
                self.receiver.code(),
                self.receiver.data(),
            )),
            _ => Pending::Damaged,
        });
    }

    /// Executes the waiting packet, and prepares the reply.
    pub(super) fn tick(&mut self, inputs: &IoInputs) -> Option<Change> {
        self.timer.pass(inputs.pulses);
        let (mut items, mut status) = (self.items, 0x02);
        let mut change = None;
        if let Pending::Packet(frame) = self.pending.take()? {
            status = 0;
            let [_, _, head, data @ .., _] = frame.bytes() else {
                return None;
            };
            let code = head & 0x0f;
            match Self::of_line(code, data) {
                Some(Command::SetAddress { address, group }) => {
                    (self.address, self.group) = (address, group);
                    self.is_addressed = true;
                }
                Some(Command::DefineStatus(defined)) => {
                    self.items = defined.0;
                    items = defined.0;
                }
                Some(Command::ReadStatus(read)) => items = read.0,
                Some(Command::SetBaud(baud)) => change = Some(Change::Baud(baud)),
                Some(Command::HardReset(_)) => {
                    let is_enabled = self.is_enabled;
                    *self = IoModule::new(self.version);
                    self.is_enabled = is_enabled;
                    return Some(Change::Reset);
                }
                _ => self.execute(code, data, inputs.pins),
            }
        }
        if std::mem::take(&mut self.replies) {
            self.reply(status, items, inputs);
        }
        change
    }

    fn execute(&mut self, code: u8, data: &[u8], inputs: u16) {
        match (code, data) {
            (0x8, &[mode]) => self.timer.begin(mode),
            _ => self.pins.execute(code, data, inputs),
        }
        if (code, data) == (0xC, &[]) {
            self.timer.captured = self.timer.reading();
        }
    }

    /// A command that all kinds of modules have.
    fn of_line(code: u8, data: &[u8]) -> Option<Command> {
        let is_of_line = matches!(code, 0x1 | 0x2 | 0x3 | 0xA | 0xE | 0xF);
        // Decoded as by servo modules of the oldest version.
        is_of_line.then(|| Command::decode(code, data, 4)).flatten()
    }

    fn reply(&mut self, status: u8, items: u8, inputs: &IoInputs) {
        let pins = self.pins.levels(inputs.pins).to_le_bytes();
        let captured = self.pins.captured.to_le_bytes();
        let [one, two, three] = &inputs.analogue;
        let timer = self.timer.reading().to_le_bytes();
        let captured_timer = self.timer.captured.to_le_bytes();
        let values: [&[u8]; 8] = [
            &pins,
            std::slice::from_ref(one),
            std::slice::from_ref(two),
            std::slice::from_ref(three),
            &timer,
            &[KIND, self.version],
            &captured,
            &captured_timer,
        ];
        self.sending = vec![status];
        for (bit, value) in values.iter().enumerate() {
            if items >> bit & 1 == 1 {
                self.sending.extend_from_slice(value);
            }
        }
        let sum = self.sending.iter().fold(0_u8, |a, b| a.wrapping_add(*b));
        self.sending.push(sum);
        self.sent = 0;
    }

    /// The next byte of a reply.
    pub(super) fn transmit(&mut self) -> Option<u8> {
        let byte = self.sending.get(self.sent).copied();
        self.sent += 1;
        byte
    }
}

#[cfg(test)]
mod tests {
    use super::super::node::Change;
    use super::{IoInputs, IoModule};

    fn bytes(hex: &str) -> Vec<u8> {
        let pairs = hex.split_whitespace();
        pairs
            .map(|pair| u8::from_str_radix(pair, 16).unwrap())
            .collect()
    }

    fn ask(module: &mut IoModule, inputs: &IoInputs, packet: &str) -> Vec<u8> {
        bytes(packet).iter().for_each(|byte| module.push(*byte));
        module.tick(inputs);
        std::iter::from_fn(|| module.transmit()).collect()
    }

    fn addressed() -> IoModule {
        let mut module = IoModule::new(2);
        module.set_enabled(true);
        let told = ask(&mut module, &IoInputs::default(), "aa 00 21 02 ff 22");
        assert_eq!(told, [0, 0]);
        assert!(module.enables_next());
        module
    }

    /// The packets of a client of such a module, recorded from real hardware.
    #[test]
    fn outputs_read_as_they_are_driven_and_inputs_as_they_are_connected() {
        let mut module = addressed();
        let inputs = IoInputs {
            pins: 0x0d08,
            analogue: [0x2a, 7, 9],
            pulses: 0,
        };
        assert_eq!(
            ask(&mut module, &inputs, "aa 02 13 20 35"),
            bytes("00 02 02 04")
        );
        // Status, pins low and high, first analogue input.
        let told = ask(&mut module, &inputs, "aa 02 12 03 17");
        assert_eq!(told, bytes("00 08 0d 2a 3f"));
        // Pins 8, 9 and 10 become outputs, and pin 9 goes high.
        ask(&mut module, &inputs, "aa 02 20 df 08 09");
        let told = ask(&mut module, &inputs, "aa 02 26 20 02 4a");
        assert_eq!(told, bytes("00 28 0a 2a 5c"));
        assert_eq!(module.outputs(), 0x0220);
    }

    #[test]
    fn synchronous_outputs_wait_and_inputs_are_captured() {
        let mut module = addressed();
        let inputs = IoInputs {
            pins: 0x0001,
            ..IoInputs::default()
        };
        ask(&mut module, &inputs, "aa 02 20 01 00 23");
        ask(&mut module, &inputs, "aa 02 47 10 00 80 40 19");
        assert_eq!((module.outputs(), module.duties()), (0, [0; 2]));
        ask(&mut module, &inputs, "aa 02 05 07");
        assert_eq!((module.outputs(), module.duties()), (0x10, [0x80, 0x40]));
        ask(&mut module, &inputs, "aa 02 0c 0e");
        let told = ask(&mut module, &IoInputs::default(), "aa 02 13 41 56");
        assert_eq!(told, bytes("00 10 00 11 00 21"));
    }

    /// Reading of the timer, or of the captured one.
    fn timer(module: &mut IoModule, inputs: &IoInputs, packet: &str) -> u32 {
        let told = ask(module, inputs, packet);
        u32::from_le_bytes([told[1], told[2], told[3], told[4]])
    }

    const TIMER: &str = "aa 02 13 10 25";
    const CAPTURED: &str = "aa 02 13 80 95";

    #[test]
    fn the_timer_counts_time_and_is_captured() {
        let none = IoInputs::default();
        // One count in 1, 2, 4 and 8.
        for (set, counts) in [
            ("aa 02 18 01 1b", 2560),
            ("aa 02 18 11 2b", 1280),
            ("aa 02 18 21 3b", 640),
            ("aa 02 18 31 4b", 320),
        ] {
            let mut module = addressed();
            assert_eq!(timer(&mut module, &none, TIMER), 0, "off at first");
            ask(&mut module, &none, set);
            (0..99).for_each(|_| assert!(module.tick(&none).is_none()));
            assert_eq!(timer(&mut module, &none, TIMER), 100 * counts);
            ask(&mut module, &none, "aa 02 0c 0e");
            assert_eq!(timer(&mut module, &none, CAPTURED), 101 * counts);
            assert_eq!(timer(&mut module, &none, TIMER), 103 * counts);
            // Off keeps the count, on begins again.
            ask(&mut module, &none, "aa 02 18 00 1a");
            module.tick(&none);
            assert_eq!(timer(&mut module, &none, TIMER), 104 * counts);
            ask(&mut module, &none, set);
            assert_eq!(timer(&mut module, &none, TIMER), counts);
        }
    }

    #[test]
    fn the_counter_counts_pulses() {
        let pulses = |pulses| IoInputs {
            pulses,
            ..IoInputs::default()
        };
        let mut module = addressed();
        // Pulses before the mode do not count.
        module.tick(&pulses(7));
        ask(&mut module, &pulses(7), "aa 02 18 03 1d");
        assert_eq!(timer(&mut module, &pulses(7), TIMER), 0);
        assert_eq!(timer(&mut module, &pulses(30), TIMER), 23);
        ask(&mut module, &pulses(30), "aa 02 18 13 2d");
        assert_eq!(timer(&mut module, &pulses(41), TIMER), 5, "one in two");
        assert_eq!(timer(&mut module, &pulses(42), TIMER), 6);
    }

    #[test]
    fn a_damaged_packet_is_answered_and_not_executed() {
        let mut module = addressed();
        let told = ask(&mut module, &IoInputs::default(), "aa 02 26 20 00 49");
        assert_eq!(told, [2, 2]);
        assert_eq!(module.outputs(), 0);
        let told = ask(&mut module, &IoInputs::default(), "aa 02 0e 10");
        assert_eq!(told, [0, 0]);
    }

    #[test]
    fn a_reset_is_not_answered_and_takes_the_address() {
        let mut module = addressed();
        bytes("aa ff 0f 0e")
            .iter()
            .for_each(|byte| module.push(*byte));
        assert!(matches!(
            module.tick(&IoInputs::default()),
            Some(Change::Reset)
        ));
        assert_eq!(module.transmit(), None);
        assert!(!module.enables_next());
    }
}
