//! The link of the desktop microfactory: one byte per command.
//!
//! ```text
//! table      the byte of each command
//! figure     moves on the line, and their check
//! status     the answers of a device to a status request, and to one for its home switches
//! ```
//!
//! The original uses 9600 baud, without echo or reply. Its description states its modes but no byte
//! values. The values here are ours and may be changed in the [`ByteTable`]. A count may be any
//! byte from 1 to 255, letters included, so the meaning of a byte depends on the mode.
//!
//! The figure of the original is built in. A [`Device::storing`] accepts other figures: `<`, then
//! `3` and four bytes per move, then `6` with the number of moves and a check. After `<` there is
//! no figure until this check is right, so a damaged figure is never cut. A controller of two
//! machines ([`Device::of_two_machines`]) accepts `o` and `t`. The commands after `o` are for
//! machine one, those after `t` for machine two. Five bytes [`ByteTable::stop`] end any
//! half-received command, because at most four of them are taken as its data.

mod figure;
mod status;
mod table;

pub use figure::{figure_check, move_bytes};
pub use status::{Report, STATUS_BYTES, SWITCHES_BYTES, Status, Switches};
pub use table::{ByteTable, MOTORS};

use figure::{checked, move_of};

/// A command of the host.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Order {
    /// Home X, Y and Z.
    Home,
    /// Turn a motor until [`Order::Stop`]. While the motor turns, the same command again renews the
    /// jog.
    Jog {
        /// 0 to 2 for X, Y, Z; 3 for the spindle.
        motor: u8,
        /// Forward, or clockwise.
        forward: bool,
    },
    /// Turn a motor by a number of steps.
    Steps {
        /// 0 to 3.
        motor: u8,
        /// Forward, or clockwise.
        forward: bool,
        /// 1 to 255.
        count: u8,
    },
    /// Cut the stored figure.
    Figure,
    /// Stop the motion.
    Stop,
    /// Stop at once, and obey nothing until a reset.
    Emergency,
    /// Begin another figure. The stored one is deleted. There is no figure until [`Order::Keep`].
    Clear,
    /// A move of the new figure: steps of X and Z.
    Line([i16; 2]),
    /// The moves since [`Order::Clear`] are the figure. Their number and their check are right.
    Keep,
    /// Report. The bytes of a [`Status`] follow the answer.
    Ask,
    /// Report where the home switches closed. The bytes of [`Switches`] follow the answer.
    Switches,
    /// From now on a motion ends when the line is silent for this time, in units of 10 ms. 0: a
    /// motion needs no host. A reset sets 0.
    Lease(u8),
}

impl Order {
    /// Whether this order begins or ends a motion. The controller of the machine accepts or refuses
    /// such an order. The other orders concern the stored figure or the lease, or request a report.
    pub const fn is_a_motion(self) -> bool {
        !matches!(
            self,
            Self::Clear | Self::Line(_) | Self::Keep | Self::Ask | Self::Switches | Self::Lease(_)
        )
    }
}

/// The state of the parser.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
enum Mode {
    /// No mode is chosen, or the mode is home or figure, which take no more bytes.
    None,
    /// The motor of the last jog, and whether it is forward.
    Manual(Option<(u8, bool)>),
    Steps,
    /// The next byte is a count, whatever its value.
    Count(u8, bool),
    Ready {
        motor: u8,
        forward: bool,
        count: u8,
    },
    Emergency,
    /// The next byte is the time of the lease, whatever its value.
    Lease,
    /// Four bytes follow, whatever their values. They belong to a move or to the end of a figure.
    Data {
        is_end: bool,
        bytes: [u8; 4],
        count: u8,
    },
}

/// The result of a byte.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Received {
    /// The command that this byte completes.
    pub command: Option<Order>,
    /// The byte to send back. `None`: there is no acknowledgement.
    pub reply: Option<u8>,
}

/// The device's end: bytes in, commands out.
///
/// A mode can be left only while nothing moves. With acknowledgement, the device sends back every
/// accepted byte and answers every other byte with `?`. The original has no acknowledgement.
///
/// # Examples
///
/// ```
/// use husillo_transports::microfactory::{Order, Device, ByteTable};
///
/// let mut link = Device::new(ByteTable::DEFAULT);
/// let commands: Vec<Order> = b"NxHE" // steps, X backward, 72 of them, run
///     .iter()
///     .filter_map(|byte| link.receive(*byte, false).command)
///     .collect();
/// assert_eq!(commands, [Order::Steps { motor: 0, forward: false, count: 72 }]);
/// ```
#[derive(Clone, Debug)]
pub struct Device {
    table: ByteTable,
    mode: Mode,
    acknowledges: bool,
    /// Largest number of moves of a figure.
    room: u16,
    /// Whether there are two machines. The next field is the machine that receives the commands.
    is_pair: bool,
    machine: u8,
    loading: Option<Loading>,
}

