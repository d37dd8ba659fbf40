//! ARM's MPS2 board with a Cortex-M4F (QEMU: `mps2-an386`), 25 MHz.
//!
//! UART0 is the link. GPIO0 has the motors at pins 0 to 7 and other outputs at pins 8 to 11. GPIO1
//! has switches to ground at pins 0 to 4. With the feature `wide`, the motors are at pins 0 to 15
//! of GPIO2 and at pins 0 and 1 of GPIO3, and jumpers to ground at pins 5 to 7 of GPIO1. Without
//! `switches`, the jumpers are the bits of the word at 0x21000000, which QEMU's loader sets.
//!
//! TIMER0 makes the step interrupt. Its reload value is 0, so it counts down once. TIMER1 counts
//! freely, so the time that an interrupt takes does not add up over successive waits.
//: MEMORY
//: {
//:   FLASH : ORIGIN = 0x00000000, LENGTH = 512K
//:   RAM   : ORIGIN = 0x20000000, LENGTH = 128K
//: }

#[cfg(feature = "flash")]
mod ram_flash;

#[cfg(feature = "flash")]
pub use ram_flash::{SECTOR_BYTES, UNIT_BYTES, flash_erase, flash_read, flash_write};

use crate::{
    CriticalSection, Pins, Shared,
    nvic::{self, Vector, vectors},
    registers::{read, set},
};

const TIMER0: usize = 0x4000_0000;
const TIMER1: usize = 0x4000_1000;
const CTRL: usize = 0x0;
const VALUE: usize = 0x4;
const RELOAD: usize = 0x8;
const INTCLEAR: usize = 0xc;
const UART0: usize = 0x4000_4000;
const DATA: usize = 0x0;
const STATE: usize = 0x4;
const UART_CTRL: usize = 0x8;
const UART_INTCLEAR: usize = 0xc;
const BAUDDIV: usize = 0x10;
const GPIO0: usize = 0x4001_0000;
const GPIO1: usize = 0x4001_1000;
/// Pins addressed by their mask.
#[cfg(not(feature = "wide"))]
const LOW_BYTE: usize = 0x400 + 4 * 0xff;
const PINS_8_TO_11: usize = 0x800 + 4 * 0x0f;
const OUTENSET: usize = 0x10;
/// With the feature `wide`: the motors' lines 0 to 15, and 16 and 17.
#[cfg(feature = "wide")]
const WIDE: [usize; 2] = [0x4001_2000, 0x4001_3000];
#[cfg(feature = "wide")]
const DATAOUT: usize = 0x4;
/// The jumpers in QEMU, which has no pins: a word of RAM that the firmware does not use.
#[cfg(feature = "wide")]
const SIMULATED_JUMPERS: usize = 0x2100_0000;
/// The counter of time counts clocks.
pub const CLOCKS_PER_US: u32 = 25;
const CLOCKS_PER_S: u32 = 25_000_000;
/// The longest wait of the timer: 67 s.
pub const LONGEST_US: u32 = 1 << 26;

/// The end of the last wait.
static LAST: Shared<u32> = Shared::new(0);

/// The time when the UART took the last byte.
static SENT_AT: Shared<u32> = Shared::new(0);

/// Starts pins, timers, UART and interrupts.
pub fn start() {
    set(GPIO0 + OUTENSET, 0xfff);
    #[cfg(feature = "wide")]
    for (gpio, pins) in WIDE.into_iter().zip([0xffff, 0b11]) {
        set(gpio + OUTENSET, pins);
    }
    set(TIMER0 + RELOAD, 0);
    set(TIMER0 + VALUE, u32::MAX);
    set(TIMER0 + CTRL, 0b1001); // with its interrupt
    stop();
    set(TIMER1 + RELOAD, u32::MAX);
    set(TIMER1 + VALUE, u32::MAX);
    set(TIMER1 + CTRL, 1);
    baud(9600);
    set(UART0 + UART_CTRL, 0b1011); // both directions, receive interrupt
    nvic::unmask(0);
    nvic::unmask(8);
}

/// Sends a byte, if the transmitter is free.
pub fn send(byte: u8) -> bool {
    let is_free = read(UART0 + STATE) & 1 == 0;
    if is_free {
        set(UART0 + DATA, byte.into());
        SENT_AT.with(|at| *at = clock());
    }
    is_free
}

/// Sets the rate of the UART.
pub fn baud(bits_per_s: u32) {
    set(UART0 + BAUDDIV, CLOCKS_PER_S / bits_per_s.max(1));
}

