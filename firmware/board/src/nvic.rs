//! The interrupts of a Cortex-M by their number.

use cortex_m::peripheral::NVIC;

#[derive(Clone, Copy)]
struct Irq(u16);

// Safety: the boards' files name numbers of their chips only.
unsafe impl cortex_m::interrupt::InterruptNumber for Irq {
    fn number(self) -> u16 {
        self.0
    }
}

/// Lets it come.
pub fn unmask(number: u16) {
    // Safety: the board's file has it in its table.
    unsafe { NVIC::unmask(Irq(number)) }
}

/// It has not come.
pub fn unpend(number: u16) {
    NVIC::unpend(Irq(number));
}

/// A place of the vector table.
pub type Vector = Option<extern "C" fn()>;

/// A table with these interrupts.
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
