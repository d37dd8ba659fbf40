//! The times at which a half-duplex line may be driven.

/// The times of one end of a half-duplex line, in microseconds that wrap.
///
/// # Examples
/// ```
/// use husillo_transports::rs485::Turnaround;
///
/// let mut line = Turnaround::new(87); // a character at 115200 baud
/// line.heard(1000); // the last stop bit of a request
/// assert_eq!(line.wait_us(1010), 77);
/// assert!(line.begin(1087)); // drive the line
/// line.complete(1500); // transmission complete: release it
/// assert!(!line.is_driving());
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Turnaround {
    silence_us: u32,
    /// The time when the line was last active. `None`: long ago.
    busy_us: Option<u32>,
    is_driving: bool,
}

impl Turnaround {
    /// Requires `silence_us` of silence before the line is driven. One character or 100 us,
    /// whichever is longer, gives any other station enough time to release the line. At most
    /// 2^31 - 1.
    pub const fn new(silence_us: u32) -> Turnaround {
        Turnaround {
            silence_us,
            busy_us: None,
            is_driving: false,
        }
    }

    /// Registers that a byte of another end was received.
    pub fn heard(&mut self, now_us: u32) {
        self.busy_us = Some(now_us);
    }

    /// Returns the rest of the required silence, in microseconds. 0: the line may be driven. Call
    /// this at least every 2^31 us.
    pub fn wait_us(&mut self, now_us: u32) -> u32 {
        let Some(busy_us) = self.busy_us else {
            return 0;
        };
        let left_us = self.silence_us.saturating_sub(now_us.wrapping_sub(busy_us));
        if left_us == 0 {
            self.busy_us = None; // so that the wrap of the clock does not bring it back
        }
        left_us
    }

    /// Begins to drive the line if it may be driven. If this returns `true`, the caller raises
    /// driver enable and sends.
    #[must_use]
    pub fn begin(&mut self, now_us: u32) -> bool {
        self.is_driving |= self.wait_us(now_us) == 0;
        self.is_driving
    }

    /// Registers that the transmission is complete, or was stopped because of a collision. The
    /// caller then lowers driver enable.
    pub fn complete(&mut self, now_us: u32) {
        self.is_driving = false;
        self.busy_us = Some(now_us);
    }

    /// Returns the level of driver enable.
    pub const fn is_driving(&self) -> bool {
        self.is_driving
    }
}
