//! The waits of the host, and the bytes that it repeats.

/// Waits in microseconds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Timing {
    /// Time of a character on the line.
    pub character_us: u32,
    /// The time from the last bit sent to the complete echo.
    pub echo_us: u32,
    /// An additional single wait for a late echo. 0: no additional wait.
    pub late_us: u32,
    /// The largest number of times that a byte is sent until it is echoed, at least once.
    pub tries: u8,
    /// Whether every byte is repeated, as in the original. A late echo then makes the device store
    /// a byte twice. Otherwise only `B` and `c` are repeated, which may be done twice.
    pub resends_anything: bool,
    /// The silence that must follow the last byte of an exchange. After it the exchange has ended.
    /// An additional echo in this time means an additional byte.
    pub guard_us: u32,
    /// Longest time of homing, and of a reset with its homing.
    pub home_us: u32,
    /// Longest time of a whole program, or of a full memory.
    pub run_us: u32,
    /// The pause between the bytes that bring an unknown device to rest.
    pub pause_us: u32,
}

impl Timing {
    /// Returns the timing for a line at this rate in baud. An echo may take two characters and 10
    /// ms. A late echo may take 100 ms more. Homing may take a minute.
    ///
    /// `run_us` is the longest time of a program, or of 8192 bytes of a longer one. The caller must
    /// know it: one hole takes up to 15 s.
    pub const fn of(bits_per_s: u32, run_us: u32) -> Timing {
        let character_us = match 10_000_000_u32.checked_div(bits_per_s) {
            Some(us) => us,
            None => 0,
        };
        Timing {
            character_us,
            echo_us: character_us.saturating_mul(2).saturating_add(10_000),
            late_us: 100_000,
            tries: 3,
            resends_anything: false,
            guard_us: character_us.saturating_mul(3),
            home_us: 60_000_000,
            run_us,
            pause_us: 100_000,
        }
    }

    /// The timing of the original: 10 ms and three tries for every byte. At 2400 baud no echo can
    /// arrive in this time, so every byte is stored more than once. It is only for tests of the
    /// original's device.
    pub const fn original(bits_per_s: u32, run_us: u32) -> Timing {
        Timing {
            echo_us: 10_000,
            late_us: 0,
            resends_anything: true,
            guard_us: 0,
            ..Timing::of(bits_per_s, run_us)
        }
    }
}
