//! What an axis needs of a speed profile.

use husillo_planner::{SCurve, Trapezoid};

/// The ticks before each step of a motion that ends at standstill, and the changes on the way.
///
/// [`Trapezoid`] and [`SCurve`] implement it.
pub trait AxisProfile: Iterator<Item = u32> {
    /// Changes the number of steps to come. Returns `false`, and changes nothing, where they are
    /// too few to stop. It ends a [`stop`](AxisProfile::stop).
    fn set_remaining(&mut self, steps: u32) -> bool;

    /// Brakes, and returns the steps until standstill.
    fn stop(&mut self) -> u32;

    /// Changes the top rate, where there is room for it before the end.
    fn set_top_rate(&mut self, rate_hz: u32);

    /// Steps to come before the end or the stop.
    fn steps_left(&self) -> u32;

    /// The present rate.
    fn rate_hz(&self) -> u32;
}

impl AxisProfile for Trapezoid {
    fn set_remaining(&mut self, steps: u32) -> bool {
        Trapezoid::set_remaining(self, steps)
    }

    fn stop(&mut self) -> u32 {
        self.hold().unwrap_or(self.len() as u32)
    }

    fn set_top_rate(&mut self, rate_hz: u32) {
        // The axis has checked the rate.
        let _ = Trapezoid::set_top_rate(self, rate_hz);
    }

    fn steps_left(&self) -> u32 {
        self.len() as u32
    }

    fn rate_hz(&self) -> u32 {
        Trapezoid::rate_hz(self)
    }
}

impl AxisProfile for SCurve {
    fn set_remaining(&mut self, steps: u32) -> bool {
        SCurve::set_remaining(self, steps)
    }

    fn stop(&mut self) -> u32 {
        self.hold().unwrap_or(self.len() as u32)
    }

    fn set_top_rate(&mut self, rate_hz: u32) {
        // The axis has checked the rate. Without room the present one is kept to the end.
        let _ = SCurve::set_top_rate(self, rate_hz);
    }

    fn steps_left(&self) -> u32 {
        self.len() as u32
    }

    fn rate_hz(&self) -> u32 {
        SCurve::rate_hz(self)
    }
}
