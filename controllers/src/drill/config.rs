//! Configuration of a drill.

use husillo_transports::drill::Rules;

/// Rates, distances and rules of a [`Drill`](crate::Drill).
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct DrillConfig {
    /// Ticks per second of the timer that counts the waits; at least one per step.
    pub timer_hz: u32,
    /// Steps per second of X, Y and Z; above 0.
    pub rate_hz: [u16; 3],
    /// Distance that X or Y moves off its switch before the search, in steps. It does so if the
    /// switch is closed at the start of homing.
    pub back_off_steps: u16,
    /// Longest distance to a switch of X or Y, in steps.
    pub search_steps: u32,
    /// Longest distance of Z between the sensors, in steps.
    pub stroke_steps: u16,
    /// Shortest distance of Z between the sensors, in steps. Three cases are faults: the lower
    /// sensor closes earlier; the upper sensor is closed more than
    /// [`back_off_steps`](Self::back_off_steps) below the point where it closed; both sensors are
    /// closed at once. `None`: not checked, as in the original.
    pub shortest_stroke_steps: Option<u16>,
    /// Longest distance that Z moves down until its upper sensor opens, in steps. After power-on
    /// and after a reset Z moves off the sensor and finds it again before X or Y moves. This
    /// detects a sensor that sticks. Such a sensor reports closed even while the bit is in the
    /// board. The distance must be short, because the bit moves down by it if the sensor sticks.
    /// Not used without [`shortest_stroke_steps`](Self::shortest_stroke_steps).
    pub upper_opens_steps: u16,
    /// Last step of X and Y. A jog ends there, and a record beyond it is a fault. `u16::MAX`: no
    /// limit, as in the original.
    pub travel_steps: [u16; 2],
    /// Largest distance from zero, in both directions, at which a switch of X or Y may close. A
    /// switch that closes beyond it is a fault, because steps were lost. The fault prevents a hole
    /// in a wrong position. `None`: not checked, as in the original.
    pub switch_play_steps: Option<u16>,
    /// Whether Z, after a jog down, moves up to its sensor before a program moves X or Y. The
    /// original does not do this.
    pub raises_first: bool,
    /// Whether the controller switches the spindle on before each hole, off after it, and off
    /// before homing, as in the original. If not, the host switches the spindle, which then also
    /// turns between holes.
    pub spindle_by_hole: bool,
    /// Rest in ticks after each move, so that an axis is at rest before the next one moves.
    pub settle_ticks: u32,
    /// Whether the controller gives waits for the lamp of the heartbeat while it is idle. A
    /// firmware without a clock of its own then shows the heartbeat.
    pub blinks: bool,
    /// The rules of the link.
    pub rules: Rules,
}

impl DrillConfig {
    /// The lamp of the heartbeat changes after this time, us: 15 periods of 2^18 clocks of 8 MHz.
    pub const HEARTBEAT_US: u32 = 491_520;

    /// The rate (about 247 Hz), back-off and link of the original, on a timer of 1 MHz. A search
    /// ends at twice the length of the table or of the stroke. In the original, a search does not
    /// end. The rest of 2 ms is chosen by this project.
    pub const ORIGINAL: DrillConfig = DrillConfig {
        timer_hz: 1_000_000,
        rate_hz: [247; 3],
        back_off_steps: 1070,
        search_steps: 47_080,
        stroke_steps: 7490,
        shortest_stroke_steps: None,
        upper_opens_steps: 0,
        travel_steps: [u16::MAX; 2],
        switch_play_steps: None,
        raises_first: false,
        spindle_by_hole: true,
        settle_ticks: 2000,
        blinks: false,
        rules: Rules::FAITHFUL,
    };

    /// The same machine with the errors and omissions of the original corrected.
    pub const FIXED: DrillConfig = DrillConfig {
        // The original states 35 mm, which are 3745 steps, in whole millimetres. The tolerance of
        // 1 mm is chosen by this project.
        shortest_stroke_steps: Some(3638),
        // 2 mm, chosen by this project: photo sensors and switches open within 1 mm.
        upper_opens_steps: 214,
        travel_steps: [23_540, 4_815],
        // A motor with four phases loses steps in multiples of four.
        switch_play_steps: Some(3),
        raises_first: true,
        spindle_by_hole: false,
        rules: Rules::FIXED,
        ..DrillConfig::ORIGINAL
    };

    /// Returns the ticks between two steps of an axis.
    pub(super) fn interval(&self, axis: usize) -> u32 {
        let rate_hz = self.rate_hz.get(axis).copied().unwrap_or_default();
        self.timer_hz / u32::from(rate_hz.max(1))
    }
}
