//! What the eight-bit sum does not see.

/// Two wrong bits in a packet of so many bytes (sum included, header not) that its sum does not show: the expected number of such pairs, in
/// halves, for any data. Their share times the square of the bit error rate is the rate of wrong packets taken for right.
///
/// A pair cancels when both bits have the same place in their bytes and change in opposite directions, which is one half of the
/// cases; bits 7 cancel in any direction, 256 being 0. So there are n (n - 1) / 2 pairs of bytes with 7 / 2 + 1 = 9 / 2 pairs of bits.
/// One wrong bit is always seen; of packets with many wrong bits one in 256 is not.
///
/// At one bit error in 10^5 a reply with the position (6 bytes) is wrong and unseen once in 1.5e8; two such replies that agree,
/// once in 10^17.
///
/// 19 bytes at most in this protocol; saturates far above.
pub fn unseen_pairs_in_halves(packet_bytes: u16) -> u32 {
    let bytes = u32::from(packet_bytes);
    // n (n - 1) / 2 * 9 / 2 in halves: n (n - 1) is even.
    (bytes.saturating_mul(bytes.saturating_sub(1)) / 2).saturating_mul(9)
}
