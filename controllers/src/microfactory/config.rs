//! Configuration of a microfactory.

/// Rates, backlash and times of a [`Microfactory`](crate::Microfactory).
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct MicrofactoryConfig {
    /// Ticks per second of the timer that counts the waits; at least one per step.
    pub timer_hz: u32,
    /// Steps per second of X, Y and Z, and along the path of a figure; above 0. A step is one pulse
    /// of CLOCK.
    pub axis_rate_hz: u16,
    /// Steps per second of the spindle; above 0.
    pub spindle_rate_hz: u16,
    /// Backlash of X, Y and Z, in motor steps.
    pub backlash_steps: [u16; 3],
    /// Distance of the back-off from a home switch, in load steps.
    pub back_off_steps: u16,
    /// Longest distance to a home switch, in motor steps.
    pub search_steps: u32,
    /// Longest distance in Y until the tool touches the work piece, in load steps.
    pub approach_steps: u32,
    /// Ticks after which a jog ends unless it is repeated. `None`: it continues until it is
    /// stopped.
    pub dead_man_ticks: Option<u32>,
    /// Ticks of RESET low. The L297 requires 1 us.
    pub reset_ticks: u32,
    /// Ticks from RESET, or from switching the current on, to the first step.
    pub settle_ticks: u32,
    /// Whether RESET precedes every move, as in the original. A rotor whose sequencer is not in
    /// state 1 then jumps by up to two full steps. Otherwise RESET precedes only the first move
    /// after power-on, when the phases are unknown.
    pub resets_before_moves: bool,
    /// Whether the spindle turns during the approach and the cutting of a figure.
    pub spindle_turns_in_figures: bool,
}

impl MicrofactoryConfig {
    /// The rates, backlash and back-off of the original, on a timer of 1 MHz. No source states the
    /// distances of search and approach, nor the settling time. This project has chosen them; the
    /// settling time is 10 ms.
    pub const ORIGINAL: MicrofactoryConfig = MicrofactoryConfig {
        timer_hz: 1_000_000,
        axis_rate_hz: 400,
        spindle_rate_hz: 256,
        backlash_steps: [200, 0, 200],
        back_off_steps: 200,
        search_steps: 20_000,
        approach_steps: 5_000,
        dead_man_ticks: None,
        reset_ticks: 1_000,
        settle_ticks: 10_000,
        resets_before_moves: false,
        spindle_turns_in_figures: true,
    };

    /// Returns the ticks between two steps of a motor.
    pub(super) fn interval(&self, motor: u8) -> u32 {
        let rate = match usize::from(motor) {
            super::SPINDLE => self.spindle_rate_hz,
            _ => self.axis_rate_hz,
        };
        self.timer_hz / u32::from(rate.max(1))
    }

    pub(super) fn spindle_interval(&self) -> u32 {
        self.timer_hz / u32::from(self.spindle_rate_hz.max(1))
    }
}
