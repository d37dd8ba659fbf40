//! The emulated Cortex-M boards. SysTick counts the executed instructions.
//!
//! Under `-icount shift=6` an instruction takes 64 ns of virtual time. SysTick counts down 24 bits
//! at 25 MHz (mps2-an386: 40 ns per tick) or 16 MHz (microbit: 62.5 ns per tick). An instruction
//! takes more than one tick, so every count is exact, up to 10 million instructions per
//! measurement.

use cortex_m::Peripherals;
use cortex_m::peripheral::SYST;
use cortex_m::peripheral::syst::SystClkSource;

/// Nanoseconds of virtual time per instruction.
const INSTRUCTION_NS: u64 = 64;
/// Tenths of a nanosecond per SysTick tick. The thumbv7em build runs on mps2-an386, the other on
/// microbit.
const TICK_TENTHS_NS: u64 = if cfg!(target_feature = "dsp") || cfg!(target_abi = "eabihf") {
    400
} else {
    625
};

/// Starts SysTick. Call it once, before the first `instructions`.
pub fn start() {
    let Some(mut peripherals) = Peripherals::take() else {
        return;
    };
    peripherals.SYST.set_clock_source(SystClkSource::Core);
    peripherals.SYST.set_reload(0x00ff_ffff);
    peripherals.SYST.clear_current();
    peripherals.SYST.enable_counter();
}

/// The instructions that `work` executes, with the overhead of the measurement.
#[inline(never)]
pub fn instructions(work: &mut dyn FnMut()) -> u64 {
    let before = SYST::get_current();
    work();
    let after = SYST::get_current();
    let ticks = u64::from(before.wrapping_sub(after) & 0x00ff_ffff);
    // Both readings are whole ticks, so rounding gives the exact number of instructions.
    (ticks * TICK_TENTHS_NS + INSTRUCTION_NS * 5) / (INSTRUCTION_NS * 10)
}
