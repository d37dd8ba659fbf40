//! The chip of a Blue Pill, an STM32F103 at 72 MHz: clocks and pins.
//!
//! Source: reference manual RM0008.

#[cfg(feature = "usb")]
use super::CORE_MHZ;
use super::lines::Pin;
use crate::registers::{is_ready, read, set};

const RCC_CR: usize = 0x4002_1000;
const RCC_CFGR: usize = 0x4002_1004;
const RCC_APB2ENR: usize = 0x4002_1018;
const RCC_APB1ENR: usize = 0x4002_101c;
const FLASH_ACR: usize = 0x4002_2000;
const AFIO_MAPR: usize = 0x4001_0004;
const GPIO: usize = 0x4001_0800;
const GPIO_BYTES: usize = 0x400;
const CRL: usize = 0x00;
const IDR: usize = 0x08;
const BSRR: usize = 0x10;
/// Settings of a pin: output of 10 MHz, the same for a peripheral, input with pull-up or pull-down.
const DRIVEN: u32 = 0b0001;
const GIVEN: u32 = 0b1001;
const PULLED: u32 = 0b1000;
/// The clock of USART2, Hz.
#[cfg(not(feature = "usb"))]
pub const USART_HZ: u32 = 36_000_000;
/// The clock of TIM3, Hz.
pub const TIM3_HZ: u32 = 72_000_000;

/// The register of the port of a pin.
const fn register(pin: Pin, offset: usize) -> usize {
    GPIO + pin.0 * GPIO_BYTES + offset
}

/// Sets the four bits of a pin.
fn set_up(pin: Pin, value: u32) {
    let register = register(pin, CRL) + 4 * (pin.1 as usize / 8);
    let at = 4 * (pin.1 % 8);
    set(register, read(register) & !(0xf << at) | value << at);
}

/// Drives a pin, low at first.
pub fn drive_low(pin: Pin) {
    set_port(pin.0, 0, 1 << pin.1);
    set_up(pin, DRIVEN);
}

/// Makes a pin an input with a pull-up.
pub fn pull_up(pin: Pin) {
    set_port(pin.0, 1 << pin.1, 0);
    set_up(pin, PULLED);
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
    // AFIO and the ports A to C; TIM3.
    set(RCC_APB2ENR, read(RCC_APB2ENR) | 0b1_1101);
    set(RCC_APB1ENR, read(RCC_APB1ENR) | 0b10);
    // PA15, PB3 and PB4 are pins, and not those of JTAG.
    set(AFIO_MAPR, 0b010 << 24);
}

/// Runs the processor at 72 MHz from the crystal of 8 MHz. Without the crystal it is 64 MHz from
/// the internal clock: the board then runs slowly, and USB does not work.
fn start_clocks() {
    set(RCC_CR, read(RCC_CR) | 1 << 16);
    let has_crystal = is_ready(RCC_CR, 17);
    // Two wait states of the flash, and prefetch.
    set(FLASH_ACR, 0b1_0010);
    // 8 MHz times 9, or 4 MHz times 16; half of it for APB1.
    let source = if has_crystal {
        1 << 16 | 7 << 18
    } else {
        14 << 18
    };
    let dividers = source | 0b100 << 8;
    set(RCC_CFGR, dividers);
    set(RCC_CR, read(RCC_CR) | 1 << 24);
    is_ready(RCC_CR, 25);
    set(RCC_CFGR, dividers | 0b10);
    is_ready(RCC_CFGR, 3);
}

/// Starts the clock of USART2, and gives it PA2 and PA3.
#[cfg(not(feature = "usb"))]
pub fn start_usart2() {
    set(RCC_APB1ENR, read(RCC_APB1ENR) | 1 << 17);
    set_up(Pin(0, 2), GIVEN);
    pull_up(Pin(0, 3));
}

/// Starts the clock of the USB. The board has a resistor that reports the device to the host, so a
/// low level at PA12 has the host look for it again.
#[cfg(feature = "usb")]
pub fn start_usb() {
    drive_low(Pin(0, 12));
    cortex_m::asm::delay(10_000 * CORE_MHZ);
    // An input without pull-up.
    set_up(Pin(0, 12), 0b0100);
    set(RCC_APB1ENR, read(RCC_APB1ENR) | 1 << 23);
}

/// Gives a pin to TIM3.
pub fn give_to_tim3(pin: Pin) {
    set_up(pin, GIVEN);
}
