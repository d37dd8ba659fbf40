//! The controller's end of the line.

mod lease;
mod read_back;

use crate::buffer::Buffer;

use super::{
    AT_WORK, Axis, EMPTY, END_OF_TEXT, EXPIRED, FAULT, KEPT, LEASE, MachineState, NOT_ALL, Order,
    Rules,
};

/// The answer to `?`.
const HELP: &[u8] =
    b"B test  c clear  r home  b program  e run  m manual  n record  O S spindle  ? help\r\n\
    M manual, the program kept. program: X lo hi, Y lo hi, Z lo hi; f ends it. p at work?  E stops \
    a run\r\n\
    t lease x 50 ms, 0 none  0 clear, the zero kept\r\n\
    manual: D I x+ x-  F R y+ y-  U L up down  O S spindle  a advance  T teach  r c B e  Q \
    quit\r\n";

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Mode {
    Idle,
    /// Number of bytes since `b`.
    Download(u32),
    /// The next byte is the advance. `homes`: the device homes after it.
    Advance {
        homes: bool,
    },
    Manual,
    /// The number of a record is being received: its low byte, once that has arrived. The manual
    /// mode continues after it.
    Asked {
        low: Option<u8>,
        is_manual: bool,
    },
    /// The next byte is the lease.
    Lease,
}

/// The work during which the controller does not execute received bytes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Work {
    None,
    /// One or two orders, then an answer.
    Orders([Option<Order>; 2], Option<u8>),
    /// The program from this byte on, and what follows it.
    Program(usize, After),
}

/// What follows a program.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum After {
    Answer(u8),
    /// This byte, which arrived when the memory was full, is stored.
    Store(u8),
    /// A program begins, because the byte that arrived was `b`.
    Begin,
}

/// The controller's end of the drill's line: bytes in, one [`Order`] after another, bytes out. `N`
/// is its memory in bytes; the original has 8192.
///
/// | when | call |
/// | --- | --- |
/// | a byte arrives | [`push`](Device::push) |
/// | the machine is free | [`take`](Device::take), and [`done`](Device::done) when that is carried out |
/// | the transmitter is free | [`transmit`](Device::transmit) |
///
/// Bytes that arrive while the device works are lost, with two exceptions: the first byte, which
/// stays in the receiver, and `E`; see [`Rules`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Device<const N: usize> {
    rules: Rules,
    mode: Mode,
    memory: Buffer<N>,
    /// The first bytes of a record whose other bytes are at the start of the memory.
    carried: Buffer<2>,
    work: Work,
    /// An order is being carried out.
    is_busy: bool,
    stops: bool,
    /// The first byte that arrived during work. It is taken after the work.
    unheard: Option<u8>,
    advance: u8,
    out: Buffer<8>,
    sent: usize,
    /// The rest of the help text.
    help: &'static [u8],
    /// The present order is a drilling of a program.
    is_drilling: bool,
    /// The memory holds the end of a longer program.
    is_tail: bool,
    /// Number of drillings since `c`, modulo 2^16. The next field: whether a `c` has arrived since
    /// the reset.
    drillings: u16,
    was_cleared: bool,
    /// The longest permitted silence of the host during work, in units of 50 ms. 0: no limit.
    lease: u8,
    /// The present work ends, because its lease has expired.
    is_expired: bool,
    /// A fault has stopped the machine.
    has_failed: bool,
    machine: MachineState,
}

impl<const N: usize> Device<N> {
    /// Creates a device after a reset: it homes, then sends `B`.
    pub const fn new(rules: Rules) -> Device<N> {
        Device {
            rules,
            mode: Mode::Idle,
            memory: Buffer::new(),
            carried: Buffer::new(),
            work: Work::Orders([Some(Order::Home), None], Some(b'B')),
            is_busy: false,
            stops: false,
            unheard: None,
            advance: 0,
            out: Buffer::new(),
            sent: 0,
            help: &[],
            is_drilling: false,
            is_tail: false,
            drillings: 0,
            was_cleared: false,
            lease: 0,
            is_expired: false,
            has_failed: false,
            machine: MachineState::UNKNOWN,
        }
    }

    /// Takes a byte from the line.
    pub fn push(&mut self, byte: u8) {
        let is_leased = self.lease > 0 || self.is_expired;
        match self.work {
            Work::None => self.hear(byte),
            _ if self.has_failed && self.rules.has_extras => {
                if byte == AT_WORK {
                    self.out.push(FAULT);
                }
            }
            Work::Program(_, After::Answer(_)) if byte == AT_WORK && self.rules.has_extras => {
                self.say_at_work();
            }
            // With a lease the host asks while it waits. A byte with a wrong bit is not taken as a
            // command.
            Work::Orders(..) if is_leased => {
                if byte == AT_WORK {
                    self.say_at_work();
                }
            }
            Work::Program(_, After::Answer(_)) => self.stops |= byte == b'E',
            Work::Program(..) if self.rules.stops_at_border => self.stops |= byte == b'E',
            Work::Program(..) | Work::Orders(..) => {
                self.unheard.get_or_insert(byte);
            }
        }
    }

