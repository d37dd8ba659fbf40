//! One axis on an A4988: moves in millimetres, another goal on the way, and the return. Prints the
//! rising edges of STEP.
//!
//! ```text
//! cargo run -p husillo-machine --no-default-features --example one_axis
//! ```

use husillo_machine::fixed::types::I16F16;
use husillo_machine::stepper::{Levels, PulseNanoseconds, StepDirection};
use husillo_machine::{JerkLimits, StepUnits, StepperAxis};

/// Ticks of a microsecond.
const TIMER_HZ: u32 = 1_000_000;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // A motor of 200 steps on a screw of 8 mm.
    let millimetres = StepUnits::new(200, 8).ok_or("a ratio of 0")?;
    let limits = JerkLimits {
        timer_hz: TIMER_HZ,
        top_rate_hz: 400,
        acceleration_hz_per_s: 2_000,
        jerk_hz_per_s2: 40_000,
    };
    let driver = StepDirection::new(PulseNanoseconds::A4988.ticks(TIMER_HZ));
    let mut axis = StepperAxis::new(driver, limits)?;
    axis.move_to(millimetres.steps(I16F16::lit("2.4"))?);
    println!("       ms  position, mm  rate, steps/s");
    let mut now_us = 0;
    // A firmware does this in its timer interrupt: write the levels, and load the next wait.
    while let Some(change) = axis.next_change() {
        now_us += change.ticks;
        if !change.levels.contains(Levels::STEP) {
            continue;
        }
        let position: I16F16 = millimetres.position(axis.position())?;
        let ms = f64::from(now_us) / 1e3;
        println!("{ms:9.1}  {position:12.2}  {:13}", axis.rate_hz());
        if axis.position() == 40 {
            println!("           back to -0.4 mm");
            axis.move_to(millimetres.steps(I16F16::lit("-0.4"))?);
        }
    }
    println!("at {} steps after {} ms", axis.position(), now_us / 1_000);
    Ok(())
}
