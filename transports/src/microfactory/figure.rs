//! A figure on the line: moves of four bytes, and a check over all of them.

use crc::{CRC_16_IBM_SDLC, Crc, Table};

/// CRC-16/X-25, as on [`crate::link`]. It detects any three wrong bits in 4092 bytes (1023 moves).
/// One in 65536 of other errors is not detected.
const CHECK: Crc<u16, Table<1>> = Crc::<u16, Table<1>>::new(&CRC_16_IBM_SDLC);

/// The four bytes of a move: steps of X and Z, low bytes first.
pub const fn move_bytes([x, z]: [i16; 2]) -> [u8; 4] {
    let ([x0, x1], [z0, z1]) = (x.to_le_bytes(), z.to_le_bytes());
    [x0, x1, z0, z1]
}

/// Reads a move from four bytes.
pub(super) const fn move_of([x0, x1, z0, z1]: [u8; 4]) -> [i16; 2] {
    [i16::from_le_bytes([x0, x1]), i16::from_le_bytes([z0, z1])]
}

/// Returns the check of bytes that follow others. `before` is the check of those others, or 0 if
/// there are none.
pub(super) fn checked(before: u16, bytes: &[u8]) -> u16 {
    // Undoes the last exclusive or, in the bit order of a start value.
    let mut digest = CHECK.digest_with_initial((before ^ 0xFFFF).reverse_bits());
    digest.update(bytes);
    digest.finalize()
}

/// Returns the check of a figure. It follows [`ByteTable::keep`](super::ByteTable::keep) and the
/// number of moves.
pub fn figure_check(moves: &[[i16; 2]]) -> u16 {
    let grow = |check, way: &[i16; 2]| checked(check, &move_bytes(*way));
    moves.iter().fold(0, grow)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_check_in_pieces_is_the_check_of_all() {
        // The check value of the catalogue of parametrised CRC algorithms.
        assert_eq!(checked(0, b"123456789"), 0x906E);
        assert_eq!(checked(checked(0, b"1234"), b"56789"), 0x906E);
        assert_eq!(checked(0, b""), 0);
    }

    #[test]
    fn moves_come_back() {
        for way in [[0, 0], [1, -1], [i16::MIN, i16::MAX], [0x1234, -2]] {
            assert_eq!(move_of(move_bytes(way)), way);
        }
    }
}
