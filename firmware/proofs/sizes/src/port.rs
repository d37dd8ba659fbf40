//! A register of a port that the optimiser cannot see through, and the end of all panics.

use core::sync::atomic::{AtomicU32, Ordering};

static PORT: AtomicU32 = AtomicU32::new(0);

/// The next byte, as of a receive register.
pub fn receive() -> u8 {
    PORT.load(Ordering::Relaxed) as u8
}

/// A result that must be made.
pub fn send(value: u32) {
    PORT.store(value, Ordering::Relaxed);
}

#[panic_handler]
fn panic(_: &core::panic::PanicInfo) -> ! {
    loop {}
}
