//! The byte of each command.

/// Number of motors in a table: X, Y, Z and the spindle.
pub const MOTORS: usize = 4;

/// The byte of each command.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct ByteTable {
    /// Home all axes.
    pub home: u8,
    /// Enter the mode of jogs.
    pub manual: u8,
    /// Enter the mode of counted steps.
    pub steps: u8,
    /// Cut the stored figure.
    pub figure: u8,
    /// Forward and backward of each motor.
    pub motors: [[u8; 2]; MOTORS],
    /// Stop the motion.
    pub stop: u8,
    /// Make the counted steps.
    pub run: u8,
    /// Emergency stop.
    pub emergency: u8,
    /// Delete the stored figure and begin another one.
    pub clear: u8,
    /// A move of the figure, four bytes: X and Z in steps, low bytes first.
    pub line: u8,
    /// The figure is complete, four bytes: the number of its moves and their check, low bytes
    /// first.
    pub keep: u8,
    /// Report the positions of the axes and how the last task ended.
    pub ask: u8,
    /// Report where the home switches closed at the last homing.
    pub switches: u8,
    /// The following commands are for the first or the second machine of the controller.
    pub machines: [u8; 2],
    /// A motion ends when the line is silent for a time. One byte follows, with this time in units
    /// of 10 ms. 0: a motion needs no host.
    pub lease: u8,
}

impl ByteTable {
    /// `H J N G`, `X x Y y Z z C c`, `A`, `E`, `!`, and the commands that the original lacks:
    /// `< 3 6 5 w`, `o t` for machine one and two, and `l`. A single wrong bit in one of the latter
    /// makes no other command.
    pub const DEFAULT: ByteTable = ByteTable {
        home: b'H',
        manual: b'J',
        steps: b'N',
        figure: b'G',
        motors: [*b"Xx", *b"Yy", *b"Zz", *b"Cc"],
        stop: b'A',
        run: b'E',
        emergency: b'!',
        clear: b'<',
        line: b'3',
        keep: b'6',
        ask: b'5',
        switches: b'w',
        machines: *b"ot",
        lease: b'l',
    };

    /// Whether every byte has one meaning only. `?` answers a byte that is not accepted.
    pub fn is_unambiguous(&self) -> bool {
        let [[x, x_back], [y, y_back], [z, z_back], [c, c_back]] = self.motors;
        let [first, second] = self.machines;
        let bytes = [
            self.home,
            self.manual,
            self.steps,
            self.figure,
            x,
            x_back,
            y,
            y_back,
            z,
            z_back,
            c,
            c_back,
            self.stop,
            self.run,
            self.emergency,
            self.clear,
            self.line,
            self.keep,
            self.ask,
            self.switches,
            first,
            second,
            self.lease,
            super::REJECTED,
        ];
        // One bit for each byte that was seen. A sort of more than 20 values would link a panic of
        // the library.
        let mut seen = [0_u32; 8];
        bytes.iter().all(|byte| {
            let bit = 1_u32.wrapping_shl(u32::from(*byte)); // modulo 32
            let Some(word) = seen.get_mut(usize::from(byte >> 5)) else {
                return false; // `seen` has eight words
            };
            let is_new = *word & bit == 0;
            *word |= bit;
            is_new
        })
    }

    /// The motor of a letter, and whether the letter is its forward one.
    pub(super) fn motor(&self, byte: u8) -> Option<(u8, bool)> {
        (0..4_u8)
            .zip(self.motors)
            .find_map(|(motor, [forward, backward])| match byte {
                _ if byte == forward => Some((motor, true)),
                _ if byte == backward => Some((motor, false)),
                _ => None,
            })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_flipped_bit_makes_another_command_of_ours() {
        let table = ByteTable::DEFAULT;
        let [first, second] = table.machines;
        let ours = [
            table.clear,
            table.line,
            table.keep,
            table.ask,
            table.switches,
            first,
            second,
            table.lease,
        ];
        for byte in ours {
            for other in *b"HJNGXxYyZzCcAE!?<365wotl" {
                assert_ne!((byte ^ other).count_ones(), 1, "{byte} {other}");
            }
        }
    }
}
