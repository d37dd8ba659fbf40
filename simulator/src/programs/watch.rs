//! What is called while a long program is read.

use std::fmt;
use std::rc::Rc;

/// Counts the blocks and commands of a program, and calls a function after each
/// [`Watch::UPDATE`] of them. The default calls nothing.
#[derive(Clone)]
pub struct Watch {
    update: Option<Rc<dyn Fn()>>,
    countdown: u64,
}

impl Watch {
    /// Blocks and commands between two calls.
    pub const UPDATE: u64 = 1 << 20;

    /// Calls `update`.
    pub fn new(update: impl Fn() + 'static) -> Self {
        Self {
            update: Some(Rc::new(update)),
            countdown: Self::UPDATE,
        }
    }

    /// A block or a command was read.
    #[inline]
    pub fn step(&mut self) {
        self.countdown -= 1;
        if self.countdown == 0 {
            self.countdown = Self::UPDATE;
            if let Some(update) = &self.update {
                update();
            }
        }
    }
}

impl Default for Watch {
    fn default() -> Self {
        Self {
            update: None,
            countdown: Self::UPDATE,
        }
    }
}

impl fmt::Debug for Watch {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Watch").finish_non_exhaustive()
    }
}