/// A figure in transfer.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
struct Loading {
    moves: u16,
    check: u16,
}

/// The answer to a byte that is not accepted.
pub const REJECTED: u8 = b'?';

impl Device {
    /// Creates a device without a chosen mode and without acknowledgement.
    pub const fn new(table: ByteTable) -> Self {
        Self {
            table,
            mode: Mode::None,
            acknowledges: false,
            room: 0,
            is_pair: false,
            machine: 0,
            loading: None,
        }
    }

    /// Adds acknowledgement.
    pub const fn acknowledging(mut self) -> Self {
        self.acknowledges = true;
        self
    }

    /// Adds room for figures of up to `moves` moves.
    pub const fn storing(mut self, moves: u16) -> Self {
        self.room = moves;
        self
    }

    /// Makes it the controller of two machines. Commands are for the first machine until a byte of
    /// [`ByteTable::machines`] chooses another one.
    pub const fn of_two_machines(mut self) -> Self {
        self.is_pair = true;
        self
    }

    /// Returns the machine that commands are for, 0 or 1. The argument `is_moving` of
    /// [`receive`](Self::receive) concerns this machine. An emergency stop is for both.
    pub const fn machine(&self) -> u8 {
        self.machine
    }

    /// Sets the state after power-up or reset. This is the only way out of an emergency stop.
    pub const fn reset(&mut self) {
        self.mode = Mode::None;
        self.loading = None;
        self.machine = 0;
    }

    /// Leaves the mode after a home switch has ended a motion. The host must then choose a mode
    /// again. So a host that has not noticed the switch does not move the axis onto it again.
    pub const fn leave_mode(&mut self) {
        if let Mode::Manual(_) | Mode::Steps | Mode::Count(..) | Mode::Ready { .. } = self.mode {
            self.mode = Mode::None;
        }
    }

    /// Takes a byte from the line. `is_moving`: a motor turns.
    ///
    /// While a motor turns, only [`Order::Stop`], [`Order::Emergency`] and the repeated jog are
    /// accepted.
    pub fn receive(&mut self, byte: u8, is_moving: bool) -> Received {
        let taken = self.take(byte, is_moving);
        let answer = if taken.is_some() { byte } else { REJECTED };
        Received {
            command: taken.flatten(),
            reply: self.acknowledges.then_some(answer),
        }
    }

    /// Returns `None` if the byte is not accepted, and `Some(None)` if it is accepted and more
    /// bytes are needed.
    fn take(&mut self, byte: u8, is_moving: bool) -> Option<Option<Order>> {
        if let Mode::Count(motor, forward) = self.mode {
            // Nothing moves while a count is expected, because a motor is chosen only at
            // standstill.
            if byte == 0 {
                self.mode = Mode::Steps;
                return None;
            }
            self.mode = Mode::Ready {
                motor,
                forward,
                count: byte,
            };
            return Some(None);
        }
        if let Mode::Data {
            is_end,
            bytes,
            count,
        } = self.mode
        {
            return self.data(is_end, bytes, count, byte);
        }
        if self.mode == Mode::Lease {
            self.mode = Mode::None;
            return Some(Some(Order::Lease(byte)));
        }
        let table = self.table;
        // Without acknowledgement there are no answers.
        if byte == table.ask && self.acknowledges {
            return Some(Some(Order::Ask));
        }
        if byte == table.switches && self.acknowledges {
            return Some(Some(Order::Switches));
        }
        if self.is_pair && table.machines.contains(&byte) {
            self.turn_to(byte);
            return Some(None);
        }
        if self.mode == Mode::Emergency {
            return None;
        }
        if byte == table.emergency {
            self.mode = Mode::Emergency;
            return Some(Some(Order::Emergency));
        }
        if byte == table.stop {
            return Some(Some(Order::Stop));
        }
        let motor = table.motor(byte);
        if let (Mode::Manual(last), Some((motor, forward))) = (self.mode, motor) {
            if is_moving && last != Some((motor, forward)) {
                return None;
            }
            self.mode = Mode::Manual(Some((motor, forward)));
            return Some(Some(Order::Jog { motor, forward }));
        }
        if is_moving {
            return None;
        }
        let is_steps = matches!(self.mode, Mode::Steps | Mode::Ready { .. });
        match (self.mode, motor) {
            (_, Some((motor, forward))) if is_steps => {
                self.mode = Mode::Count(motor, forward);
                Some(None)
            }
            (
                Mode::Ready {
                    motor,
                    forward,
                    count,
                },
                None,
            ) if byte == table.run => Some(Some(Order::Steps {
                motor,
                forward,
                count,
            })),
            _ => self.choose(byte),
        }
    }

