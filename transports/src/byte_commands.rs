//! One byte a command: the link of the desktop microfactory.
//!
//! The original (9600 baud, no echo, no reply) states its modes but no byte values; the values here are ours and may be changed in the
//! [`ByteTable`]. A count may be any byte from 1 to 255, letters among them, so what a byte means depends on the mode.

/// Motors that a table has letters for: X, Y, Z and the spindle.
pub const MOTORS: usize = 4;

/// The byte of each command.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct ByteTable {
    /// Home all axes.
    pub home: u8,
    /// Into jogging.
    pub manual: u8,
    /// Into counted steps.
    pub steps: u8,
    /// Cut the stored figure.
    pub figure: u8,
    /// Forward and backward of each motor.
    pub motors: [[u8; 2]; MOTORS],
    /// Stop what moves.
    pub stop: u8,
    /// Make the counted steps.
    pub run: u8,
    /// Emergency stop.
    pub emergency: u8,
}

impl ByteTable {
    /// `H J N G`, `X x Y y Z z C c`, `A`, `E`, `!`.
    pub const DEFAULT: ByteTable = ByteTable {
        home: b'H',
        manual: b'J',
        steps: b'N',
        figure: b'G',
        motors: [*b"Xx", *b"Yy", *b"Zz", *b"Cc"],
        stop: b'A',
        run: b'E',
        emergency: b'!',
    };

    /// Motor and whether forward.
    fn motor(&self, byte: u8) -> Option<(u8, bool)> {
        (0..4_u8)
            .zip(self.motors)
            .find_map(|(motor, [forward, backward])| match byte {
                _ if byte == forward => Some((motor, true)),
                _ if byte == backward => Some((motor, false)),
                _ => None,
            })
    }
}

/// What the bytes ask for.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum ByteCommand {
    /// Home X, Y and Z.
    Home,
    /// Turn a motor until [`ByteCommand::Stop`]; said again while it turns, it is still wanted.
    Jog {
        /// 0 to 2 for X, Y, Z; 3 for the spindle.
        motor: u8,
        /// Forward, or clockwise.
        forward: bool,
    },
    /// Turn a motor by so many steps.
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
    /// Stop what moves.
    Stop,
    /// Stop at once, and nothing more until a reset.
    Emergency,
}

/// Where the reading of bytes stands.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
enum Mode {
    /// No mode was chosen, or home or figure, which need no more bytes.
    None,
    /// The motor told last, and whether forward.
    Manual(Option<(u8, bool)>),
    Steps,
    /// The next byte is a count, whatever it is.
    Count(u8, bool),
    Ready {
        motor: u8,
        forward: bool,
        count: u8,
    },
    Emergency,
}

/// What to do after a byte.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct Received {
    /// The command that is complete now.
    pub command: Option<ByteCommand>,
    /// The byte to send back: none without acknowledgement.
    pub reply: Option<u8>,
}

/// The device's side: bytes in, commands out.
///
/// A mode is left only while nothing moves. With acknowledgement, which the original has not, every byte taken is sent back and every
/// other one answered by `?`.
///
/// ```
/// use husillo_transports::byte_commands::{ByteCommand, ByteCommands, ByteTable};
///
/// let mut link = ByteCommands::new(ByteTable::DEFAULT);
/// let commands: Vec<ByteCommand> = b"NxHE" // steps, X backward, 72 of them, run
///     .iter()
///     .filter_map(|byte| link.receive(*byte, false).command)
///     .collect();
/// assert_eq!(commands, [ByteCommand::Steps { motor: 0, forward: false, count: 72 }]);
/// ```
#[derive(Clone, Debug)]
pub struct ByteCommands {
    table: ByteTable,
    mode: Mode,
    acknowledges: bool,
}

/// Answer to a byte that is not taken.
pub const REJECTED: u8 = b'?';

impl ByteCommands {
    /// No mode chosen, no acknowledgement.
    pub const fn new(table: ByteTable) -> Self {
        Self {
            table,
            mode: Mode::None,
            acknowledges: false,
        }
    }

    /// The same with acknowledgement.
    pub const fn acknowledging(mut self) -> Self {
        self.acknowledges = true;
        self
    }

    /// The state after power up or reset: the only way out of an emergency stop.
    pub const fn reset(&mut self) {
        self.mode = Mode::None;
    }

