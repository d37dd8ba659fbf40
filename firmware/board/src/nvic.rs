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
    // Safety: `DefaultHandler` of the board's file takes it.
    unsafe { NVIC::unmask(Irq(number)) }
}

/// It has not come.
pub fn unpend(number: u16) {
    NVIC::unpend(Irq(number));
}