    /// Returns the next order for the machine. Returns `None` while the last one is not
    /// [`done`](Device::done), or if there is none.
    pub fn take(&mut self) -> Option<Order> {
        if self.is_busy {
            return None;
        }
        loop {
            let order = match self.work {
                Work::None => return None,
                Work::Orders([first, second], answer) => {
                    self.work = Work::Orders([second, None], answer);
                    if self.is_expired { None } else { first }
                }
                Work::Program(at, after) => {
                    // Below N + 2 as long as there is a record.
                    self.work = Work::Program(at.wrapping_add(3), after);
                    if self.stops || self.is_expired {
                        None
                    } else {
                        self.record(at)
                    }
                }
            };
            if order.is_some() {
                self.is_busy = true;
                self.is_drilling = matches!(order, Some(Order::Drill(_)));
                return order;
            }
            self.finish();
        }
    }

    /// Confirms that the order is carried out.
    pub fn done(&mut self) {
        let is_drilled = core::mem::take(&mut self.is_drilling);
        // modulo 2^16 by its meaning
        self.drillings = self.drillings.wrapping_add(u16::from(is_drilled));
        self.is_busy = false;
    }

    /// Adds a hole at this position, in steps, to the end of the program. The caller does this for
    /// [`Order::Teach`], before [`done`](Device::done). If the memory has no room for the nine
    /// bytes, the answer reports this.
    pub fn teach(&mut self, [x, y]: [u16; 2]) {
        let stored = self.memory.bytes().len();
        let is_whole = self.carried.bytes().is_empty() && stored.checked_rem(3) == Some(0);
        if !is_whole || self.is_tail || N.saturating_sub(stored) < 9 {
            return self.cut_short();
        }
        let ([x_low, x_high], [y_low, y_high]) = (x.to_le_bytes(), y.to_le_bytes());
        let hole = [b'X', x_low, x_high, b'Y', y_low, y_high, b'Z', 0, 0];
        self.memory.extend(&hole);
    }

    /// Registers that an order given by hand was not completed. A device with extras reports this
    /// in its answer.
    pub fn cut_short(&mut self) {
        if let (Work::Orders(orders, Some(_)), true) = (self.work, self.rules.has_extras) {
            self.work = Work::Orders(orders, Some(NOT_ALL));
        }
    }

    /// Registers that a fault has stopped the machine. The present order is never answered. A
    /// device with extras sends [`FAULT`] once, unless a host would take it for an echo.
    pub fn fail(&mut self) {
        self.has_failed = true;
        if self.rules.has_extras && self.awaited() != Some(FAULT) {
            self.out.push(FAULT);
        }
    }

    /// Returns the byte that the host waits for.
    const fn awaited(&self) -> Option<u8> {
        match self.work {
            Work::None => None,
            Work::Orders(_, answer) => answer,
            Work::Program(_, After::Answer(byte) | After::Store(byte)) => Some(byte),
            Work::Program(_, After::Begin) => Some(b'b'),
        }
    }

    /// Whether the program or an order given by hand is being executed.
    pub fn is_working(&self) -> bool {
        self.is_busy || self.work != Work::None
    }

    /// Returns the next byte for the line.
    pub fn transmit(&mut self) -> Option<u8> {
        if let Some(byte) = self.out.bytes().get(self.sent).copied() {
            self.sent = self.sent.wrapping_add(1); // 8 at most
            // It is cleared here, because the next byte may arrive before this function is called
            // again.
            if self.sent == self.out.bytes().len() {
                self.out.clear();
                self.sent = 0;
            }
            return Some(byte);
        }
        let (byte, rest) = self.help.split_first()?;
        self.help = rest;
        if rest.is_empty() {
            self.out.push(END_OF_TEXT);
        }
        Some(*byte)
    }

    /// Whether the device is in the manual mode.
    pub const fn is_manual(&self) -> bool {
        matches!(
            self.mode,
            Mode::Manual
                | Mode::Advance { .. }
                | Mode::Asked {
                    is_manual: true,
                    ..
                }
        )
    }

    /// Whether the device receives a program.
    pub const fn is_receiving(&self) -> bool {
        matches!(self.mode, Mode::Download(_))
    }

    /// Returns the bytes in the memory.
    pub fn stored(&self) -> &[u8] {
        self.memory.bytes()
    }

