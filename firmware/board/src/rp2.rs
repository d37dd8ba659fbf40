//! What a Raspberry Pi Pico and a Pico 2 have in common: the pins, and the timer.
//!
//! The timer counts microseconds freely and compares its counter with the end of the wait. The file
//! of the board has the addresses of its chip.

use super::{
    GPIO_IN, INTE, INTR, IO_BANK, NOW_US, OE_SET, OUT_CLR, OUT_SET, PADS, PWM, SIO, TIMER,
};
use crate::{
    CriticalSection, Pins, Shared, nvic,
    registers::{read, set},
};

const ALARM: usize = 0x10;
const ARMED: usize = 0x20;
/// The function of a pin that the SIO drives.
const BY_SIO: u32 = 5;
/// A pad for outputs: input enabled, 4 mA.
const DRIVEN: u32 = 1 << 6 | 1 << 4;
/// The same with a pull-up.
const PULLED_UP: u32 = DRIVEN | 1 << 3;
/// Motors, from bit 0: GP2 to GP9.
const MOTORS: u32 = 0xff << 2;
/// Other outputs: GP10 to GP13.
const OUTPUTS: u32 = 0xf << 10;
/// Switches to ground: GP14 to GP18.
const INPUTS: [usize; 5] = [14, 15, 16, 17, 18];
/// Three more of them, for the buttons of a Grbl controller: GP19 to GP21.
const BUTTONS: [usize; 3] = [19, 20, 21];
/// The PWM of a spindle: GP22, channel A of slice 3, 1.9 kHz at 125 MHz.
const PWM_PIN: usize = 22;
const PWM_SLICE: usize = PWM + 3 * 0x14;
const PWM_DIVIDER: usize = 0x04;
const PWM_COMPARE: usize = 0x0c;
const PWM_TOP: usize = 0x10;
/// The function of a pin that its PWM drives.
const BY_PWM: u32 = 4;
/// With the feature `wide`: motors at GP2 to GP19, two outputs at GP20 and GP21, three switches at
/// GP22, GP26 and GP27, three jumpers to ground at GP0, GP1 and GP28.
const IS_WIDE: bool = cfg!(feature = "wide");
const WIDE_MOTORS: u32 = 0x3_ffff << 2;
const WIDE_OUTPUTS: u32 = 3 << 20;
const WIDE_INPUTS: [usize; 3] = [22, 26, 27];
#[cfg(feature = "wide")]
const JUMPERS: [usize; 3] = [0, 1, 28];
/// The time in which the pull-up of a pin raises it, us.
#[cfg(feature = "wide")]
const PULL_UP_US: u32 = 10;
/// The motors' pins, the other outputs and the switches with these features.
const MOTORS_NOW: u32 = if IS_WIDE { WIDE_MOTORS } else { MOTORS };
const OUTPUTS_NOW: u32 = if IS_WIDE { WIDE_OUTPUTS } else { OUTPUTS };
const INPUTS_NOW: &[usize] = if IS_WIDE { &WIDE_INPUTS } else { &INPUTS };
const BUTTONS_NOW: &[usize] = if IS_WIDE { &[] } else { &BUTTONS };
/// The timer accepts every wait: none is above 2^31.
pub const LONGEST_US: u32 = u32::MAX;
/// The counter of time counts microseconds.
pub const CLOCKS_PER_US: u32 = 1;
/// The shortest wait: the time that setting it takes.
const LEAST_US: u32 = 2;
/// Number of the timer's interrupt.
const TIMER_0: u16 = 0;

/// The end of the last wait.
static LAST_US: Shared<u32> = Shared::new(0);

/// Starts pins and timer, whose clocks run.
pub fn start() {
    for pin in (0..32).filter(|pin| (MOTORS_NOW | OUTPUTS_NOW) >> pin & 1 != 0) {
        set(PADS + 4 + 4 * pin, DRIVEN);
        set(IO_BANK + 8 * pin + 4, BY_SIO);
    }
    for pin in INPUTS_NOW.iter().chain(BUTTONS_NOW) {
        set(PADS + 4 + 4 * pin, PULLED_UP);
        set(IO_BANK + 8 * pin + 4, BY_SIO);
    }
    set(SIO + OE_SET, MOTORS_NOW | OUTPUTS_NOW);
    LAST_US.with(|last| *last = read(TIMER + NOW_US));
    nvic::unmask(TIMER_0);
}

