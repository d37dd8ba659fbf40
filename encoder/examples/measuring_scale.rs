//! An axis with a scale of 2 um per count on an 8-bit bus: the carriage moves out and home again,
//! and its position is printed.

use husillo_encoder::{Byte, Extended, VelocityByCount, read_running};

/// The counter of the scale, which runs on while it is read.
struct Counter {
    counts: u16,
    step: u16,
}

impl Counter {
    fn read(&mut self, byte: Byte) -> u8 {
        self.counts = self.counts.wrapping_add(self.step);
        let [high, low] = self.counts.to_be_bytes();
        match byte {
            Byte::High => high,
            Byte::Low => low,
        }
    }
}

fn main() {
    let mut counter = Counter { counts: 0, step: 0 };
    let mut scale = Extended::<16>::new(0);
    let mut velocity = VelocityByCount::<16>::new(0);
    for (step, samples) in [(7_u16, 4_000), (7_u16.wrapping_neg(), 3_000), (0, 100)] {
        counter.step = step;
        let mut speed = 0;
        for _ in 0..samples {
            let reading = loop {
                if let Some(reading) = read_running(|byte| counter.read(byte)) {
                    break reading;
                }
            };
            scale.update(reading.into());
            speed = velocity.update(scale.position_32());
        }
        println!(
            "{:>8} um, {:>6.1} um a sample",
            scale.position() * 2,
            f64::from(speed) / 32_768.0
        );
    }
    // 28 counts a sample, 1000 samples more out than home.
    assert_eq!(scale.position(), 28_000);
}