    /// Selects one of two machines.
    fn turn_to(&mut self, byte: u8) {
        let [_, second] = self.table.machines;
        self.machine = u8::from(byte == second);
        // The mode and a figure in transfer belonged to the other machine. An emergency stop
        // applies to both machines.
        if self.mode != Mode::Emergency {
            self.mode = Mode::None;
        }
        self.loading = None;
    }

    /// Takes a byte of a move, or of the end of a figure.
    fn data(
        &mut self,
        is_end: bool,
        mut bytes: [u8; 4],
        count: u8,
        byte: u8,
    ) -> Option<Option<Order>> {
        if let Some(place) = bytes.get_mut(usize::from(count)) {
            *place = byte;
        }
        if count < 3 {
            self.mode = Mode::Data {
                is_end,
                bytes,
                // At most 3.
                count: count.wrapping_add(1),
            };
            return Some(None);
        }
        self.mode = Mode::None;
        let loading = self.loading?;
        if is_end {
            self.loading = None;
            let [moves0, moves1, check0, check1] = bytes;
            let is_right = loading.moves == u16::from_le_bytes([moves0, moves1])
                && loading.check == u16::from_le_bytes([check0, check1]);
            return is_right.then_some(Some(Order::Keep));
        }
        self.loading = Some(Loading {
            // A move begins only if there is room for one more, so this does not overflow.
            moves: loading.moves.wrapping_add(1),
            check: checked(loading.check, &bytes),
        });
        Some(Some(Order::Line(move_of(bytes))))
    }

