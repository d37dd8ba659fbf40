//! The waits before many events.

/// What [`Ramp::fill`](crate::Ramp::fill) and [`JerkRamp::fill`](crate::JerkRamp::fill) have
/// written.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Waits {
    /// Number of waits.
    pub count: u32,
    /// The sum of all of them in ticks; wraps.
    pub ticks: u32,
    /// The shortest of them in ticks; `u32::MAX` if there is none.
    pub least: u32,
    /// The wait before the event after them, if it is longer than 2^31 ticks. That event has been
    /// timed, and its wait is not written.
    pub long: Option<u64>,
}

impl Waits {
    pub(crate) const NONE: Waits = Waits {
        count: 0,
        ticks: 0,
        least: u32::MAX,
        long: None,
    };

    /// Writes one more wait. Returns `false` if it is long.
    pub(crate) fn add(&mut self, wait: u64, place: &mut u32) -> bool {
        if wait > 1 << 31 {
            self.long = Some(wait);
            return false;
        }
        let wait = wait as u32;
        *place = wait;
        // At most as many as the caller has places.
        self.count = self.count.wrapping_add(1);
        self.ticks = self.ticks.wrapping_add(wait);
        self.least = self.least.min(wait);
        true
    }
}
