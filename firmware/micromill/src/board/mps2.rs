//! ARM's MPS2 board with a Cortex-M4F (QEMU: `mps2-an386`), 25 MHz.
//!
//! UART0 is the link; GPIO0 pins 0 to 5 are PH of both phases of X, Y and Z, pins 8 and 9 the spindle forwards and backwards. TIMER0 is the
//! step interrupt, TIMER1 counts freely: waits follow each other without adding up what an interrupt takes.
//: MEMORY
//: {
//:   FLASH : ORIGIN = 0x00000000, LENGTH = 64K
//:   RAM   : ORIGIN = 0x20000000, LENGTH = 3840
//: }

use core::ptr::{read_volatile, write_volatile};

use cortex_m::peripheral::NVIC;
use husillo_gcode::SpindleDirection;

use crate::shared::Shared;

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
const DATAOUT: usize = 0x4;
const OUTENSET: usize = 0x10;
const CLOCKS_PER_US: u32 = 25;
/// The longest wait the timer takes at once: 60 s.
const LONGEST_US: u32 = 60_000_000;

fn read(address: usize) -> u32 {
    // Safety: the addresses here are those of the board's registers.
    unsafe { read_volatile(address as *const u32) }
}

fn set(address: usize, value: u32) {
    // Safety: as above.
    unsafe { write_volatile(address as *mut u32, value) }
}

/// When the last wait ended, and what is left of the one that runs.
struct Clock {
    last: u32,
    rest_us: u32,
}

static CLOCK: Shared<Clock> = Shared::new(Clock {
    last: 0,
    rest_us: 0,
});
static SPINDLE: Shared<u32> = Shared::new(0);

/// Pins, timers, UART, interrupts.
pub fn start() {
    set(GPIO0 + OUTENSET, 0x33f);
    set(TIMER1 + RELOAD, u32::MAX);
    set(TIMER1 + VALUE, u32::MAX);
    set(TIMER1 + CTRL, 1);
    set(UART0 + BAUDDIV, 25_000_000 / 9600);
    set(UART0 + UART_CTRL, 0b1011); // both ways, interrupt of the receiver
    // Safety: their handler is below.
    unsafe {
        NVIC::unmask(Irq(0));
        NVIC::unmask(Irq(8));
    }
}

/// Sends a byte, if the transmitter is free.
pub fn send(byte: u8) -> bool {
    let is_free = read(UART0 + STATE) & 1 == 0;
    if is_free {
        set(UART0 + DATA, byte.into());
    }
    is_free
}

/// The phases of the motors.
pub fn write(levels: u8) {
    let spindle = SPINDLE.with(|spindle| *spindle);
    set(GPIO0 + DATAOUT, spindle | u32::from(levels));
}

/// The spindle's direction; its speed is set by hand.
pub fn spindle(direction: SpindleDirection, _rpm: u16) {
    let bits = match direction {
        SpindleDirection::Off => 0,
        SpindleDirection::Clockwise => 1 << 8,
        SpindleDirection::CounterClockwise => 1 << 9,
    };
    SPINDLE.with(|spindle| *spindle = bits);
}

/// Home switches: a simulated board has none, so they close where the loads are 400 steps below zero. On a real one: three pins.
pub fn home(position_steps: [i32; 3]) -> [bool; 3] {
    position_steps.map(|steps| steps <= -400)
}

/// Calls `on_time` so many microseconds after the last time, or at once where that has passed.
pub fn wait(us: u32) {
    CLOCK.with(|clock| {
        let part = us.min(LONGEST_US);
        clock.rest_us = us.wrapping_sub(part);
        let now = !read(TIMER1 + VALUE);
        // Below 2^31.
        let end = clock.last.wrapping_add(part.wrapping_mul(CLOCKS_PER_US));
        let left = end.wrapping_sub(now);
        // What has passed wraps to the upper half.
        let left = if left.wrapping_sub(1) < 1 << 31 {
            left
        } else {
            1
        };
        clock.last = now.wrapping_add(left);
        set(TIMER0 + RELOAD, left);
        set(TIMER0 + VALUE, left);
        set(TIMER0 + CTRL, 0b1001);
    });
}

/// Ends the wait.
pub fn stop() {
    set(TIMER0 + CTRL, 0);
    set(TIMER0 + INTCLEAR, 1);
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

// Safety: numbers of this board's vector table.
unsafe impl cortex_m::interrupt::InterruptNumber for Irq {
    fn number(self) -> u16 {
        self.0
    }
}

#[cortex_m_rt::exception]
unsafe fn DefaultHandler(number: i16) {
    match number {
        8 => {
            set(TIMER0 + CTRL, 0);
            set(TIMER0 + INTCLEAR, 1);
            match CLOCK.with(|clock| core::mem::take(&mut clock.rest_us)) {
                0 => crate::on_time(),
                rest => wait(rest),
            }
        }
        0 => {
            set(UART0 + UART_INTCLEAR, 0b10);
            while read(UART0 + STATE) & 0b10 != 0 {
                crate::on_byte(read(UART0 + DATA) as u8);
            }
        }
        _ => {}
    }
}
