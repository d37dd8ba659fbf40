//! What foreground and interrupts share.

use core::cell::UnsafeCell;

use critical_section::CriticalSection;

/// A value that is only touched while no interrupt comes.
pub struct Shared<T>(UnsafeCell<T>);

// Safety: there is one core, and `with` lets nobody else in.
unsafe impl<T: Send> Sync for Shared<T> {}

impl<T> Shared<T> {
    /// Shares it.
    pub const fn new(value: T) -> Self {
        Shared(UnsafeCell::new(value))
    }

    /// Works on it with interrupts held back. Not to be called within itself for the same value.
    #[inline]
    pub fn with<R>(&self, work: impl FnOnce(&mut T) -> R) -> R {
        critical_section::with(|section| self.within(section, work))
    }

    /// Works on it where interrupts are held back already: in one of them, or in [`uninterrupted`](crate::uninterrupted). Not to be called within
    /// itself for the same value.
    #[inline]
    pub fn within<R>(&self, _: CriticalSection<'_>, work: impl FnOnce(&mut T) -> R) -> R {
        // Safety: no interrupt comes, and `work` does not call this for the same value.
        work(unsafe { &mut *self.0.get() })
    }
}
