//! The errors that the eight-bit sum does not detect.

/// Returns the expected number of pairs of wrong bits that the checksum does not detect, in halves.
/// It applies to a packet of this many bytes (with checksum, without header) and to any data. The
/// expected number times the square of the bit error rate is the rate of wrong packets that are
/// accepted.
///
/// A pair cancels if both bits have the same position in their bytes and change in opposite
/// directions, which is one half of the cases. A pair of bits 7 cancels in any case, because 256 is
/// 0. So there are n (n - 1) / 2 pairs of bytes with 7 / 2 + 1 = 9 / 2 pairs of bits. A single
/// wrong bit is always detected. One in 256 packets with many wrong bits is not detected.
///
/// At one bit error in 10^5, a reply with the position (6 bytes) is wrong and accepted once in
/// 1.5e8. Two such replies that agree occur once in 10^17.
///
/// A packet of this protocol has at most 19 bytes. The result saturates only far above this number.
pub fn unseen_pairs_in_halves(packet_bytes: u16) -> u32 {
    let bytes = u32::from(packet_bytes);
    // n (n - 1) / 2 * 9 / 2 in halves: n (n - 1) is even.
    (bytes.saturating_mul(bytes.saturating_sub(1)) / 2).saturating_mul(9)
}
