//! What a drill is made of.

use husillo_transports::drill::Rules;

/// Rates, ways and rules of a [`Drill`](crate::Drill).
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct DrillConfig {
    /// Ticks a second of the timer that counts the waits; at least one a step.
    pub timer_hz: u32,
    /// Steps a second of X, Y and Z; above 0.
    pub rate_hz: [u16; 3],
    /// The distance of X or Y off its switch before the search, if the switch is closed at the
    /// start of homing.
    pub back_off_steps: u16,
    /// The longest way to a switch of X or Y, in steps.
    pub search_steps: u32,
    /// The longest way of Z from one sensor to the other, in steps.
    pub stroke_steps: u16,
    /// The last step of X and Y: jogging ends there, and a record beyond it is a fault. `u16::MAX`:
    /// no limit, as in the original.
    pub travel_steps: [u16; 2],
    /// The largest distance from zero, in both directions, at which a switch of X or Y may close.
    /// Beyond it, closing is a fault: steps were lost, and nothing is drilled in a wrong position.
    /// `None`: not checked, as in the original.
    pub switch_play_steps: Option<u16>,
    /// Whether Z goes up to its sensor before a program moves X or Y, after it was jogged down. The
    /// original does not do this.
    pub raises_first: bool,
    /// The spindle is switched on before each hole and off after it, and off before homing, as in
    /// the original. Without it the host switches it, and it turns from hole to hole.
    pub spindle_by_hole: bool,
    /// Rest after each move, so that an axis stands before the next one goes.
    pub settle_ticks: u32,
    /// What the link is like.
    pub rules: Rules,
}

impl DrillConfig {
    /// The original's rate (about 247 Hz), back-off and link, on a timer of 1 MHz. Searches end at
    /// twice the table or the stroke; the original's do not end. The rest of 2 ms is ours.
    pub const ORIGINAL: DrillConfig = DrillConfig {
        timer_hz: 1_000_000,
        rate_hz: [247; 3],
        back_off_steps: 1070,
        search_steps: 47_080,
        stroke_steps: 7490,
        travel_steps: [u16::MAX; 2],
        switch_play_steps: None,
        raises_first: false,
        spindle_by_hole: true,
        settle_ticks: 2000,
        rules: Rules::FAITHFUL,
    };

    /// The same machine, with all that was wrong or missing put right.
    pub const FIXED: DrillConfig = DrillConfig {
        travel_steps: [23_540, 4_815],
        // A motor of four phases loses steps by fours.
        switch_play_steps: Some(3),
        raises_first: true,
        spindle_by_hole: false,
        rules: Rules::FIXED,
        ..DrillConfig::ORIGINAL
    };

    /// Ticks between two steps of an axis.
    pub(super) fn interval(&self, axis: usize) -> u32 {
        let rate_hz = self.rate_hz.get(axis).copied().unwrap_or_default();
        self.timer_hz / u32::from(rate_hz.max(1))
    }
}
