//! Spindle, laser and coolant.

use husillo_gcode::SpindleDirection;
use husillo_transports::grbl::Settings;

/// The requested state of spindle and coolant.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Outputs {
    pub(super) direction: SpindleDirection,
    /// Programmed speed.
    pub(super) milli_rpm: u64,
    /// Whether 0x9E, the door, or a hold with a laser keeps the spindle off.
    pub(super) is_stopped: bool,
    pub(super) flood: bool,
    pub(super) mist: bool,
    /// Whether the door keeps the coolant off.
    pub(super) is_coolant_stopped: bool,
    /// Laser mode, `$32`.
    pub(super) is_laser: bool,
}

impl Outputs {
    pub(super) const OFF: Outputs = Outputs {
        direction: SpindleDirection::Off,
        milli_rpm: 0,
        is_stopped: false,
        flood: false,
        mist: false,
        is_coolant_stopped: false,
        is_laser: false,
    };

    pub(super) fn is_on(&self) -> bool {
        self.direction != SpindleDirection::Off
    }
}

/// Returns the duty cycle for a programmed speed and an override in percent, and the resulting
/// speed in thousandths of a turn per minute.
pub(super) fn duty(milli_rpm: u64, percent: u8, settings: &Settings) -> (u8, u64) {
    let scaled = milli_rpm.saturating_mul(percent.into()) / 100;
    let (most, least) = (u64::from(settings.milli(30)), u64::from(settings.milli(31)));
    if scaled == 0 {
        return (0, 0);
    }
    if least >= most || scaled >= most {
        return (255, most);
    }
    if scaled <= least {
        return (1, least);
    }
    // Below 2^40. The quotient is below 254.
    let share = scaled.wrapping_sub(least).wrapping_mul(254);
    let share = share.checked_div(most.wrapping_sub(least)).unwrap_or(0);
    ((share as u8).saturating_add(1), scaled)
}
