//! The lease ends the work when the host is silent.

use super::super::{ENDING, LEASE_UNIT_MS, WORKING};
use super::Device;

impl<const N: usize> Device<N> {
    /// Returns the longest permitted silence of the line during the present work, us. `None`: there
    /// is no work, or it needs no host.
    pub fn lease_us(&self) -> Option<u32> {
        let is_needed = self.is_working() && !self.is_expired && !self.has_failed;
        let unit_us = u32::from(LEASE_UNIT_MS).wrapping_mul(1000); // 50 000
        let us = u32::from(self.lease).wrapping_mul(unit_us); // 13 s at most
        (is_needed && us > 0).then_some(us)
    }

    /// Ends the present work, because no byte has arrived for [`lease_us`](Device::lease_us). The
    /// caller ends the present order and confirms it with [`done`](Device::done). After that the
    /// spindle stops. Without a lease this function does nothing.
    pub fn expire(&mut self) {
        if self.lease_us().is_none() {
            return;
        }
        self.lease = 0;
        self.is_expired = true;
    }

    /// Removes the present drilling of a program from the count, because its hole is not complete.
    pub const fn discard_drilling(&mut self) {
        self.is_drilling = false;
    }

    /// Whether the present work ends because its lease has expired.
    pub const fn is_expired(&self) -> bool {
        self.is_expired
    }

    pub(super) fn say_at_work(&mut self) {
        self.out
            .push(if self.is_expired { ENDING } else { WORKING });
    }
}
