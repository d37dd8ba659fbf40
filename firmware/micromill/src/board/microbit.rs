//! The BBC micro:bit, version 1: an nRF51822 with a Cortex-M0, 16 MHz (QEMU: `microbit`). The wiring is in the README.
//!
//! TIMER0 counts microseconds freely and compares: waits follow each other without adding up what an interrupt takes.
//: MEMORY
//: {
//:   FLASH : ORIGIN = 0x00000000, LENGTH = 64K
//:   RAM   : ORIGIN = 0x20000000, LENGTH = 3840
//: }

use core::ptr::{read_volatile, write_volatile};

use cortex_m::peripheral::NVIC;
use husillo_gcode::SpindleDirection;

use crate::shared::Shared;

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
const DIRSET: usize = 0x518;
const COMPARE0_INTERRUPT: u32 = 1 << 16;
/// Pads 0, 1, 2, 8, 12, 16: PH of both phases of X, Y and Z.
const PH: [u32; 6] = [1 << 3, 1 << 2, 1 << 1, 1 << 18, 1 << 20, 1 << 16];
/// Pads 14 and 15: the spindle forwards and backwards.
const FORWARDS: u32 = 1 << 22;
const BACKWARDS: u32 = 1 << 21;
/// The shortest wait: what the timer needs to see a comparison, and no end that has passed is waited for.
const LEAST_US: u32 = 2;

fn read(address: usize) -> u32 {
    // Safety: the addresses here are those of the chip's registers.
    unsafe { read_volatile(address as *const u32) }
}

fn set(address: usize, value: u32) {
    // Safety: as above.
    unsafe { write_volatile(address as *mut u32, value) }
}

/// When the last wait ended, and whether the transmitter is free.
static LAST_US: Shared<u32> = Shared::new(0);
static IS_FREE: Shared<bool> = Shared::new(true);

/// Pins, timer, UART, interrupts.
pub fn start() {
    let all = PH.iter().fold(FORWARDS | BACKWARDS, |all, bit| all | bit);
    set(GPIO + DIRSET, all);
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
    // Safety: their handler is below.
    unsafe {
        NVIC::unmask(Irq(2));
        NVIC::unmask(Irq(8));
    }
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

/// The phases of the motors.
pub fn write(levels: u8) {
    let (mut high, mut low) = (0, 0);
    for (place, bit) in (0..8_u32).zip(PH) {
        if levels >> place & 1 == 1 {
            high |= bit;
        } else {
            low |= bit;
        }
    }
    set(GPIO + OUTCLR, low);
    set(GPIO + OUTSET, high);
}

/// The spindle's direction; its speed is set by hand.
pub fn spindle(direction: SpindleDirection, _rpm: u16) {
    set(GPIO + OUTCLR, FORWARDS | BACKWARDS);
    match direction {
        SpindleDirection::Off => {}
        SpindleDirection::Clockwise => set(GPIO + OUTSET, FORWARDS),
        SpindleDirection::CounterClockwise => set(GPIO + OUTSET, BACKWARDS),
    }
}

/// Home switches: a simulated board has none, so they close where the loads are 400 steps below zero. On a real one: three pins.
pub fn home(position_steps: [i32; 3]) -> [bool; 3] {
    position_steps.map(|steps| steps <= -400)
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
    NVIC::unpend(Irq(8));
}

/// Sleeps until an interrupt, while nothing has happened.
pub fn sleep(nothing: impl Fn() -> bool) {
    cortex_m::interrupt::free(|_| {
        if nothing() {
            cortex_m::asm::wfi();
        }
    });
}

#[derive(Clone, Copy)]
struct Irq(u16);

// Safety: numbers of this chip's vector table.
unsafe impl cortex_m::interrupt::InterruptNumber for Irq {
    fn number(self) -> u16 {
        self.0
    }
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
                crate::on_byte(read(UART + RXD) as u8);
            }
        }
        _ => {}
    }
}
