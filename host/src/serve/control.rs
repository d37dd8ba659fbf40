//! The operator of a machine: one client is in control, the others watch.

use std::sync::{Mutex, PoisonError};

/// Who is in control of a machine.
#[derive(Debug)]
pub struct Control {
    operator: Mutex<Option<u64>>,
    /// Nobody may be in control.
    watch_only: bool,
}

impl Control {
    /// Nobody is in control.
    pub const fn new(watch_only: bool) -> Self {
        Self {
            operator: Mutex::new(None),
            watch_only,
        }
    }

    /// The client in control.
    pub fn operator(&self) -> Option<u64> {
        *self.operator.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Takes control, with `force` from another client too. Returns whether it was another's.
    ///
    /// # Errors
    ///
    /// A sentence about why not.
    pub fn take(&self, client: u64, force: bool) -> Result<bool, &'static str> {
        if self.watch_only {
            return Err("this server only watches: it was started with --watch-only");
        }
        let mut operator = self.operator.lock().unwrap_or_else(PoisonError::into_inner);
        let is_anothers = operator.is_some_and(|now| now != client);
        if is_anothers && !force {
            return Err("another client is in control");
        }
        *operator = Some(client);
        Ok(is_anothers)
    }

    /// Gives control back. Returns whether the client had it.
    pub fn give(&self, client: u64) -> bool {
        let mut operator = self.operator.lock().unwrap_or_else(PoisonError::into_inner);
        let had = *operator == Some(client);
        if had {
            *operator = None;
        }
        had
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_client_is_in_control() {
        let control = Control::new(false);
        assert_eq!(control.take(1, false), Ok(false));
        assert_eq!(control.take(1, false), Ok(false));
        assert!(control.take(2, false).is_err());
        assert!(!control.give(2));
        assert_eq!(control.take(2, true), Ok(true));
        assert!(!control.give(1) && control.give(2));
        assert_eq!(control.operator(), None);
        assert!(Control::new(true).take(1, true).is_err());
    }
}