/// Sends a byte to the drivers of the motors, by UART1. It begins with the first call.
#[cfg(feature = "drivers")]
pub fn send_to_drivers(byte: u8) -> bool {
    const UART1: usize = 0x4000_5000;
    if read(UART1 + UART_CTRL) == 0 {
        set(UART1 + BAUDDIV, CLOCKS_PER_S / 115_200);
        set(UART1 + UART_CTRL, 1); // sends only
    }
    let is_free = read(UART1 + STATE) & 1 == 0;
    if is_free {
        set(UART1 + DATA, byte.into());
    }
    is_free
}

/// Whether the last stop bit has been sent. The UART reports only that its buffer is empty, which
/// is one byte earlier. Two characters later, the stop bit has been sent.
pub fn is_sent() -> bool {
    let since = SENT_AT.with(|at| clock().wrapping_sub(*at));
    read(UART0 + STATE) & 1 == 0 && since > read(UART0 + BAUDDIV).wrapping_mul(20)
}

/// This board has no PWM.
pub fn drive(_: u8) {}

/// This board has no counter for an encoder.
pub fn counts(simulated: u16) -> u16 {
    simulated
}

/// Sets the motors' pins.
#[inline]
#[cfg(not(feature = "wide"))]
pub fn write(levels: Pins) {
    set(GPIO0 + LOW_BYTE, levels.into());
}

/// Sets the motors' pins.
#[inline]
#[cfg(feature = "wide")]
pub fn write(levels: Pins) {
    let [low, high] = WIDE;
    set(low + DATAOUT, levels & 0xffff);
    set(high + DATAOUT, levels >> 16 & 0b11);
}

/// Sets the other outputs.
pub fn switch(outputs: u8) {
    set(GPIO0 + PINS_8_TO_11, u32::from(outputs & 0xf) << 8);
}

/// Reads the switches; a closed one is 1.
pub fn inputs(simulated: u8) -> u8 {
    if cfg!(not(feature = "switches")) {
        return simulated;
    }
    !read(GPIO1 + DATA) as u8 & 0x1f
}

/// Reads the jumpers; a closed one is 1.
#[cfg(feature = "wide")]
pub fn jumpers() -> u8 {
    if cfg!(not(feature = "switches")) {
        return read(SIMULATED_JUMPERS) as u8;
    }
    (!read(GPIO1 + DATA) >> 5 & 0b111) as u8
}

/// The counter of time, which wraps: [`CLOCKS_PER_US`] a microsecond.
pub fn clock() -> u32 {
    !read(TIMER1 + VALUE)
}

/// Calls `on_time` this many microseconds after the end of the previous wait, or at once if that
/// time has passed.
#[inline]
pub fn wait(us: u32, section: CriticalSection<'_>) {
    LAST.within(section, |last| {
        let now = clock();
        // Below 2^31.
        let clocks = us.wrapping_mul(CLOCKS_PER_US);
        let left = last.wrapping_add(clocks).wrapping_sub(now);
        // If the time has passed, the difference wraps. If it passed long ago, the difference may
        // have any value, but seldom one within the wait.
        let left = if left.wrapping_sub(1) < clocks {
            left
        } else if last.wrapping_sub(now) < 1 << 31 {
            // The previous wait was cut short, so this one counts from now.
            clocks.max(1)
        } else {
            1
        };
        *last = now.wrapping_add(left);
        set(TIMER0 + VALUE, left);
    });
}

/// Cancels the wait.
pub fn stop() {
    set(TIMER0 + VALUE, 0);
    set(TIMER0 + INTCLEAR, 1);
    nvic::unpend(8);
}

/// The chip's interrupts by their numbers.
#[unsafe(link_section = ".vector_table.interrupts")]
#[unsafe(no_mangle)]
static __INTERRUPTS: [Vector; 32] = vectors([(0, on_uart_interrupt), (8, on_timer_interrupt)]);

extern "C" fn on_timer_interrupt() {
    set(TIMER0 + INTCLEAR, 1);
    // Safety: this is an interrupt's handler.
    crate::on_time(unsafe { crate::section() });
}

extern "C" fn on_uart_interrupt() {
    set(UART0 + UART_INTCLEAR, 0b10);
    while read(UART0 + STATE) & 0b10 != 0 {
        crate::heard(read(UART0 + DATA) as u8);
    }
}
