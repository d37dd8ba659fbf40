//! The receiver of a UART, for bytes that arrive at another rate.

/// A receiver that samples every bit in its middle, by its own rate.
///
/// It receives bytes of another rate as different bytes, or not at all. It also receives a
/// character without a stop bit, as most UARTs do if their framing errors are not checked. The
/// receiver then waits for an idle line.
#[derive(Clone, Debug, Default)]
pub(super) struct Ear {
    /// Time up to which the level of the line was passed to it, ns.
    heard_ns: u64,
    state: State,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum State {
    #[default]
    Idle,
    /// Time until the next sample, data bits so far, and number of samples so far. The first sample
    /// confirms the start bit.
    Character { wait_ns: u64, bits: u8, samples: u8 },
    /// After a missing stop bit.
    Low,
}

impl Ear {
    /// Receives a byte that began at `start_ns`. Returns the bytes that it reads from it and from
    /// the silence before it. Times of a bit are in ns.
    pub(super) fn byte(
        &mut self,
        byte: u8,
        start_ns: u64,
        bit_ns: u64,
        own_bit_ns: u64,
    ) -> Vec<u8> {
        let mut heard = self.rest(start_ns, own_bit_ns);
        let data = (0..8).map(|place| byte >> place & 1 == 1);
        for level in [false].into_iter().chain(data).chain([true]) {
            self.hear(level, bit_ns, own_bit_ns, &mut heard);
        }
        self.heard_ns = start_ns + 10 * bit_ns;
        heard
    }

    /// Receives silence until `until_ns`. Returns the bytes that it reads in this time.
    pub(super) fn rest(&mut self, until_ns: u64, own_bit_ns: u64) -> Vec<u8> {
        let mut heard = Vec::new();
        let silence_ns = until_ns.saturating_sub(self.heard_ns);
        self.hear(true, silence_ns, own_bit_ns, &mut heard);
        self.heard_ns = self.heard_ns.max(until_ns);
        heard
    }

    /// Receives a level for the time `ns`. Adds the bytes that it reads to `heard`.
    fn hear(&mut self, level: bool, ns: u64, own_bit_ns: u64, heard: &mut Vec<u8>) {
        let mut left_ns = ns;
        loop {
            match self.state {
                State::Idle if level => return,
                State::Idle => {
                    self.state = State::Character {
                        wait_ns: own_bit_ns / 2,
                        bits: 0,
                        samples: 0,
                    };
                }
                State::Low if level => self.state = State::Idle,
                State::Low => return,
                State::Character {
                    wait_ns,
                    bits,
                    samples,
                } if wait_ns > left_ns => {
                    self.state = State::Character {
                        wait_ns: wait_ns - left_ns,
                        bits,
                        samples,
                    };
                    return;
                }
                State::Character {
                    wait_ns,
                    bits,
                    samples,
                } => {
                    left_ns -= wait_ns;
                    self.state = match (samples, level) {
                        // No start bit.
                        (0, true) => State::Idle,
                        (9, _) => {
                            heard.push(bits);
                            if level { State::Idle } else { State::Low }
                        }
                        _ => State::Character {
                            wait_ns: own_bit_ns,
                            bits: match samples {
                                0 => 0,
                                _ => bits >> 1 | u8::from(level) << 7,
                            },
                            samples: samples + 1,
                        },
                    };
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::Ear;

    const fn bit_ns(bits_per_s: u64) -> u64 {
        1_000_000_000 / bits_per_s
    }

    /// What is received from bytes without gaps, and then silence.
    fn heard(bytes: &[u8], rate: u64, own_rate: u64) -> Vec<u8> {
        let mut ear = Ear::default();
        let (bit, own) = (bit_ns(rate), bit_ns(own_rate));
        let mut heard = Vec::new();
        let mut at_ns = 1_000_000;
        for byte in bytes {
            heard.extend(ear.byte(*byte, at_ns, bit, own));
            at_ns += 10 * bit;
        }
        heard.extend(ear.rest(at_ns + 100_000_000, own));
        heard
    }

    #[test]
    fn every_byte_is_heard_at_its_rate() {
        let all: Vec<u8> = (0..=255).collect();
        assert_eq!(heard(&all, 19200, 19200), all);
        // The rates of the chip differ from the nominal ones by 1 to 4 %.
        assert_eq!(heard(&all, 9600, 9766), all);
        assert_eq!(heard(&all, 57600, 59524), all);
    }

    #[test]
    fn at_another_rate_it_is_noise() {
        let packet = [0xaa, 0x01, 0x0e, 0x0f];
        // Three bits at 57600 bits/s are as long as one at 19200. So each byte is read after 17 and
        // a half of them.
        let slow = heard(&packet, 57600, 19200);
        assert!(!slow.is_empty() && slow.len() < 4, "{slow:02x?}");
        let fast = heard(&packet, 19200, 57600);
        assert!(fast.len() > 4, "{fast:02x?}");
        assert!(!fast.contains(&0xaa));
    }

    #[test]
    fn a_short_pulse_is_no_start_bit() {
        let mut ear = Ear::default();
        let mut bytes = Vec::new();
        ear.hear(false, bit_ns(19200) / 3, bit_ns(19200), &mut bytes);
        bytes.extend(ear.rest(10_000_000, bit_ns(19200)));
        assert!(bytes.is_empty());
        assert_eq!(
            ear.byte(0x42, 20_000_000, bit_ns(19200), bit_ns(19200)),
            [0x42]
        );
    }
}