    /// A byte from the line; `is_moving`: a motor turns.
    ///
    /// While one does, [`ByteCommand::Stop`], [`ByteCommand::Emergency`] and the same jog again are taken and nothing else.
    pub fn receive(&mut self, byte: u8, is_moving: bool) -> Received {
        let taken = self.take(byte, is_moving);
        let answer = if taken.is_some() { byte } else { REJECTED };
        Received {
            command: taken.flatten(),
            reply: self.acknowledges.then_some(answer),
        }
    }

    /// `None`: not taken; `Some(None)`: taken, but there is more to come.
    fn take(&mut self, byte: u8, is_moving: bool) -> Option<Option<ByteCommand>> {
        if let Mode::Count(motor, forward) = self.mode {
            // Nothing moves while a count is expected: the motor was chosen standing.
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
        if self.mode == Mode::Emergency {
            return None;
        }
        let table = self.table;
        if byte == table.emergency {
            self.mode = Mode::Emergency;
            return Some(Some(ByteCommand::Emergency));
        }
        if byte == table.stop {
            return Some(Some(ByteCommand::Stop));
        }
        let motor = table.motor(byte);
        if let (Mode::Manual(last), Some((motor, forward))) = (self.mode, motor) {
            if is_moving && last != Some((motor, forward)) {
                return None;
            }
            self.mode = Mode::Manual(Some((motor, forward)));
            return Some(Some(ByteCommand::Jog { motor, forward }));
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
            ) if byte == table.run => Some(Some(ByteCommand::Steps {
                motor,
                forward,
                count,
            })),
            _ => self.choose(byte),
        }
    }

    /// A byte that chooses a mode.
    fn choose(&mut self, byte: u8) -> Option<Option<ByteCommand>> {
        let (mode, command) = match byte {
            _ if byte == self.table.home => (Mode::None, Some(ByteCommand::Home)),
            _ if byte == self.table.figure => (Mode::None, Some(ByteCommand::Figure)),
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

    fn commands(link: &mut ByteCommands, bytes: &[u8]) -> [Option<ByteCommand>; 8] {
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
            let mut link = ByteCommands::new(ByteTable::DEFAULT);
            let [found, rest @ ..] = commands(&mut link, &[b'N', b'C', count, b'E']);
            let expected = ByteCommand::Steps {
                motor: 3,
                forward: true,
                count,
            };
            assert_eq!((found, rest), (Some(expected), [None; 7]));
        }
    }

    #[test]
    fn a_count_of_nothing_is_none() {
        let mut link = ByteCommands::new(ByteTable::DEFAULT).acknowledging();
        let replies =
            [b'N', b'X', 0, b'E', b'X', 7, b'E', b'E'].map(|byte| link.receive(byte, false).reply);
        let expected = [b'N', b'X', b'?', b'?', b'X', 7, b'E', b'E'];
        assert_eq!(replies, expected.map(Some));
    }

    #[test]
    fn a_mode_is_left_only_standing() {
        let mut link = ByteCommands::new(ByteTable::DEFAULT).acknowledging();
        link.receive(b'J', false);
        for byte in *b"HJNGE" {
            let received = link.receive(byte, true);
            assert_eq!((received.command, received.reply), (None, Some(REJECTED)));
        }
        assert_eq!(link.receive(b'A', true).command, Some(ByteCommand::Stop));
        assert_eq!(link.receive(b'H', false).command, Some(ByteCommand::Home));
        // Homing is no mode in which motors have letters.
        assert_eq!(link.receive(b'X', false).reply, Some(REJECTED));
    }

    #[test]
    fn only_the_jog_under_way_is_said_again() {
        let mut link = ByteCommands::new(ByteTable::DEFAULT);
        link.receive(b'J', false);
        let forward = Some(ByteCommand::Jog {
            motor: 1,
            forward: true,
        });
        assert_eq!(link.receive(b'Y', false).command, forward);
        assert_eq!(link.receive(b'y', true).command, None);
        assert_eq!(link.receive(b'Y', true).command, forward);
    }

    #[test]
    fn an_emergency_stays() {
        let mut link = ByteCommands::new(ByteTable::DEFAULT);
        assert_eq!(
            link.receive(b'!', true).command,
            Some(ByteCommand::Emergency)
        );
        assert_eq!(commands(&mut link, b"AHJXNX\x05EG"), [None; 8]);
        link.reset();
        assert_eq!(link.receive(b'H', false).command, Some(ByteCommand::Home));
    }
}
