//! The clocks, watchdogs and pins of an ESP32-C3.
//!
//! Source: ESP32-C3 Technical Reference Manual, chapters on the IO MUX, clocks, watchdogs.

use super::lines::Pin;
use crate::registers::{read, set};

const GPIO: usize = 0x6000_4000;
const OUT_SET: usize = GPIO + 0x08;
const OUT_CLEAR: usize = GPIO + 0x0c;
const ENABLE_SET: usize = GPIO + 0x24;
const ENABLE_CLEAR: usize = GPIO + 0x28;
const IN: usize = GPIO + 0x3c;
const SIGNALS: usize = GPIO + 0x554;
const PADS: usize = 0x6000_9004;
/// A pad that belongs to the GPIO matrix: third of four drive strengths, about 20 mA.
const BY_MATRIX: u32 = 1 << 12 | 2 << 10;
/// The same for an input with a pull-up.
const PULLED_UP: u32 = BY_MATRIX | 1 << 9 | 1 << 8;
/// The signal of a pin that the register `OUT` drives.
const BY_OUT: u32 = 128;
/// `ENABLE` decides whether a pin is an output, also if a peripheral drives it.
const BY_ENABLE: u32 = 1 << 9;

const SYSTEM: usize = 0x600c_0000;
const CPU_CLOCK: usize = SYSTEM + 0x08;
const CLOCKS_ON: usize = SYSTEM + 0x10;
const RESETS: usize = SYSTEM + 0x18;
const SYSTEM_CLOCK: usize = SYSTEM + 0x58;
/// Bits of `CLOCKS_ON` and `RESETS`: PWM, USB, timer.
const PWM: u32 = 1 << 11;
const USED: u32 = PWM | 1 << 23 | 1 << 29;

/// A watchdog: its control register, the register that protects it, and the key.
type Watchdog = (usize, usize, u32);
const WATCHDOG_KEY: u32 = 0x50d8_3aa1;
const OF_RTC: Watchdog = (0x6000_8090, 0x6000_80a8, WATCHDOG_KEY);
const OF_TIMERS: Watchdog = (0x6001_f048, 0x6001_f064, WATCHDOG_KEY);
/// The super watchdog. Bit 31: it feeds itself.
const SUPER: Watchdog = (0x6000_80ac, 0x6000_80b0, 0x8f1d_312a);
const FEEDS_ITSELF: u32 = 1 << 31;

unsafe extern "C" {
    /// A function of the boot ROM, whose delays count cycles.
    safe fn ets_update_cpu_frequency(mhz: u32);
}

/// Writes a protected register of a watchdog.
fn set_watchdog((control, protection, key): Watchdog, value: u32) {
    set(protection, key);
    set(control, value);
    set(protection, 0);
}

/// Stops the watchdogs that the boot ROM has started, runs the processor at 160 MHz, and starts the
/// clocks of timer, PWM and USB. The PLL already runs at 480 MHz, because the boot ROM uses the
/// USB.
pub fn start_chip() {
    set_watchdog(OF_RTC, 0);
    set_watchdog(OF_TIMERS, 0);
    set_watchdog(SUPER, read(SUPER.0) | FEEDS_ITSELF);
    // A third of the PLL.
    set(CPU_CLOCK, read(CPU_CLOCK) & !0b11 | 1 << 2 | 1);
    set(SYSTEM_CLOCK, read(SYSTEM_CLOCK) & !(0b11 << 10 | 0x3ff) | 1 << 10);
    ets_update_cpu_frequency(160);
    set(CLOCKS_ON, read(CLOCKS_ON) | USED);
    set(RESETS, read(RESETS) & !USED);
}

/// The register of a pin in a table.
fn register(table: usize, pin: Pin) -> usize {
    table + 4 * pin.1 as usize
}

/// Drives a pin, low at first.
pub fn drive_low(pin: Pin) {
    set(OUT_CLEAR, 1 << pin.1);
    give(pin, BY_OUT);
}

/// Makes a pin an output of the signal with this number.
pub fn give(pin: Pin, signal: u32) {
    set(register(SIGNALS, pin), signal | BY_ENABLE);
    set(register(PADS, pin), BY_MATRIX);
    set(ENABLE_SET, 1 << pin.1);
}

/// Makes a pin an input with a pull-up.
pub fn pull_up(pin: Pin) {
    set(ENABLE_CLEAR, 1 << pin.1);
    set(register(PADS, pin), PULLED_UP);
}

/// Whether a pin is at ground.
pub fn is_low(pin: Pin) -> bool {
    read(IN) >> pin.1 & 1 == 0
}

/// Sets pins low, then others high. All pins belong to one port.
#[inline]
pub fn set_port(_: usize, high: u32, low: u32) {
    set(OUT_CLEAR, low);
    set(OUT_SET, high);
}
