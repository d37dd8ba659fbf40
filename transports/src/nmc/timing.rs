//! Times of the line, and the polling rate of modules.

use super::{Baud, Items};

/// Longest time from the end of a command to its execution and reply: one servo cycle of the
/// original, in microseconds.
pub const CYCLE_US: u32 = 512;

/// The waits of the host in microseconds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Timing {
    /// The longest time from the last bit of a command to the first byte of its reply.
    pub reply_us: u32,
    /// An additional wait for each byte of the reply.
    pub per_byte_us: u32,
    /// The silence after a reply before it is accepted. An additional byte in this time means that
    /// a byte was doubled. 0: none.
    pub guard_us: u32,
    /// Silence after a flush.
    pub settle_us: u32,
    /// The wait after a command without an answer. It is longer than a servo cycle.
    pub unanswered_us: u32,
    /// The wait after a hard reset, during which modules receive nothing.
    pub reset_us: u32,
    /// How often a command or a reading is tried before the host gives up, at least once.
    pub tries: u8,
}

impl Timing {
    /// Returns the times of the vendor's library, for any adapter and operating system: 50 ms and 2
    /// ms per byte, 100 ms after a flush.
    pub const fn patient(baud: Baud) -> Timing {
        Timing {
            reply_us: 50_000,
            per_byte_us: 2_000,
            guard_us: baud.characters_us(1),
            settle_us: 100_000,
            unanswered_us: 60_000,
            reset_us: 100_000,
            tries: 3,
        }
    }

    /// Returns the times for a port that passes bytes on at once (a microcontroller, a simulated
    /// line): three servo cycles of `cycle_us` (512 times the divisor), two characters per byte.
    pub const fn prompt(baud: Baud, cycle_us: u32) -> Timing {
        let cycles_us = cycle_us.saturating_mul(3);
        Timing {
            reply_us: cycles_us,
            per_byte_us: baud.characters_us(2),
            guard_us: baud.characters_us(2),
            settle_us: cycles_us.saturating_add(baud.characters_us(40)),
            unanswered_us: cycles_us,
            reset_us: 100_000,
            tries: 3,
        }
    }
}

/// Polling of all modules of a line in turn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Polling {
    /// Number of modules, 1 to 32.
    pub modules: u8,
    /// Rate of the line.
    pub baud: Baud,
    /// Items of every reply. Define Status sets them, so that a No Operation of 4 bytes requests
    /// them.
    pub items: Items,
    /// The time from the end of a request to the start of its reply: 0 to [`CYCLE_US`], half of it
    /// on average.
    pub latency_us: u32,
    /// The time from the end of a reply to the start of the next request. It is 0 for the limit,
    /// and [`Timing::guard_us`] for a host that waits for the guard.
    pub guard_us: u32,
}

impl Polling {
    /// Returns the time per module in microseconds, rounded up. It includes 4 characters, latency,
    /// status, items and checksum, and guard. With the position, at 115200 baud, it is 869 us plus
    /// the latency.
    ///
    /// No polling is faster. Any byte on the command line cancels a reply, so the next request must
    /// wait for the end of the reply, and the shortest packet has 4 bytes.
    pub fn module_us(&self) -> u32 {
        let characters = 6 + self.items.length() as u16; // 23 at most
        self.baud
            .characters_us(characters)
            .saturating_add(self.latency_us)
            .saturating_add(self.guard_us)
    }

    /// Returns the time of a round in microseconds.
    pub fn round_us(&self) -> u32 {
        self.module_us().saturating_mul(u32::from(self.modules))
    }

    /// Returns the rounds in 1000 seconds, rounded down: the rate in mHz.
    pub fn rate_mhz(&self) -> u32 {
        1_000_000_000_u32
            .checked_div(self.round_us())
            .unwrap_or(u32::MAX)
    }
}
