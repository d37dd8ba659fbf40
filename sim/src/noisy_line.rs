//! Serial line with noise: bits, as a UART receives them.

use crate::random::Random;

/// Error rates of a line.
#[derive(Copy, Clone, PartialEq, Debug, Default)]
pub struct Noise {
    /// Probability that a bit arrives wrong, including the bits of silence.
    pub bit_errors: f64,
    /// Probability that a byte is lost at the sender or at the receiver.
    pub lost: f64,
    /// Probability that a byte arrives twice.
    pub doubled: f64,
}

impl Noise {
    /// Noise with wrong bits only.
    pub fn of_bits(bit_errors: f64) -> Noise {
        Noise {
            bit_errors,
            ..Noise::default()
        }
    }
}

/// Bits of a character: start, eight data bits from the lowest, stop.
const CHARACTER_BITS: u64 = 10;

/// One direction of a line, 8N1: bytes or silence in, the received bytes out.
///
/// ```text
///  ‾‾‾|_start_| d0 d1 d2 d3 d4 d5 d6 d7 |‾stop‾|‾‾‾
/// ```
///
/// A wrong data bit gives a wrong bit of the byte. A wrong start bit loses the byte, and the
/// following bits are read from the next zero on, across the ends of bytes. A zero in silence is
/// the start of a byte FF. If the stop bit is zero, the byte is discarded and the receiver waits
/// for a one.
///
/// # Examples
/// ```
/// use husillo_sim::{Noise, NoisyLine};
///
/// let mut good = NoisyLine::new(Noise::default(), 1);
/// assert_eq!(good.carry(0x55), [0x55]);
/// assert!(good.rest(1_000_000).is_empty());
/// ```
#[derive(Clone, Debug)]
pub struct NoisyLine {
    noise: Noise,
    random: Random,
    /// Number of correct bits before the next wrong one.
    until_wrong: u64,
    receiver: Uart,
    wrong_bits: u64,
}

#[derive(Copy, Clone, PartialEq, Eq, Debug)]
enum Uart {
    Idle,
    /// Data bits so far, and their number.
    Data(u8, u8),
    /// After a missing stop bit, until the line is idle.
    Broken,
}

impl NoisyLine {
    /// Creates a line with noise; the same seed gives the same noise.
    pub fn new(noise: Noise, seed: u64) -> NoisyLine {
        let mut line = NoisyLine {
            noise,
            random: Random::new(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1),
            until_wrong: 0,
            receiver: Uart::Idle,
            wrong_bits: 0,
        };
        line.until_wrong = line.next_gap();
        line
    }

    /// Carries a byte; returns the bytes that arrive meanwhile.
    pub fn carry(&mut self, byte: u8) -> Vec<u8> {
        if self.noise.lost > 0.0 && self.random.share() < self.noise.lost {
            return self.rest(CHARACTER_BITS);
        }
        let mut heard = self.character(byte);
        if self.noise.doubled > 0.0 && self.random.share() < self.noise.doubled {
            heard.extend(self.character(byte));
        }
        heard
    }

    /// Carries silence for `bits` bits; returns the bytes that arrive meanwhile.
    pub fn rest(&mut self, bits: u64) -> Vec<u8> {
        let mut heard = Vec::new();
        let mut left = bits;
        while left > 0 {
            if self.receiver == Uart::Idle {
                // Nothing happens until the next wrong bit.
                let quiet = left.min(self.until_wrong);
                self.until_wrong -= quiet;
                left -= quiet;
                if left == 0 {
                    break;
                }
            }
            heard.extend(self.bit(true));
            left -= 1;
        }
        heard
    }

    /// Number of wrong bits so far.
    pub fn wrong_bits(&self) -> u64 {
        self.wrong_bits
    }

    fn character(&mut self, byte: u8) -> Vec<u8> {
        if self.receiver == Uart::Idle && self.until_wrong >= CHARACTER_BITS {
            self.until_wrong -= CHARACTER_BITS;
            return vec![byte];
        }
        let data = (0..8).map(|place| byte >> place & 1 == 1);
        let bits = [false].into_iter().chain(data).chain([true]);
        bits.filter_map(|bit| self.bit(bit)).collect()
    }

    /// Carries one bit as it was sent.
    fn bit(&mut self, sent: bool) -> Option<u8> {
        let bit = if self.until_wrong == 0 {
            self.until_wrong = self.next_gap();
            self.wrong_bits += 1;
            !sent
        } else {
            self.until_wrong -= 1;
            sent
        };
        let (next, byte) = match (self.receiver, bit) {
            (Uart::Idle, false) => (Uart::Data(0, 0), None),
            (Uart::Data(byte, 8), true) => (Uart::Idle, Some(byte)),
            (Uart::Data(_, 8), false) | (Uart::Broken, false) => (Uart::Broken, None),
            (Uart::Data(bits, count), bit) => {
                let data = bits >> 1 | u8::from(bit) << 7;
                (Uart::Data(data, count + 1), None)
            }
            (Uart::Idle | Uart::Broken, true) => (Uart::Idle, None),
        };
        self.receiver = next;
        byte
    }

