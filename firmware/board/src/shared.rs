//! Data that foreground and interrupts share.

use core::cell::UnsafeCell;

use critical_section::CriticalSection;

/// A value that is accessed only while interrupts are disabled.
pub struct Shared<T>(UnsafeCell<T>);

// Safety: there is one core, and all access is within a critical section.
unsafe impl<T: Send> Sync for Shared<T> {}

impl<T> Shared<T> {
    /// Wraps a value.
    pub const fn new(value: T) -> Self {
        Shared(UnsafeCell::new(value))
    }

    /// Accesses the value with interrupts disabled. Must not be nested for the same value.
    #[inline]
    pub fn with<R>(&self, work: impl FnOnce(&mut T) -> R) -> R {
        critical_section::with(|section| self.within(section, work))
    }

    /// Accesses the value if interrupts are already disabled: in an interrupt, or in
    /// [`uninterrupted`](crate::uninterrupted). Must not be nested for the same value.
    #[inline]
    pub fn within<R>(&self, _: CriticalSection<'_>, work: impl FnOnce(&mut T) -> R) -> R {
        // Safety: interrupts are disabled, and `work` does not access the same value.
        work(unsafe { &mut *self.0.get() })
    }
}