    /// Takes a byte that chooses a mode.
    fn choose(&mut self, byte: u8) -> Option<Option<Order>> {
        let data = |is_end| Mode::Data {
            is_end,
            bytes: [0; 4],
            count: 0,
        };
        let has_room = self
            .loading
            .is_some_and(|loading| loading.moves < self.room);
        let (mode, command) = match byte {
            _ if byte == self.table.clear && self.room > 0 => {
                self.loading = Some(Loading { moves: 0, check: 0 });
                (Mode::None, Some(Order::Clear))
            }
            _ if byte == self.table.line && has_room => (data(false), None),
            _ if byte == self.table.keep && self.loading.is_some() => (data(true), None),
            // A host that does not receive answers cannot renew a lease.
            _ if byte == self.table.lease && self.acknowledges => (Mode::Lease, None),
            _ if byte == self.table.home => (Mode::None, Some(Order::Home)),
            _ if byte == self.table.figure => (Mode::None, Some(Order::Figure)),
            _ if byte == self.table.manual => (Mode::Manual(None), None),
            _ if byte == self.table.steps => (Mode::Steps, None),
            _ => return None,
        };
        self.mode = mode;
        Some(command)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn commands(link: &mut Device, bytes: &[u8]) -> [Option<Order>; 8] {
        let mut found = [None; 8];
        let complete = bytes
            .iter()
            .filter_map(|byte| link.receive(*byte, false).command);
        for (place, command) in found.iter_mut().zip(complete) {
            *place = Some(command);
        }
        found
    }

    #[test]
    fn a_count_may_be_any_letter() {
        for count in 1..=255_u8 {
            let mut link = Device::new(ByteTable::DEFAULT);
            let [found, rest @ ..] = commands(&mut link, &[b'N', b'C', count, b'E']);
            let expected = Order::Steps {
                motor: 3,
                forward: true,
                count,
            };
            assert_eq!((found, rest), (Some(expected), [None; 7]));
        }
    }

    #[test]
    fn a_count_of_nothing_is_none() {
        let mut link = Device::new(ByteTable::DEFAULT).acknowledging();
        let replies =
            [b'N', b'X', 0, b'E', b'X', 7, b'E', b'E'].map(|byte| link.receive(byte, false).reply);
        let expected = [b'N', b'X', b'?', b'?', b'X', 7, b'E', b'E'];
        assert_eq!(replies, expected.map(Some));
    }

    /// The time of a lease may be any byte. If the command was cut off, at most four stops end it.
    #[test]
    fn a_lease_has_a_time() {
        let mut link = Device::new(ByteTable::DEFAULT).acknowledging();
        for time in 0..=255_u8 {
            let found = commands(&mut link, &[b'l', time]);
            assert_eq!(found[0], Some(Order::Lease(time)));
            assert!(found[1].is_none());
        }
        assert_eq!(link.receive(b'l', true).reply, Some(REJECTED));
        // A device without answers has no lease, because its host could not know of it.
        let mut original = Device::new(ByteTable::DEFAULT);
        assert_eq!(commands(&mut original, b"lA")[0], Some(Order::Stop));
    }

    #[test]
    fn a_mode_is_left_only_standing() {
        let mut link = Device::new(ByteTable::DEFAULT).acknowledging();
        link.receive(b'J', false);
        for byte in *b"HJNGE" {
            let received = link.receive(byte, true);
            assert_eq!((received.command, received.reply), (None, Some(REJECTED)));
        }
        assert_eq!(link.receive(b'A', true).command, Some(Order::Stop));
        assert_eq!(link.receive(b'H', false).command, Some(Order::Home));
        // Homing is a mode without letters of motors.
        assert_eq!(link.receive(b'X', false).reply, Some(REJECTED));
    }

    #[test]
    fn only_the_jog_under_way_is_said_again() {
        let mut link = Device::new(ByteTable::DEFAULT);
        link.receive(b'J', false);
        let forward = Some(Order::Jog {
            motor: 1,
            forward: true,
        });
        assert_eq!(link.receive(b'Y', false).command, forward);
        assert_eq!(link.receive(b'y', true).command, None);
        assert_eq!(link.receive(b'Y', true).command, forward);
    }

    #[test]
    fn behind_a_switch_a_mode_is_chosen_anew() {
        let mut link = Device::new(ByteTable::DEFAULT).acknowledging();
        for (mode, letter) in [(b"J", b'x'), (b"N", b'x')] {
            link.receive(mode[0], false);
            assert_eq!(link.receive(letter, false).reply, Some(letter));
            link.leave_mode();
            assert_eq!(link.receive(letter, false).reply, Some(REJECTED));
            link.receive(mode[0], false);
            assert_eq!(link.receive(letter, false).reply, Some(letter));
            link.leave_mode();
        }
        link.receive(b'!', false);
        link.leave_mode();
        assert_eq!(link.receive(b'H', false).reply, Some(REJECTED));
    }

    #[test]
    fn a_byte_chooses_between_two_machines() {
        let mut one = Device::new(ByteTable::DEFAULT).acknowledging();
        assert_eq!(one.receive(b't', false).reply, Some(REJECTED));
        let mut link = Device::new(ByteTable::DEFAULT)
            .acknowledging()
            .of_two_machines();
        link.receive(b'J', false);
        assert_eq!(link.receive(b'X', false).reply, Some(b'X'));
        // A machine may be chosen while the other one moves. The mode belonged to that other
        // machine.
        assert_eq!(link.receive(b't', true).reply, Some(b't'));
        assert_eq!(link.machine(), 1);
        assert_eq!(link.receive(b'X', false).reply, Some(REJECTED));
        // Where a count is expected, the byte is a count.
        for byte in *b"NYo" {
            assert_eq!(link.receive(byte, false).reply, Some(byte));
        }
        let expected = Order::Steps {
            motor: 1,
            forward: true,
            count: b'o',
        };
        assert_eq!(link.receive(b'E', false).command, Some(expected));
        assert_eq!(link.machine(), 1);
        // An emergency stop is for both.
        link.receive(b'!', true);
        assert_eq!(link.receive(b'o', false).reply, Some(b'o'));
        assert_eq!(link.receive(b'H', false).reply, Some(REJECTED));
        link.receive(b't', false);
        link.reset();
        assert_eq!(link.machine(), 0);
    }

    #[test]
    fn an_emergency_stays() {
        let mut link = Device::new(ByteTable::DEFAULT);
        assert_eq!(link.receive(b'!', true).command, Some(Order::Emergency));
        assert_eq!(commands(&mut link, b"AHJXNX\x05EG"), [None; 8]);
        link.reset();
        assert_eq!(link.receive(b'H', false).command, Some(Order::Home));
    }

    #[test]
    fn it_is_asked_at_any_time_where_it_answers() {
        let mut link = Device::new(ByteTable::DEFAULT);
        assert_eq!(link.receive(b'5', true).command, None);
        assert_eq!(link.receive(b'w', true).command, None);
        let mut link = link.acknowledging();
        link.receive(b'!', true);
        assert_eq!(link.receive(b'5', true).command, Some(Order::Ask));
        assert_eq!(link.receive(b'w', true).command, Some(Order::Switches));
        assert_eq!(link.receive(b'H', false).command, None);
    }

    #[test]
    fn a_table_has_every_byte_once() {
        assert!(ByteTable::DEFAULT.is_unambiguous());
        for (stop, is_right) in [(b'S', true), (b'H', false), (b'?', false), (b'c', false)] {
            let table = ByteTable {
                stop,
                ..ByteTable::DEFAULT
            };
            assert_eq!(table.is_unambiguous(), is_right, "{stop}");
        }
    }
}