/// Sets the PWM at GP22, unless a switch is there. It begins with the first call.
pub fn drive(duty: u8) {
    if IS_WIDE {
        return;
    }
    set(PWM_SLICE + PWM_DIVIDER, 255 << 4);
    set(PWM_SLICE + PWM_TOP, 254);
    set(PWM_SLICE + PWM_COMPARE, duty.into());
    set(PWM_SLICE, 1);
    set(PADS + 4 + 4 * PWM_PIN, DRIVEN);
    set(IO_BANK + 8 * PWM_PIN + 4, BY_PWM);
}

/// This board has no counter for an encoder.
pub fn counts(simulated: u16) -> u16 {
    simulated
}

/// The levels as a register. They are a byte, unless the feature `wide` is on.
#[inline(always)]
fn bits(levels: impl Into<u32>) -> u32 {
    levels.into()
}

/// Sets the motors' pins.
#[inline]
pub fn write(levels: Pins) {
    let high = bits(levels) << 2;
    set(SIO + OUT_CLR, MOTORS_NOW & !high);
    set(SIO + OUT_SET, high & MOTORS_NOW);
}

/// Sets the other outputs.
pub fn switch(outputs: u8) {
    let high = u32::from(outputs) << 10 & OUTPUTS;
    let high = if IS_WIDE { high << 10 } else { high };
    set(SIO + OUT_CLR, OUTPUTS_NOW & !high);
    set(SIO + OUT_SET, high & OUTPUTS_NOW);
}

/// Reads the switches; a closed one is 1.
pub fn inputs(simulated: u8) -> u8 {
    if cfg!(not(feature = "switches")) {
        return simulated;
    }
    closed(INPUTS_NOW) | closed(BUTTONS_NOW) << INPUTS.len()
}

/// Which of these pins are at ground.
fn closed(pins: &[usize]) -> u8 {
    let open = read(SIO + GPIO_IN);
    pins.iter()
        .rev()
        .fold(0, |closed, pin| closed << 1 | (!open >> pin & 1) as u8)
}

/// Reads the jumpers; a closed one is 1.
#[cfg(feature = "wide")]
pub fn jumpers() -> u8 {
    for pin in JUMPERS {
        set(PADS + 4 + 4 * pin, PULLED_UP);
        set(IO_BANK + 8 * pin + 4, BY_SIO);
    }
    let begin = clock();
    while clock().wrapping_sub(begin) < PULL_UP_US {}
    closed(&JUMPERS)
}

/// The counter of time, which wraps: [`CLOCKS_PER_US`] a microsecond.
pub fn clock() -> u32 {
    read(TIMER + NOW_US)
}

/// Calls `on_time` this many microseconds after the end of the previous wait, or at once if that
/// time has passed.
pub fn wait(us: u32, section: CriticalSection<'_>) {
    LAST_US.within(section, |last| {
        // If the previous wait was cut short, its end is later than now. Then this wait counts from
        // now.
        let now = read(TIMER + NOW_US);
        let is_cut = last.wrapping_sub(now) < 1 << 31;
        *last = if is_cut { now } else { *last }.wrapping_add(us);
        loop {
            // If the time has passed, the difference wraps. If it passed long ago, the difference
            // may have any value, but seldom one within the wait.
            let now = read(TIMER + NOW_US);
            let left = last.wrapping_sub(now);
            if left < LEAST_US || left > us {
                *last = now.wrapping_add(LEAST_US);
            }
            set(TIMER + INTR, 1);
            set(TIMER + ALARM, *last);
            // If the time has passed in between, the alarm would come only after 2^32 us.
            let left = last.wrapping_sub(read(TIMER + NOW_US));
            if left.wrapping_sub(1) < 1 << 31 || read(TIMER + ARMED) & 1 == 0 {
                break;
            }
        }
        set(TIMER + INTE, 1);
    });
}

/// Cancels the wait.
pub fn stop() {
    set(TIMER + INTE, 0);
    set(TIMER + ARMED, 1);
    set(TIMER + INTR, 1);
    nvic::unpend(TIMER_0);
}

/// The end of a wait.
pub extern "C" fn on_timer_interrupt() {
    set(TIMER + INTE, 0);
    set(TIMER + INTR, 1);
    // Safety: this is an interrupt's handler.
    crate::on_time(unsafe { crate::section() });
}
