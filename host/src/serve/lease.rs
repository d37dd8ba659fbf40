//! The lease of a jog: it goes on only while the page renews it.

use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

/// A jog that is not renewed for this time ends.
pub const LEASE: Duration = Duration::from_millis(250);

/// The lease of the jog of a machine.
#[derive(Debug, Default)]
pub struct Lease(Mutex<Option<Held>>);

#[derive(Clone, Copy, Debug)]
struct Held {
    client: u64,
    jog: u64,
    until: Instant,
}

impl Lease {
    /// Begins the lease of a jog. It replaces the lease of another jog.
    pub fn begin(&self, client: u64, jog: u64, now: Instant) {
        *self.held() = Some(Held {
            client,
            jog,
            until: now + LEASE,
        });
    }

    /// Renews a lease that is not over.
    pub fn renew(&self, client: u64, jog: u64, now: Instant) {
        if let Some(held) = self.held().as_mut() {
            if (held.client, held.jog) == (client, jog) && held.until > now {
                held.until = now + LEASE;
            }
        }
    }

    /// Ends the lease of this jog.
    pub fn release(&self, client: u64, jog: u64) {
        let mut held = self.held();
        if held.is_some_and(|held| (held.client, held.jog) == (client, jog)) {
            *held = None;
        }
    }

    /// Ends any lease.
    pub fn end(&self) {
        *self.held() = None;
    }

    /// Whether a jog may go on.
    pub fn holds(&self, client: u64, jog: u64, now: Instant) -> bool {
        let held = *self.held();
        held.is_some_and(|held| (held.client, held.jog) == (client, jog) && held.until > now)
    }

    /// Whether the lease of this jog was not ended but has run out.
    pub fn has_run_out(&self, client: u64, jog: u64, now: Instant) -> bool {
        let held = *self.held();
        held.is_some_and(|held| (held.client, held.jog) == (client, jog) && held.until <= now)
    }

    fn held(&self) -> std::sync::MutexGuard<'_, Option<Held>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_jog_lasts_while_it_is_renewed() {
        let (lease, start) = (Lease::default(), Instant::now());
        let at = |ms| start + Duration::from_millis(ms);
        lease.begin(1, 7, at(0));
        assert!(lease.holds(1, 7, at(249)) && !lease.holds(1, 7, at(250)));
        lease.renew(1, 7, at(200));
        assert!(lease.holds(1, 7, at(449)) && lease.has_run_out(1, 7, at(450)));
        // Too late, or by another.
        lease.renew(1, 7, at(450));
        lease.renew(2, 7, at(300));
        lease.renew(1, 8, at(300));
        assert!(!lease.holds(1, 7, at(450)));
        lease.begin(1, 8, at(500));
        lease.release(1, 7);
        assert!(lease.holds(1, 8, at(501)));
        lease.release(1, 8);
        assert!(!lease.holds(1, 8, at(502)) && !lease.has_run_out(1, 8, at(900)));
    }
}
