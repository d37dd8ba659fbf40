//! 256 samples of an encoder. The position is read once at the end.

use core::hint::black_box;

use husillo_encoder::{
    Extended, Index, Quadrature, Scale, VelocityByCount, VelocityByPeriod, running_value,
};

use crate::Count;

const SAMPLES: u32 = 256;

/// Levels of a forward motion with rests and reversals: eight samples have six counts, of which one
/// is backwards.
fn walk() -> [u8; SAMPLES as usize] {
    let mut quarters = 0_u8;
    let mut sample = 0_u8;
    [(); SAMPLES as usize].map(|()| {
        sample = sample.wrapping_add(1);
        quarters = match sample % 8 {
            0 => quarters.wrapping_sub(1),
            3 | 6 => quarters,
            _ => quarters.wrapping_add(1),
        };
        // Gray code.
        let phase = quarters & 3;
        phase ^ phase >> 1
    })
}

#[inline(never)]
pub fn all(count: Count<'_>) {
    let samples = walk();
    for (name, scale) in [("quadrature_x4", Scale::X4), ("quadrature_x1", Scale::X1)] {
        count(name, SAMPLES, &mut || {
            let mut encoder = Quadrature::new(black_box(scale), 0);
            for levels in black_box(&samples) {
                black_box(encoder.sample(*levels).unwrap_or(2));
            }
            black_box((encoder.position(), encoder.skipped(), encoder.direction()));
        });
    }
    // The decoder is in memory before and after each sample, as in an interrupt.
    let mut encoder = Quadrature::new(Scale::X4, 0);
    count("quadrature_in_memory", SAMPLES, &mut || {
        for levels in black_box(&samples) {
            black_box(black_box(&mut encoder).sample(*levels).unwrap_or(2));
        }
    });
    count("extended_16", SAMPLES, &mut || {
        let mut position = Extended::<16>::new(black_box(0));
        for reading in black_box(&samples) {
            black_box(position.update((*reading).into()));
        }
        black_box(position.position());
    });
    count("running_value", SAMPLES, &mut || {
        for low in black_box(&samples) {
            black_box(running_value([7, *low, *low, 7]));
        }
    });
    count("index", SAMPLES, &mut || {
        let mut index = Index::new(black_box(400), false, 0);
        let mut position = 0_i32;
        for level in black_box(&samples) {
            position = position.wrapping_add(1);
            black_box(index.sample(*level > 3, position));
        }
    });
    velocity(count, &samples);
}

fn velocity(count: Count<'_>, samples: &[u8]) {
    count("velocity_by_count_16", SAMPLES, &mut || {
        let mut velocity = VelocityByCount::<16>::new(black_box(0));
        for sample in black_box(samples) {
            black_box(velocity.update((*sample).into()));
        }
    });
    // Every fourth sample is a count. The velocity is read at every sample.
    count("velocity_by_period_4", SAMPLES, &mut || {
        let mut velocity = VelocityByPeriod::<4>::new(black_box(1_000_000), 100_000, 0);
        let mut ticks = 0_u32;
        for _ in black_box(samples) {
            ticks = ticks.wrapping_add(512);
            velocity.update((ticks >> 11) as i32, ticks);
            black_box(velocity.millicounts_per_s(ticks));
        }
    });
}
