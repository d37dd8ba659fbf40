//! The waits of the ends.

/// Waits in microseconds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Timing {
    /// Time of a character on the line.
    pub character_us: u32,
    /// Silence before the line changes its direction, at both ends; 0 on a full-duplex line.
    pub turnaround_us: u32,
    /// Longest time that the other end takes to answer, in addition to the times of the line.
    pub answer_us: u32,
    /// How often a frame is sent before the link goes down, at least once.
    pub tries: u8,
    /// Period in which the master asks a station without payloads.
    pub ask_us: u32,
    /// A station that receives nothing for this time is down and should stop its machine. 0: no
    /// limit.
    pub silence_us: u32,
}

impl Timing {
    /// Returns the timing for a line at this rate in baud, 8N1. The turnaround is two characters,
    /// the time to answer is 20 ms, and there are three tries. The master asks every 50 ms. The
    /// link goes down after a second of silence.
    pub const fn of(bits_per_s: u32) -> Timing {
        let character_us = match 10_000_000_u32.checked_div(bits_per_s) {
            Some(us) => us,
            None => 0,
        };
        Timing {
            character_us,
            turnaround_us: character_us.saturating_mul(2),
            answer_us: 20_000,
            tries: 3,
            ask_us: 50_000,
            silence_us: 1_000_000,
        }
    }

    /// Returns the longest time until an answer, from the first byte of the question at the port.
    /// It is the sum of the longest frame in each direction, the turnaround, and the time of the
    /// other end.
    pub const fn wait_us(&self) -> u32 {
        self.character_us
            .saturating_mul(2 * super::frame::WIRE_BYTES as u32)
            .saturating_add(self.turnaround_us.saturating_mul(2))
            .saturating_add(self.answer_us)
    }
}
