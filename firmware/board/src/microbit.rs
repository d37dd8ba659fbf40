//! The BBC micro:bit, version 1: an nRF51822 with a Cortex-M0, 16 MHz (QEMU: `microbit`).
//!
//! TIMER0 counts microseconds freely and compares: waits follow each other without adding up what an interrupt takes.
//: MEMORY
//: {
//:   FLASH : ORIGIN = 0x00000000, LENGTH = 64K
//:   RAM   : ORIGIN = 0x20000000, LENGTH = 3840
//: }

use crate::{
    Shared, nvic,
    registers::{read, set},
};

const UART: usize = 0x4000_2000;
const STARTRX: usize = 0x000;
const STARTTX: usize = 0x008;
const RXDRDY: usize = 0x108;
const TXDRDY: usize = 0x11c;
const INTENSET: usize = 0x304;
const UART_ENABLE: usize = 0x500;
const PSELTXD: usize = 0x50c;
const PSELRXD: usize = 0x514;
const RXD: usize = 0x518;
const TXD: usize = 0x51c;
const BAUDRATE: usize = 0x524;
const TIMER: usize = 0x4000_8000;
const TIMER_START: usize = 0x000;
const CAPTURE1: usize = 0x044;
const COMPARE0: usize = 0x140;
const INTENCLR: usize = 0x308;
const BITMODE: usize = 0x508;
const PRESCALER: usize = 0x510;
const CC0: usize = 0x540;
const CC1: usize = 0x544;
const GPIO: usize = 0x5000_0000;
const OUTSET: usize = 0x508;
const OUTCLR: usize = 0x50c;
const IN: usize = 0x510;
const DIRSET: usize = 0x518;
const PIN_CNF: usize = 0x700;
const COMPARE0_INTERRUPT: u32 = 1 << 16;
/// P0.01 to P0.06, P0.11 and P0.12, pads 2, 1, 0, 3, 4, 10, 7, 6: the motors, from bit 0.
const MOTORS: u32 = 0x3f << 1 | 3 << 11;
/// P0.20 to P0.23, pads 12, 15, 14, 13: other outputs.
const OUTPUTS: u32 = 0xf << 20;
/// P0.16, P0.17, P0.18, P0.26, P0.10, pads 16, 5, 8, 11, 9: switches to ground.
const INPUTS: [usize; 5] = [16, 17, 18, 26, 10];
const PULLED_UP: u32 = 3 << 2;
/// The shortest wait: what the timer needs to see a comparison, and no end that has passed is waited for.
const LEAST_US: u32 = 2;

/// When the last wait ended, and whether the transmitter is free.
static LAST_US: Shared<u32> = Shared::new(0);
static IS_FREE: Shared<bool> = Shared::new(true);

/// Pins, timer, UART, interrupts.
pub fn start() {
    set(GPIO + DIRSET, MOTORS | OUTPUTS);
    for pin in INPUTS {
        set(GPIO + PIN_CNF + 4 * pin, PULLED_UP);
    }
    set(TIMER + BITMODE, 3); // 32 bits
    set(TIMER + PRESCALER, 4); // 16 MHz / 2^4
    set(TIMER + TIMER_START, 1);
    set(UART + PSELTXD, 24);
    set(UART + PSELRXD, 25);
    set(UART + BAUDRATE, 0x0027_5000); // 9600
    set(UART + UART_ENABLE, 4);
    set(UART + STARTRX, 1);
    set(UART + STARTTX, 1);
    set(UART + INTENSET, 1 << 2); // a byte received
    nvic::unmask(2);
    nvic::unmask(8);
}

/// Sends a byte, if the transmitter is free.
pub fn send(byte: u8) -> bool {
    IS_FREE.with(|is_free| {
        let may_send = *is_free || read(UART + TXDRDY) != 0;
        if may_send {
            set(UART + TXDRDY, 0);
            set(UART + TXD, byte.into());
            *is_free = false;
        }
        may_send
    })
}

/// The motors' pins.
#[inline]
pub fn write(levels: u8) {
    let levels = u32::from(levels);
    let high = (levels & 0x3f) << 1 | (levels & 0xc0) << 5;
    set(GPIO + OUTCLR, MOTORS & !high);
    set(GPIO + OUTSET, high);
}

/// The other outputs.
pub fn switch(outputs: u8) {
    let high = u32::from(outputs) << 20 & OUTPUTS;
    set(GPIO + OUTCLR, OUTPUTS & !high);
    set(GPIO + OUTSET, high);
}

/// The switches: 1 where one is closed.
pub fn inputs(simulated: u8) -> u8 {
    if cfg!(not(feature = "switches")) {
        return simulated;
    }
    let open = read(GPIO + IN);
    INPUTS
        .iter()
        .rev()
        .fold(0, |closed, pin| closed << 1 | (!open >> pin & 1) as u8)
}

fn now_us() -> u32 {
    set(TIMER + CAPTURE1, 1);
    read(TIMER + CC1)
}

/// Calls `on_time` so many microseconds after the last time, or at once where that has passed.
pub fn wait(us: u32) {
    LAST_US.with(|last| {
        *last = last.wrapping_add(us);
        loop {
            // What has passed wraps to the upper half; waits are 2^31 at most.
            let now = now_us();
            let left = last.wrapping_sub(now);
            if left.wrapping_sub(LEAST_US) > (1 << 31) - LEAST_US {
                *last = now.wrapping_add(LEAST_US);
            }
            set(TIMER + CC0, *last);
            // Only now: QEMU sets it again while the counter stands on the old value.
            set(TIMER + COMPARE0, 0);
            // It may have come in between.
            if last.wrapping_sub(now_us()).wrapping_sub(1) < 1 << 31 {
                break;
            }
        }
        set(TIMER + INTENSET, COMPARE0_INTERRUPT);
    });
}

/// Ends the wait.
pub fn stop() {
    set(TIMER + INTENCLR, COMPARE0_INTERRUPT);
    set(TIMER + COMPARE0, 0);
    nvic::unpend(8);
}

#[cortex_m_rt::exception]
unsafe fn DefaultHandler(number: i16) {
    match number {
        8 => {
            set(TIMER + INTENCLR, COMPARE0_INTERRUPT);
            set(TIMER + COMPARE0, 0);
            crate::on_time();
        }
        2 => {
            while read(UART + RXDRDY) != 0 {
                set(UART + RXDRDY, 0);
                crate::heard(read(UART + RXD) as u8);
            }
        }
        _ => {}
    }
}