    fn hear(&mut self, byte: u8) {
        match self.mode {
            Mode::Idle => self.command(byte),
            Mode::Download(count) => self.download(byte, count),
            Mode::Advance { homes } => {
                self.advance = byte;
                self.out.push(byte);
                self.mode = Mode::Manual;
                if homes {
                    self.work = Work::Orders([Some(Order::Home), None], Some(b'm'));
                }
            }
            Mode::Manual => self.key(byte),
            Mode::Asked {
                low: None,
                is_manual,
            } => {
                self.out.push(byte);
                let low = Some(byte);
                self.mode = Mode::Asked { low, is_manual };
            }
            Mode::Lease => {
                self.lease = byte;
                self.out.push(byte);
                self.mode = Mode::Idle;
            }
            Mode::Asked {
                low: Some(low),
                is_manual,
            } => {
                self.out.push(byte);
                self.mode = if is_manual { Mode::Manual } else { Mode::Idle };
                self.read_back(u16::from_le_bytes([low, byte]));
            }
        }
    }

    fn command(&mut self, byte: u8) {
        match byte {
            b'B' => self.out.push(byte),
            b'c' => self.clear(),
            b'r' => self.work = Work::Orders([Some(Order::Home), None], Some(byte)),
            KEPT if self.rules.has_extras => {
                self.mode = Mode::Advance { homes: true };
                self.out.push(byte);
            }
            b'e' => self.run(After::Answer(byte)),
            b'b' if self.is_full() => {
                self.out.push(b'w');
                let after = if self.rules.begins_when_full {
                    After::Begin
                } else {
                    self.mode = Mode::Download(0);
                    After::Store(byte)
                };
                self.run(after);
            }
            b'b' => {
                self.mode = Mode::Download(0);
                self.out.push(byte);
            }
            b'm' => {
                self.mode = Mode::Advance { homes: true };
                self.out.push(byte);
            }
            b'O' | b'S' if self.rules.has_extras => {
                self.work = Work::Orders([Some(Order::Spindle(byte == b'O')), None], Some(byte));
            }
            b'n' if self.rules.has_extras => {
                self.ask(false);
            }
            LEASE if self.rules.has_extras => {
                self.mode = Mode::Lease;
                self.out.push(byte);
            }
            EMPTY if self.rules.has_extras => {
                self.empty();
                self.out.push(byte);
            }
            b'?' if self.rules.has_extras => {
                self.out.push(byte);
                self.help = HELP;
            }
            _ => {} // no answer
        }
    }

    /// Takes a byte of a program. The end of the program needs no room. Any other byte waits until
    /// there is room.
    fn download(&mut self, byte: u8, count: u32) {
        let may_end = count > 0 || self.rules.ends_when_empty;
        if byte == b'f' && may_end && count.checked_rem(3) == Some(0) {
            self.mode = Mode::Idle;
            self.out.push(byte);
        } else if self.is_full() {
            self.out.push(b'w');
            self.run(After::Store(byte));
        } else {
            self.store(byte, count);
        }
    }

    fn store(&mut self, byte: u8, count: u32) {
        self.memory.push(byte);
        self.mode = Mode::Download(next(count));
        self.out.push(byte);
    }

    fn key(&mut self, byte: u8) {
        let advance = i16::from(self.advance);
        let in_z = match advance {
            0 if self.rules.zero_is_no_move => 0,
            0 => 256,
            steps => steps,
        };
        let order = match byte {
            b'D' => Order::Jog(Axis::X, advance),
            b'I' => Order::Jog(Axis::X, -advance), // 255 at most
            b'F' => Order::Jog(Axis::Y, advance),
            b'R' => Order::Jog(Axis::Y, -advance),
            b'U' => Order::Jog(Axis::Z, -in_z), // 256 at most
            b'L' => Order::Jog(Axis::Z, in_z),
            b'O' => Order::Spindle(true),
            b'S' => Order::Spindle(false),
            b'T' if self.rules.has_extras => Order::Teach,
            b'r' => Order::Home,
            b'c' => return self.clear(),
            b'e' => return self.run(After::Answer(byte)),
            b'a' => {
                self.mode = Mode::Advance { homes: false };
                return self.out.push(byte);
            }
            b'Q' => {
                self.mode = Mode::Idle;
                return self.out.push(b'm');
            }
            b'n' if self.rules.has_extras => return self.ask(true),
            // This question arrived after the end of the work.
            AT_WORK if self.rules.has_extras => return,
            _ => return self.out.push(byte),
        };
        let is_move = !matches!(order, Order::Jog(_, 0));
        self.work = Work::Orders([is_move.then_some(order), None], Some(byte));
    }

