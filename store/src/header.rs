//! Header and checksum of a half.

use crc::{CRC_32_ISO_HDLC, Crc, Table};

/// CRC without a table: eight steps per byte, once per save, instead of 1 kB of flash.
const CRC: Crc<u32, Table<0>> = Crc::<u32, Table<0>>::new(&CRC_32_ISO_HDLC);

/// Extends the CRC-32 `before` by `bytes`. The CRC-32 of no bytes is 0.
///
/// The crate keeps no `Digest` between calls: it reads the parameters of the CRC at run time, and
/// its shifts by them could overflow.
pub(crate) fn extended(before: u32, bytes: &[u8]) -> u32 {
    let mut digest = CRC.digest_with_initial((!before).reverse_bits());
    digest.update(bytes);
    digest.finalize()
}

/// Size of a header in bytes.
pub(crate) const HEADER: usize = 16;

/// Header of a half. It is stored as four little-endian words: the number of the save, the length
/// and CRC-32 of the content, and the CRC-32 of these three.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Header {
    pub number: u32,
    pub length: u32,
    pub content: u32,
}

impl Header {
    pub(crate) fn bytes(&self) -> [u8; HEADER] {
        let mut bytes = [0; HEADER];
        let words = [self.number, self.length, self.content];
        for (place, word) in bytes.chunks_exact_mut(4).zip(words) {
            place.copy_from_slice(&word.to_le_bytes());
        }
        let check = extended(0, bytes.first_chunk::<12>().map_or(&[], |words| words));
        if let Some(place) = bytes.last_chunk_mut() {
            *place = check.to_le_bytes();
        }
        bytes
    }

    /// Parses a header. Returns `None` if its own check does not match.
    pub(crate) fn of(bytes: &[u8; HEADER]) -> Option<Header> {
        let mut words = bytes
            .chunks_exact(4)
            .map(|word| word.try_into().map_or(0, u32::from_le_bytes));
        let header = Header {
            number: words.next()?,
            length: words.next()?,
            content: words.next()?,
        };
        (header.bytes() == *bytes).then_some(header)
    }
}

#[cfg(test)]
mod tests {
    use super::extended;

    /// The check value of the CRC catalogue, computed in parts.
    #[test]
    fn check_value() {
        assert_eq!(extended(extended(0, b"1234"), b"56789"), 0xcbf4_3926);
        assert_eq!(extended(0, b""), 0);
    }
}
