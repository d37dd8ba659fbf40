//! The interrupts of a Cortex-M by number.

use cortex_m::peripheral::NVIC;

#[derive(Clone, Copy)]
struct Irq(u16);

// Safety: a board's file names only numbers that its chip has.
unsafe impl cortex_m::interrupt::InterruptNumber for Irq {
    fn number(self) -> u16 {
        self.0
    }
}

/// Enables the interrupt.
pub fn unmask(number: u16) {
    // Safety: the board's vector table has a handler for it.
    unsafe { NVIC::unmask(Irq(number)) }
}

/// Clears the interrupt if it is pending.
pub fn unpend(number: u16) {
    NVIC::unpend(Irq(number));
}

/// An entry of the vector table.
pub type Vector = Option<extern "C" fn()>;

/// A vector table with these handlers.
pub const fn vectors<const COUNT: usize, const USED: usize>(
    used: [(usize, extern "C" fn()); USED],
) -> [Vector; COUNT] {
    let mut table = [None; COUNT];
    let mut at = 0;
    while at < USED {
        let (number, handler) = used[at];
        table[number] = Some(handler);
        at += 1;
    }
    table
}