    fn empty(&mut self) {
        self.memory.clear();
        self.carried.clear();
        self.is_tail = false;
        (self.drillings, self.was_cleared) = (0, true);
    }

    fn clear(&mut self) {
        self.empty();
        self.work = Work::Orders([Some(Order::Zero), None], Some(b'c'));
    }

    fn run(&mut self, after: After) {
        self.stops = false;
        self.work = Work::Program(0, after);
    }

    /// Whether the memory is full.
    pub fn is_full(&self) -> bool {
        self.memory.bytes().len() >= N
    }

    /// Returns the record that begins at this byte, counted from the first carried byte.
    fn record(&self, at: usize) -> Option<Order> {
        let carried = self.carried.bytes();
        let byte = |place: usize| {
            let all = carried.iter().chain(self.memory.bytes());
            // Indices are below N + 5. Only the first records contain carried bytes.
            match place.checked_sub(carried.len()) {
                Some(place) => self.memory.bytes().get(place).copied(),
                None => all.copied().nth(place),
            }
        };
        let letter = byte(at)?;
        let low = byte(at.wrapping_add(1))?;
        let high = byte(at.wrapping_add(2))?;
        let steps = u16::from_le_bytes([low, high]);
        match letter {
            b'f' => None,
            b'Y' => Some(Order::Move(Axis::Y, steps)),
            b'Z' if self.rules.z_is_depth => Some(Order::Drill(steps)),
            b'Z' => Some(Order::Drill(0)),
            _ => Some(Order::Move(Axis::X, steps)),
        }
    }

    /// Ends the present work.
    fn finish(&mut self) {
        let awaited = self.awaited();
        let work = core::mem::replace(&mut self.work, Work::None);
        match work {
            Work::None => {}
            _ if core::mem::take(&mut self.is_expired) => {
                if let Work::Program(_, After::Store(_)) = work {
                    self.memory.clear();
                    self.carried.clear();
                    self.mode = Mode::Idle;
                }
                let is_clear = |byte: u8| (byte ^ EXPIRED).count_ones() > 1;
                let answer = awaited.filter(|byte| is_clear(*byte)).map(|_| EXPIRED);
                self.work = Work::Orders([Some(Order::Spindle(false)), None], answer);
            }
            Work::Program(_, After::Answer(byte)) if self.rules.stops_spindle => {
                self.work = Work::Orders([Some(Order::Spindle(false)), None], Some(byte));
            }
            Work::Orders(_, answer) => answer.into_iter().for_each(|byte| self.out.push(byte)),
            Work::Program(_, After::Answer(byte)) => self.out.push(byte),
            Work::Program(_, After::Begin) => {
                self.restart_memory();
                self.mode = Mode::Download(0);
                self.out.push(b'b');
            }
            Work::Program(_, After::Store(_)) if self.stops => {
                self.memory.clear();
                self.carried.clear();
                self.mode = Mode::Idle;
                self.out.push(b'E');
            }
            Work::Program(_, After::Store(byte)) => {
                self.restart_memory();
                if let Mode::Download(count) = self.mode {
                    self.store(byte, count);
                }
            }
        }
        if let (Work::None, Some(byte)) = (self.work, self.unheard.take()) {
            self.hear(byte);
        }
    }

    /// Empties the memory. If it ends within a record, the part of this record is kept.
    fn restart_memory(&mut self) {
        let bytes = self.memory.bytes();
        let length = self.carried.bytes().len().wrapping_add(bytes.len()); // at most N + 2
        let part = length.checked_rem(3).unwrap_or_default();
        let from = bytes.len().saturating_sub(part);
        let mut carried = Buffer::new();
        carried.extend(bytes.get(from..).unwrap_or_default());
        self.carried = carried;
        self.memory.clear();
        self.is_tail = true;
    }
}

/// Returns the next count. At the end of its range the count keeps its remainder by three.
fn next(count: u32) -> u32 {
    // 2^32 - 1 is a multiple of 3, and so is the new count 3. A count that is not 0 does not become
    // 0.
    if count == u32::MAX - 1 {
        3
    } else {
        count.wrapping_add(1)
    }
}

/// The check byte of a record that is read back.
pub(super) fn check([letter, low, high]: [u8; 3]) -> u8 {
    !letter.wrapping_add(low).wrapping_add(high)
}

#[cfg(test)]
mod tests {
    use super::next;

    /// The remainder by three is that of an unbounded count, and the count never returns to 0.
    #[test]
    fn a_count_keeps_its_remainder_at_its_end() {
        let mut count = u32::MAX - 10;
        let mut true_count = u64::from(count);
        for _ in 0..30 {
            count = next(count);
            true_count += 1;
            assert_eq!(u64::from(count % 3), true_count % 3, "{count}");
            assert_ne!(count, 0);
        }
    }
}