    /// Number of correct bits before the next wrong one, geometrically distributed.
    fn next_gap(&mut self) -> u64 {
        if self.noise.bit_errors <= 0.0 {
            return u64::MAX;
        }
        let gap = (1.0 - self.random.share()).ln() / (-self.noise.bit_errors).ln_1p();
        gap as u64 // saturates
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A line with exactly one wrong bit.
    fn one_wrong_bit(at: u64) -> NoisyLine {
        NoisyLine {
            until_wrong: at,
            ..NoisyLine::new(Noise::default(), 1)
        }
    }

    fn carried(line: &mut NoisyLine, bytes: &[u8]) -> Vec<u8> {
        let mut heard: Vec<u8> = bytes.iter().flat_map(|byte| line.carry(*byte)).collect();
        heard.extend(line.rest(40));
        heard
    }

    #[test]
    fn a_wrong_bit_of_data_is_a_wrong_bit_of_the_byte() {
        for place in 0..8 {
            let heard = carried(&mut one_wrong_bit(11 + place), &[0x12, 0x34, 0x56]);
            assert_eq!(heard, [0x12, 0x34 ^ (1 << place), 0x56]);
        }
    }

    #[test]
    fn a_wrong_stop_bit_loses_its_byte() {
        // The line is idle one bit later. The next byte has its start bit in that time, and is lost
        // too where the line stays low.
        let mut line = one_wrong_bit(19);
        assert_eq!(carried(&mut line, &[0x12, 0x34]), [0x12]);
    }

    #[test]
    fn a_wrong_start_bit_shifts_what_follows() {
        // 34 is 0 0 1 0 1 1 0 0 on the line. Its first zero is taken for the start bit, so 0 1 0 1
        // 1 0 0 and the stop bit are data. The start bit of the next byte is then where a stop bit
        // should be.
        let heard = carried(&mut one_wrong_bit(10), &[0x12, 0x34, 0xff]);
        assert_eq!(heard, [0x12]);
        let heard = carried(&mut one_wrong_bit(10), &[0x12, 0x34]);
        assert_eq!(heard, [0x12, 0x9a]);
    }

    #[test]
    fn a_wrong_bit_in_silence_is_a_byte() {
        assert_eq!(one_wrong_bit(5).rest(100), [0xff]);
        let mut line = one_wrong_bit(5);
        assert!(line.rest(12).is_empty(), "not all of it yet");
        assert_eq!(line.rest(10), [0xff]);
    }

    #[test]
    fn bits_are_wrong_as_often_as_they_should() {
        let mut line = NoisyLine::new(Noise::of_bits(1e-3), 7);
        let bytes = 100_000_u64;
        let mut damaged = 0;
        for _ in 0..bytes {
            damaged += u32::from(line.carry(0xa5) != [0xa5]);
            line.rest(50);
        }
        // 6000 wrong bits are expected, deviation 77. A byte is damaged by its own ten bits and by
        // those of the silence before it, where a zero starts a byte too early: once in 50 (the
        // tenth bit before it does no harm), deviation 44.
        let wrong = line.wrong_bits();
        assert!((5700..6300).contains(&wrong), "{wrong}");
        assert!((1700..2100).contains(&damaged), "{damaged}");
    }

    #[test]
    fn bytes_are_lost_and_doubled() {
        let noise = |lost, doubled| Noise {
            lost,
            doubled,
            ..Noise::default()
        };
        assert!(NoisyLine::new(noise(1.0, 0.0), 1).carry(1).is_empty());
        assert_eq!(NoisyLine::new(noise(0.0, 1.0), 1).carry(1), [1, 1]);
    }

    /// No checksum covers start and stop bits: one wrong bit can shift the following bits so that
    /// the checksum is right again. In a reply with position and home this is about one in a few
    /// hundred of the single wrong bits in its 110 bits (including a silent character before it).
    #[test]
    fn a_single_wrong_bit_is_hardly_ever_unseen() {
        let (replies, mut unseen) = (20_000_i32, 0_u32);
        for number in 0..replies {
            let position = number * 7919 % 6001 - 3000;
            let home = [0_i32, 3000, -3000][number as usize % 3];
            let status = [0x08_u8, 0x09, 0x88, 0x29][number as usize / 3 % 4];
            let mut reply = vec![status];
            reply.extend(position.to_le_bytes());
            reply.extend(home.to_le_bytes());
            reply.push(sum(&reply));
            for at in 0..10 * (reply.len() as u64 + 1) {
                let mut line = one_wrong_bit(at);
                let mut heard = line.rest(10);
                heard.extend(carried(&mut line, &reply));
                let (last, rest) = heard.split_last().expect("most of it");
                unseen +=
                    u32::from(heard != reply && heard.len() == reply.len() && *last == sum(rest));
            }
        }
        println!("{:.4} a reply", f64::from(unseen) / f64::from(replies));
        assert!(unseen > 0);
    }

    fn sum(bytes: &[u8]) -> u8 {
        bytes.iter().fold(0, |sum, byte| sum.wrapping_add(*byte))
    }
}
