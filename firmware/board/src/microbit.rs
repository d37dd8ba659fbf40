//! The BBC micro:bit, version 1: an nRF51822 with a Cortex-M0, 16 MHz (QEMU: `microbit`).
//!
//! TIMER0 counts microseconds freely and compares its counter with the end of the wait. So the time
//! that an interrupt takes does not add up over successive waits.
//: MEMORY
//: {
//:   FLASH : ORIGIN = 0x00000000, LENGTH = 254K
//:   RAM   : ORIGIN = 0x20000000, LENGTH = 16K
//: }

#[cfg(feature = "flash")]
mod nvmc;

#[cfg(feature = "flash")]
pub use nvmc::{SECTOR_BYTES, UNIT_BYTES, flash_erase, flash_read, flash_write};

use crate::{
    CriticalSection, Pins, Shared,
    nvic::{self, Vector, vectors},
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
const TIMER1: usize = 0x4000_9000;
const TIMER_STOP: usize = 0x004;
const TIMER_CLEAR: usize = 0x00c;
/// The base address, which is also that of the first task.
const GPIOTE: usize = 0x4000_6000;
const GPIOTE_CONFIG: usize = GPIOTE + 0x510;
const PPI_ENABLE: usize = 0x4001_f500;
/// Event and task of each channel.
const PPI_CHANNELS: usize = 0x4001_f510;
const QDEC: usize = 0x4001_2000;
const QDEC_START: usize = 0x000;
const QDEC_READCLRACC: usize = 0x008;
const QDEC_ENABLE: usize = 0x500;
const QDEC_ACCREAD: usize = 0x518;
const QDEC_PSELA: usize = 0x520;
const QDEC_PSELB: usize = 0x524;
const DIRCLR: usize = 0x51c;
const COMPARE0_INTERRUPT: u32 = 1 << 16;
/// Motors, from bit 0: P0.01 to P0.06, P0.11 and P0.12, at pads 2, 1, 0, 3, 4, 10, 7, 6.
const MOTORS: u32 = 0x3f << 1 | 3 << 11;
/// Other outputs: P0.20 to P0.23, at pads 12, 15, 14, 13.
const OUTPUTS: u32 = 0xf << 20;
/// Switches to ground: P0.16, P0.17, P0.18, P0.26, P0.10, at pads 16, 5, 8, 11, 9.
const INPUTS: [usize; 5] = [16, 17, 18, 26, 10];
const PULLED_UP: u32 = 3 << 2;
/// With the feature `motor`: the PWM at P0.03, pad 0, and A and B of the encoder at P0.01 and
/// P0.02, pads 2 and 1.
const PWM: u32 = 3;
const ENCODER: [usize; 2] = [1, 2];
/// The timer accepts every wait: none is above 2^31.
pub const LONGEST_US: u32 = u32::MAX;
/// The counter of time counts microseconds.
pub const CLOCKS_PER_US: u32 = 1;
/// The shortest wait: the time that the timer needs to detect a match, so that it never waits for a
/// time that has passed. If the time passes nevertheless, the wait is doubled.
const LEAST_US: u32 = 2;

/// The end of the last wait, and whether the transmitter is free.
static LAST_US: Shared<u32> = Shared::new(0);
static IS_FREE: Shared<bool> = Shared::new(true);

/// The duty of the PWM, and the counts of the encoder.
static DUTY: Shared<u8> = Shared::new(0);
static COUNTS: Shared<u16> = Shared::new(0);

/// Starts pins, timer, UART and interrupts.
pub fn start() {
    set(GPIO + DIRSET, MOTORS | OUTPUTS);
    for pin in INPUTS {
        set(GPIO + PIN_CNF + 4 * pin, PULLED_UP);
    }
    set(TIMER + BITMODE, 3); // 32 bits
    set(TIMER + PRESCALER, 4); // 16 MHz / 2^4
    set(TIMER + TIMER_START, 1);
    start_motor();
    set(UART + PSELTXD, 24);
    set(UART + PSELRXD, 25);
    baud(9600);
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

/// Sets the rate of the UART.
pub fn baud(bits_per_s: u32) {
    // 2^32 / 16 MHz per bit/s, in steps of 2^12: 9600 is 0x275000. No rate is above 2^20.
    let steps = (bits_per_s << 12).wrapping_add(31_250) / 62_500;
    set(UART + BAUDRATE, steps << 12);
}

/// Whether the last stop bit has been sent.
pub fn is_sent() -> bool {
    IS_FREE.with(|is_free| *is_free || read(UART + TXDRDY) != 0)
}

/// Sets the PWM at pad 0, 31 kHz, in steps of 1/255. TIMER1 counts 256 at 8 MHz; the pin toggles
/// when it passes the duty and when it passes 0.
pub fn drive(duty: u8) {
    if cfg!(not(feature = "motor")) {
        return;
    }
    DUTY.with(|last| {
        if *last == duty {
            return;
        }
        *last = duty;
        // The timer is restarted, because a toggle might be missed if the duty changed while it
        // counts.
        set(TIMER1 + TIMER_STOP, 1);
        set(GPIOTE_CONFIG, 0);
        match duty {
            0 => set(GPIO + OUTCLR, 1 << PWM),
            255 => set(GPIO + OUTSET, 1 << PWM),
            _ => {
                set(TIMER1 + TIMER_CLEAR, 1);
                set(TIMER1 + CC0, duty.into());
                // A task that toggles this pin. The pin is high at first.
                set(GPIOTE_CONFIG, 3 | PWM << 8 | 3 << 16 | 1 << 20);
                set(TIMER1 + TIMER_START, 1);
            }
        }
    });
}

/// The counter of the encoder at pads 2 and 1, which counts every edge. The decoder samples it
/// every 128 us.
pub fn counts(simulated: u16) -> u16 {
    if cfg!(not(feature = "motor")) {
        return simulated;
    }
    COUNTS.with(|counts| {
        set(QDEC + QDEC_READCLRACC, 1);
        *counts = counts.wrapping_add(read(QDEC + QDEC_ACCREAD) as u16);
        *counts
    })
}

/// Starts PWM and decoder.
fn start_motor() {
    if cfg!(not(feature = "motor")) {
        return;
    }
    set(GPIO + DIRCLR, ENCODER.map(|pin| 1 << pin).iter().sum());
    for pin in ENCODER {
        set(GPIO + PIN_CNF + 4 * pin, PULLED_UP);
    }
    set(QDEC + QDEC_PSELA, ENCODER[0] as u32);
    set(QDEC + QDEC_PSELB, ENCODER[1] as u32);
    set(QDEC + QDEC_ENABLE, 1);
    set(QDEC + QDEC_START, 1);
    set(TIMER1 + BITMODE, 1); // 8 bits
    set(TIMER1 + PRESCALER, 1); // 16 MHz / 2
    set(TIMER1 + CC1, 0);
    for (channel, event) in [COMPARE0, COMPARE0 + 4].into_iter().enumerate() {
        set(PPI_CHANNELS + 8 * channel, (TIMER1 + event) as u32);
        set(PPI_CHANNELS + 8 * channel + 4, GPIOTE as u32);
    }
    set(PPI_ENABLE, 3);
}

/// It has no 18 free pins.
#[cfg(feature = "wide")]
compile_error!("this board has 8 pins for motors: leave out the feature `wide`");

/// Sets the motors' pins.
#[inline]
pub fn write(levels: Pins) {
    let levels = u32::from(levels);
    let high = (levels & 0x3f) << 1 | (levels & 0xc0) << 5;
    set(GPIO + OUTCLR, MOTORS & !high);
    set(GPIO + OUTSET, high);
}

/// Sets the other outputs.
pub fn switch(outputs: u8) {
    let high = u32::from(outputs) << 20 & OUTPUTS;
    set(GPIO + OUTCLR, OUTPUTS & !high);
    set(GPIO + OUTSET, high);
}

/// Reads the switches; a closed one is 1.
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

/// The counter of time, which wraps: [`CLOCKS_PER_US`] a microsecond.
pub fn clock() -> u32 {
    now_us()
}

/// Calls `on_time` this many microseconds after the end of the previous wait, or at once if that
/// time has passed.
#[inline]
pub fn wait(us: u32, section: CriticalSection<'_>) {
    LAST_US.within(section, |last| {
        let begin = *last;
        *last = last.wrapping_add(us);
        set(TIMER + CC0, *last);
        // Cleared after CC0 is set, because QEMU sets it again while the counter is at the old
        // value.
        set(TIMER + COMPARE0, 0);
        // If the time has passed, the difference wraps. If it passed long ago, the difference may
        // have any value, but seldom one within the wait.
        let left_us = last.wrapping_sub(now_us());
        if left_us < LEAST_US || left_us > us {
            *last = late(begin, us);
        }
    });
    set(TIMER + INTENSET, COMPARE0_INTERRUPT);
}

/// Ends a wait whose time has passed as soon as possible. If the previous wait was cut short, its
/// end is later than now. Then this wait counts from now.
#[cold]
fn late(begin: u32, us: u32) -> u32 {
    let is_cut = begin.wrapping_sub(now_us()) < 1 << 31;
    let mut least_us = if is_cut { us.max(LEAST_US) } else { LEAST_US };
    loop {
        let end = now_us().wrapping_add(least_us);
        set(TIMER + CC0, end);
        set(TIMER + COMPARE0, 0);
        // The timer may have matched the time that has passed.
        nvic::unpend(8);
        if end.wrapping_sub(now_us()).wrapping_sub(1) < 1 << 31 {
            return end;
        }
        least_us = least_us.wrapping_mul(2);
    }
}

/// Cancels the wait.
pub fn stop() {
    set(TIMER + INTENCLR, COMPARE0_INTERRUPT);
    set(TIMER + COMPARE0, 0);
    nvic::unpend(8);
}

/// The chip's interrupts by their numbers.
#[unsafe(link_section = ".vector_table.interrupts")]
#[unsafe(no_mangle)]
static __INTERRUPTS: [Vector; 9] = vectors([(2, on_uart_interrupt), (8, on_timer_interrupt)]);

/// A wait is over. `on_time` sets the next wait or cancels it, which acknowledges the interrupt.
extern "C" fn on_timer_interrupt() {
    // Safety: this is an interrupt's handler.
    crate::on_time(unsafe { crate::section() });
}

extern "C" fn on_uart_interrupt() {
    while read(UART + RXDRDY) != 0 {
        set(UART + RXDRDY, 0);
        crate::heard(read(UART + RXD) as u8);
    }
}
