//! Steps of a motor at the pins of an A4988, with a ramp, and its position from the two pins of an
//! encoder. The encoder shows steps that the motor loses, and they are made again.
//!
//! On your own board, replace [`bench`] with the pins and the delay of its HAL.
#![no_std]
#![no_main]

mod bench;

use bench::{Bench, DirectionPin, EncoderPin, StepPin};
use embedded_hal::delay::DelayNs;
use husillo_encoder::{AxisEncoder, OnLoss, QuadraturePins, Scale, StepWatch};
use husillo_planner::{Rates, Trapezoid};
use husillo_stepper::{PulseNanoseconds, StepDirectionPins, StepPulses, Unwired};
use semihosting::println;

/// Steps per second and steps per second squared. A tick of the timer is a microsecond.
const RATES: Rates = Rates {
    timer_hz: 1_000_000,
    start_rate_hz: 0,
    top_rate_hz: 2_000,
    end_rate_hz: 0,
    acceleration_hz_per_s: 20_000,
};

/// One count of the encoder for each step: 50 lines, and a motor of 200 steps.
const ENCODER: AxisEncoder = AxisEncoder {
    counts: 1,
    steps: 1,
    tolerance_steps: 2,
    on_loss: OnLoss::Correct,
    correction_rate_hz: 200,
    settle_ticks: 50_000,
    attempts: 3,
};

/// An axis: the pins of its driver, those of its encoder, and what compares them.
struct Axis<'a> {
    driver: StepPulses<StepDirectionPins<StepPin<'a>, DirectionPin<'a>, Unwired>, 1>,
    encoder: QuadraturePins<EncoderPin<'a>, EncoderPin<'a>>,
    watch: StepWatch,
    delay: &'a Bench,
}

impl Axis<'_> {
    /// Moves by some steps with a ramp, and returns how many of them were lost.
    fn go(&mut self, steps: i32) -> i32 {
        let delta = if steps < 0 { -1 } else { 1 };
        let Ok(waits) = Trapezoid::new(&RATES, steps.unsigned_abs()) else {
            panic!("rates that a motor cannot have")
        };
        let mut taken_ns = 0;
        for wait_us in waits {
            let wait_ns = wait_us.saturating_mul(1000);
            self.delay.delay_ns(wait_ns.saturating_sub(taken_ns));
            match self.driver.step(&[delta], &mut self.delay) {
                Ok(ns) => taken_ns = ns,
                Err(error) => panic!("{error}"),
            }
            self.watch.step(delta);
            // The interrupt of the encoder's pins, on a chip.
            match self.encoder.sample() {
                Ok(_) => {}
                Err(_) => panic!("the encoder is faster than its samples"),
            }
        }
        match self.watch.behind(self.counts().into()) {
            behind if self.watch.is_there(behind) => 0,
            behind => self.watch.steps(behind),
        }
    }

    fn counts(&self) -> i32 {
        self.encoder.quadrature().position()
    }
}

#[cfg_attr(target_arch = "arm", cortex_m_rt::entry)]
#[cfg_attr(target_arch = "riscv32", riscv_rt::entry)]
fn main() -> ! {
    let bench = Bench::default();
    let pins = StepDirectionPins::active_low(StepPin(&bench), DirectionPin(&bench), Unwired);
    let [a, b] = [EncoderPin(&bench, 1), EncoderPin(&bench, 0)];
    let Ok(encoder) = QuadraturePins::new(a, b, Scale::X4) else {
        panic!("pins that cannot be read")
    };
    let mut axis = Axis {
        driver: StepPulses::new(pins, [PulseNanoseconds::A4988]),
        encoder,
        watch: StepWatch::new(ENCODER),
        delay: &bench,
    };
    axis.watch.behind(axis.counts().into());

    assert_eq!(axis.go(300), 0);
    println!("after 300 steps: {} counts", axis.counts());
    assert_eq!((axis.counts(), bench.position()), (300, 300));

    bench.hold(7);
    let lost = axis.go(100);
    println!(
        "after 100 steps: {} counts, {lost} steps lost",
        axis.counts()
    );
    assert_eq!((axis.counts(), lost), (393, 7));

    // The loss is accepted, and the lost steps are a move of their own.
    axis.watch.accept(lost);
    assert_eq!(axis.go(lost), 0);
    println!("made again: {} counts", axis.counts());
    assert_eq!(axis.counts(), 400);

    assert_eq!(axis.go(-400), 0);
    println!("back: {} counts", axis.counts());
    assert_eq!((axis.counts(), bench.position()), (0, 0));
    assert_eq!(axis.encoder.quadrature().skipped(), 0);
    println!("too short for the driver: {}", bench.violations());
    assert_eq!(bench.violations(), 0);
    semihosting::process::exit(0)
}
