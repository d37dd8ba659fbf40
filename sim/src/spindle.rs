//! A spindle with an encoder.

/// A simulated spindle with an encoder. It approaches its target speed gradually, and a cut slows
/// it down.
///
/// # Examples
/// ```
/// use husillo_sim::Spindle;
///
/// let mut spindle = Spindle::new(4096, 1_000_000);
/// spindle.set_target_rpm(600.0);
/// spindle.advance(1_000_000); // a second
/// assert!((spindle.rpm() - 600.0).abs() < 6.0);
/// assert!(spindle.count() > 0);
/// ```
#[derive(Clone, Debug)]
pub struct Spindle {
    counts_per_turn: u32,
    timer_hz: u32,
    target_rpm: f64,
    rpm: f64,
    load_rpm: f64,
    turns: f64,
}

/// Time constant of a change of speed, s.
const TIME_CONSTANT: f64 = 0.1;

impl Spindle {
    /// Creates a spindle at rest at count 0. `timer_hz` is the frequency of the ticks of
    /// [`advance`](Self::advance).
    #[must_use]
    pub const fn new(counts_per_turn: u32, timer_hz: u32) -> Spindle {
        Spindle {
            counts_per_turn,
            timer_hz,
            target_rpm: 0.0,
            rpm: 0.0,
            load_rpm: 0.0,
            turns: 0.0,
        }
    }

    /// Sets the target speed in rpm; negative is reverse.
    pub const fn set_target_rpm(&mut self, rpm: f64) {
        self.target_rpm = rpm;
    }

    /// Sets the steady-state loss of speed due to a cut, in rpm.
    pub const fn set_load_rpm(&mut self, rpm: f64) {
        self.load_rpm = rpm;
    }

    /// Lets `ticks` pass. Use short times, because the speed only changes from call to call.
    pub fn advance(&mut self, ticks: u32) {
        let seconds = f64::from(ticks) / f64::from(self.timer_hz);
        let end = self.target_rpm - self.load_rpm;
        self.rpm += (end - self.rpm) * (1.0 - (-seconds / TIME_CONSTANT).exp());
        self.turns += self.rpm / 60.0 * seconds;
    }

    /// Present speed in rpm.
    #[must_use]
    pub const fn rpm(&self) -> f64 {
        self.rpm
    }

    /// Turns since the start.
    #[must_use]
    pub const fn turns(&self) -> f64 {
        self.turns
    }

    /// Encoder count; wraps.
    #[must_use]
    pub fn count(&self) -> i32 {
        (self.turns * f64::from(self.counts_per_turn)).floor() as i64 as i32
    }
}
