//! The pulse times of a step and direction driver.

/// The times a step and direction driver needs, in timer ticks.
///
/// ```text
///            set-up    high     low
///  DIR  ─────╲_________________________________╱──────
///  STEP ____________╱───────╲__________________
///                   │<──── hold (from the rising edge) ──>│ before DIR may change
/// ```
#[derive(Copy, Clone, Eq, PartialEq, Debug, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct PulseTiming {
    /// DIR stable before STEP rises.
    pub setup_ticks: u32,
    /// DIR stable after STEP has risen.
    pub hold_ticks: u32,
    /// STEP high, at least 1.
    pub high_ticks: u32,
    /// STEP low after the pulse, at least 1.
    pub low_ticks: u32,
}

/// The same times in nanoseconds, as in data sheets.
#[derive(Copy, Clone, Eq, PartialEq, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct PulseNanoseconds {
    /// DIR stable before STEP rises.
    pub setup: u32,
    /// DIR stable after STEP has risen.
    pub hold: u32,
    /// STEP high.
    pub high: u32,
    /// STEP low after the pulse.
    pub low: u32,
}

impl PulseNanoseconds {
    /// The times of the A4988: 200 ns set-up and hold, 1 us high and low.
    ///
    /// # Source
    /// Allegro, A4988 data sheet, figure 1 (logic interface timing).
    pub const A4988: PulseNanoseconds = PulseNanoseconds {
        setup: 200,
        hold: 200,
        high: 1000,
        low: 1000,
    };

    /// The times of the DRV8825: 650 ns set-up and hold, 1.9 us high and low. From ENABLE to the
    /// first rise of STEP 650 ns pass too, which is the set-up time.
    ///
    /// # Source
    /// Texas Instruments, DRV8825 data sheet (SLVSA73), timing requirements.
    pub const DRV8825: PulseNanoseconds = PulseNanoseconds {
        setup: 650,
        hold: 650,
        high: 1900,
        low: 1900,
    };

    /// Converts to ticks of a timer of `timer_hz`, rounded up, so that no time is too short.
    #[must_use]
    pub const fn ticks(self, timer_hz: u32) -> PulseTiming {
        PulseTiming {
            setup_ticks: ticks(self.setup, timer_hz),
            hold_ticks: ticks(self.hold, timer_hz),
            high_ticks: ticks(self.high, timer_hz),
            low_ticks: ticks(self.low, timer_hz),
        }
    }
}

const fn ticks(nanoseconds: u32, timer_hz: u32) -> u32 {
    // Below 2^64.
    let product = (nanoseconds as u64).wrapping_mul(timer_hz as u64);
    let ticks = product.div_ceil(1_000_000_000);
    if ticks > u32::MAX as u64 {
        u32::MAX
    } else {
        ticks as u32
    }
}

impl PulseTiming {
    /// STEP high, at least 1 tick.
    #[must_use]
    pub const fn high(self) -> u32 {
        at_least_one(self.high_ticks)
    }

    /// STEP low, at least 1 tick.
    #[must_use]
    pub const fn low(self) -> u32 {
        at_least_one(self.low_ticks)
    }

    /// Returns the shortest time between two steps of a driver, in ticks, also when the direction
    /// changes between them.
    #[must_use]
    pub const fn shortest_interval_ticks(self) -> u32 {
        let pulse = self.high().saturating_add(self.low());
        let turn = self.hold_ticks.saturating_add(self.setup_ticks);
        if turn > pulse { turn } else { pulse }
    }
}

const fn at_least_one(ticks: u32) -> u32 {
    if ticks == 0 { 1 } else { ticks }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_of_the_data_sheet_are_rounded_up() {
        let ticks = |hz| PulseNanoseconds::A4988.ticks(hz);
        let slow = PulseTiming {
            setup_ticks: 1,
            hold_ticks: 1,
            high_ticks: 1,
            low_ticks: 1,
        };
        assert_eq!(ticks(1_000_000), slow);
        let fast = PulseTiming {
            setup_ticks: 7,
            hold_ticks: 7,
            high_ticks: 32,
            low_ticks: 32,
        };
        assert_eq!(ticks(32_000_000), fast);
        assert_eq!(fast.shortest_interval_ticks(), 64);
        let long = PulseNanoseconds {
            setup: u32::MAX,
            ..PulseNanoseconds::A4988
        };
        assert_eq!(long.ticks(u32::MAX).setup_ticks, u32::MAX);
        let nothing = PulseTiming::default();
        assert_eq!(nothing.shortest_interval_ticks(), 2);
    }
}
