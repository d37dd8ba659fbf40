//! What boards with an STM32F4 have in common: clocks and pins.
//!
//! The file of the board has the clocks of its chip.
//!
//! Source: reference manuals RM0368 (F401), RM0383 (F411) and RM0390 (F446).

use super::lines::Pin;
use super::{CORE_MHZ, EXTERNAL_MHZ, HAS_CRYSTAL};
use crate::registers::{is_ready, read, set};

const RCC_CR: usize = 0x4002_3800;
const RCC_PLLCFGR: usize = 0x4002_3804;
const RCC_CFGR: usize = 0x4002_3808;
const RCC_AHB1ENR: usize = 0x4002_3830;
#[cfg(feature = "otg")]
const RCC_AHB2ENR: usize = 0x4002_3834;
const RCC_APB1ENR: usize = 0x4002_3840;
const FLASH_ACR: usize = 0x4002_3c00;
const GPIO: usize = 0x4002_0000;
const GPIO_BYTES: usize = 0x400;
const MODER: usize = 0x00;
const PUPDR: usize = 0x0c;
const IDR: usize = 0x10;
const BSRR: usize = 0x18;
const AFRL: usize = 0x20;
/// The clock of USART2, Hz.
#[cfg(not(feature = "usb"))]
pub const USART_HZ: u32 = 42_000_000;
/// The clock of TIM3, Hz.
pub const TIM3_HZ: u32 = 84_000_000;

/// The register of the port of a pin.
const fn register(pin: Pin, offset: usize) -> usize {
    GPIO + pin.0 * GPIO_BYTES + offset
}

/// Sets the two bits of a pin in one of the registers of its port.
fn set_up(pin: Pin, offset: usize, value: u32) {
    let (register, at) = (register(pin, offset), 2 * pin.1);
    set(register, read(register) & !(0b11 << at) | value << at);
}

/// Drives a pin, low at first.
pub fn drive_low(pin: Pin) {
    set_port(pin.0, 0, 1 << pin.1);
    set_up(pin, MODER, 0b01);
}

/// Makes a pin an input with a pull-up.
pub fn pull_up(pin: Pin) {
    set_up(pin, PUPDR, 0b01);
    set_up(pin, MODER, 0b00);
}

/// Gives a pin to a peripheral.
fn give(pin: Pin, function: u32) {
    let register = register(pin, AFRL) + 4 * (pin.1 as usize / 8);
    let at = 4 * (pin.1 % 8);
    set(register, read(register) & !(0xf << at) | function << at);
    set_up(pin, MODER, 0b10);
}

/// Whether a pin is at ground.
pub fn is_low(pin: Pin) -> bool {
    read(register(pin, IDR)) >> pin.1 & 1 == 0
}

/// Sets pins of a port high and others low, at the same moment.
#[inline]
pub fn set_port(port: usize, high: u32, low: u32) {
    set(register(Pin(port, 0), BSRR), high | low << 16);
}

/// Starts the clocks, also those of pins and PWM.
pub fn start_chip() {
    start_clocks();
    // Ports A to C, and TIM3.
    set(RCC_AHB1ENR, read(RCC_AHB1ENR) | 0b111);
    set(RCC_APB1ENR, read(RCC_APB1ENR) | 0b10);
}

/// Starts the clock of USART2, and gives it PA2 and PA3.
#[cfg(not(feature = "usb"))]
pub fn start_usart2() {
    set(RCC_APB1ENR, read(RCC_APB1ENR) | 1 << 17);
    give(Pin(0, 2), 7);
    set_up(Pin(0, 3), PUPDR, 0b01);
    give(Pin(0, 3), 7);
}

/// Starts the clock of UART5, and gives it PC12.
#[cfg(feature = "drivers")]
pub fn start_uart5() {
    set(RCC_APB1ENR, read(RCC_APB1ENR) | 1 << 20);
    give(Pin(2, 12), 8);
}

/// Starts the clock of the USB OTG FS, and gives it its pins.
#[cfg(feature = "otg")]
pub fn start_otg() {
    set(RCC_AHB2ENR, read(RCC_AHB2ENR) | 1 << 7);
    give(Pin(0, 11), 10);
    give(Pin(0, 12), 10);
}

/// Runs the processor at `CORE_MHZ` from the external clock, or from the internal one of 16 MHz,
/// which is accurate to 1 %.
fn start_clocks() {
    let bypass = if HAS_CRYSTAL { 0 } else { 1 << 18 };
    set(RCC_CR, read(RCC_CR) | 1 << 16 | bypass);
    let (mhz, is_external) = match is_ready(RCC_CR, 17) {
        true => (EXTERNAL_MHZ, 1),
        false => (16, 0),
    };
    // 1 MHz times 336, divided for the processor, and by 7 for 48 MHz.
    let divider = 336 / CORE_MHZ / 2 - 1;
    set(
        RCC_PLLCFGR,
        mhz | 336 << 6 | divider << 16 | is_external << 22 | 7 << 24,
    );
    set(RCC_CR, read(RCC_CR) | 1 << 24);
    is_ready(RCC_CR, 25);
    // 30 MHz for a wait state of the flash. Caches and prefetch are on.
    let wait_states = CORE_MHZ.div_ceil(30) - 1;
    set(FLASH_ACR, wait_states | 0b111 << 8);
    // 42 MHz for APB1, at most 84 MHz for APB2.
    let [apb1, apb2] = if CORE_MHZ > 84 {
        [0b101, 0b100]
    } else {
        [0b100, 0]
    };
    set(RCC_CFGR, 0b10 | apb1 << 10 | apb2 << 13);
    is_ready(RCC_CFGR, 3);
}

/// Gives a pin to TIM3.
pub fn give_to_tim3(pin: Pin) {
    give(pin, 2);
}
