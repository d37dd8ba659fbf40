//! The part of a peripheral access crate that RTIC needs, for QEMU's `mps2-an386`: priority bits
//! and interrupts. Only the first timer is included.

use cortex_m::interrupt::InterruptNumber;

/// Number of priority bits.
pub const NVIC_PRIO_BITS: u8 = 3;

/// The interrupts by their numbers.
#[derive(Clone, Copy)]
#[repr(u16)]
pub enum Interrupt {
    /// The first timer.
    TIMER0 = 8,
}

/// The name that peripheral access crates also give this type.
pub use Interrupt as interrupt;

// Safety: the chip has these numbers.
unsafe impl InterruptNumber for Interrupt {
    fn number(self) -> u16 {
        self as u16
    }
}

unsafe extern "C" {
    fn TIMER0();
}

/// The vector table, with only the handler of the timer.
#[unsafe(link_section = ".vector_table.interrupts")]
#[unsafe(no_mangle)]
static __INTERRUPTS: [Option<unsafe extern "C" fn()>; 9] =
    [None, None, None, None, None, None, None, None, Some(TIMER0)];

const TIMER: *mut u32 = 0x4000_0000 as *mut u32;
const HZ: u32 = 25_000_000;

/// Starts the timer interrupt with this period.
pub fn start(period_us: u32) {
    // Safety: these are the timer's registers: reload, and control with interrupt and count.
    unsafe {
        TIMER.add(2).write_volatile(HZ / 1_000_000 * period_us - 1);
        TIMER.write_volatile(0b1001);
    }
}

/// Acknowledges the interrupt.
pub fn acknowledge() {
    // Safety: as above.
    unsafe { TIMER.add(3).write_volatile(1) };
}
