//! QEMU's `virt` with one RV32IMAC hart. Its UART is a 16550, and its timer runs at 10 MHz. The
//! only pins are those of the UART: the motors' levels are written to the scratch register, and the
//! other outputs are DTR, RTS, OUT1 and OUT2.
//: MEMORY
//: {
//:   FLASH : ORIGIN = 0x80000000, LENGTH = 256K
//:   RAM   : ORIGIN = 0x80100000, LENGTH = 128K
//: }
//: REGION_ALIAS("REGION_TEXT", FLASH);
//: REGION_ALIAS("REGION_RODATA", FLASH);
//: REGION_ALIAS("REGION_DATA", RAM);
//: REGION_ALIAS("REGION_BSS", RAM);
//: REGION_ALIAS("REGION_HEAP", RAM);
//: REGION_ALIAS("REGION_STACK", RAM);

#[cfg(feature = "flash")]
mod ram_flash;

#[cfg(feature = "flash")]
pub use ram_flash::{SECTOR_BYTES, UNIT_BYTES, flash_erase, flash_read, flash_write};

use core::ptr::{read_volatile, write_volatile};

use riscv::interrupt::Interrupt;

use crate::{
    CriticalSection, Pins, Shared,
    registers::{read, set},
};

const UART: usize = 0x1000_0000;
const INTERRUPTS: usize = 1;
const LINE_CONTROL: usize = 3;
const MODEM_CONTROL: usize = 4;
const LINE_STATUS: usize = 5;
const SCRATCH: usize = 7;
const UART_HZ: u32 = 3_686_400;
const UART_SOURCE: usize = 10;
const PLIC: usize = 0x0c00_0000;
const PLIC_ENABLE: usize = PLIC + 0x2000;
const PLIC_THRESHOLD: usize = PLIC + 0x20_0000;
const PLIC_CLAIM: usize = PLIC + 0x20_0004;
const TIME: usize = 0x0200_bff8;
const COMPARE: usize = 0x0200_4000;
/// The counter of time counts clocks.
pub const CLOCKS_PER_US: u32 = 10;
/// The timer accepts every wait: none is above 2^31.
pub const LONGEST_US: u32 = u32::MAX;

fn read_byte(address: usize) -> u8 {
    // Safety: callers pass only registers of the UART.
    unsafe { read_volatile(address as *const u8) }
}

fn set_byte(address: usize, value: u8) {
    // Safety: as above.
    unsafe { write_volatile(address as *mut u8, value) }
}

/// The end of the last wait, with which the timer compares the time.
static LAST: Shared<u64> = Shared::new(0);

/// Starts UART and interrupts.
pub fn start() {
    stop();
    set(COMPARE, 0);
    set(COMPARE + 4, 0);
    set_byte(UART + INTERRUPTS, 1); // a byte received
    set(PLIC + 4 * UART_SOURCE, 1);
    set(PLIC_ENABLE, 1 << UART_SOURCE);
    set(PLIC_THRESHOLD, 0);
    // Safety: the handlers are defined below.
    unsafe {
        riscv::register::mie::set_mext();
        riscv::interrupt::enable();
    }
}

/// Sends a byte, if the transmitter is free.
pub fn send(byte: u8) -> bool {
    let is_free = read_byte(UART + LINE_STATUS) & 0x20 != 0;
    if is_free {
        set_byte(UART, byte);
    }
    is_free
}

/// It has no 18 free pins.
#[cfg(feature = "wide")]
compile_error!("this board has 8 pins for motors: leave out the feature `wide`");

/// Sets the motors' levels.
#[inline]
pub fn write(levels: Pins) {
    set_byte(UART + SCRATCH, levels);
}

/// Sets the other outputs.
pub fn switch(outputs: u8) {
    set_byte(UART + MODEM_CONTROL, outputs & 0xf);
}

/// This board has no switches.
pub fn inputs(simulated: u8) -> u8 {
    simulated
}

/// Sets the rate of the UART.
pub fn baud(bits_per_s: u32) {
    let divisor = UART_HZ / 16 / bits_per_s.max(1);
    set_byte(UART + LINE_CONTROL, 0x83); // 8 bits; the first two registers become the divisor
    set_byte(UART, divisor as u8);
    set_byte(UART + INTERRUPTS, (divisor >> 8) as u8);
    set_byte(UART + LINE_CONTROL, 0x03);
}

/// Whether the last stop bit has been sent.
pub fn is_sent() -> bool {
    read_byte(UART + LINE_STATUS) & 0x40 != 0
}

/// This board has no PWM.
pub fn drive(_: u8) {}

/// This board has no counter for an encoder.
pub fn counts(simulated: u16) -> u16 {
    simulated
}

fn now() -> u64 {
    loop {
        let high = read(TIME + 4);
        let low = read(TIME);
        if read(TIME + 4) == high {
            return u64::from(high) << 32 | u64::from(low);
        }
    }
}

/// The counter of time, which wraps: [`CLOCKS_PER_US`] a microsecond.
pub fn clock() -> u32 {
    now() as u32
}

/// Calls `on_time` this many microseconds after the end of the previous wait, or at once if that
/// time has passed.
pub fn wait(us: u32, section: CriticalSection<'_>) {
    LAST.within(section, |last| {
        let now = now();
        // If the previous wait was cut short, its end is later than now. Then this wait counts from
        // now.
        let clocks = u64::from(us).wrapping_mul(CLOCKS_PER_US.into());
        let end = now.min(*last).wrapping_add(clocks).max(now);
        if end >> 32 != *last >> 32 {
            // The value must never be too early between these writes.
            set(COMPARE, u32::MAX);
            set(COMPARE + 4, (end >> 32) as u32);
        }
        // As a rule, no later value is written before this one. If the time has passed, QEMU keeps
        // a later value until the next wait begins, and virtual time would jump to it.
        set(COMPARE, end as u32);
        *last = end;
        // Safety: the handler is defined below.
        unsafe { riscv::register::mie::set_mtimer() };
    });
}

/// Cancels the wait by disabling the interrupt. A compare value that is never reached would not do,
/// because QEMU's virtual time would jump to it.
pub fn stop() {
    // Safety: no code waits for this interrupt any more.
    unsafe { riscv::register::mie::clear_mtimer() };
}

#[riscv_rt::core_interrupt(Interrupt::MachineTimer)]
fn timer() {
    // Safety: this is an interrupt's handler.
    crate::on_time(unsafe { crate::section() });
}

#[riscv_rt::core_interrupt(Interrupt::MachineExternal)]
fn external() {
    let source = read(PLIC_CLAIM);
    while read_byte(UART + LINE_STATUS) & 1 != 0 {
        crate::heard(read_byte(UART));
    }
    set(PLIC_CLAIM, source);
}
