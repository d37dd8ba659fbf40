//! Quadrature decoders: two levels in, a position out, skipped states reported.

use core::cell::Cell;
use core::convert::Infallible;
use core::hint::black_box;

use embedded_hal::digital::{ErrorType, InputPin};
use husillo_encoder::{Quadrature, Scale};
use quadrature_decoder::{FullStep, IncrementalDecoder, QuadStep};
use quadrature_encoder::LinearEncoder;

use crate::Count;

const SAMPLES: u32 = 256;

/// Levels of a walk forward with occasional rests and reversals: two counts in three samples.
pub fn walk() -> [u8; SAMPLES as usize] {
    let mut quarters = 0_u8;
    let mut sample = 0_u8;
    [(); SAMPLES as usize].map(|()| {
        sample = sample.wrapping_add(1);
        quarters = match sample % 8 {
            0 => quarters.wrapping_sub(1),
            3 | 6 => quarters,
            _ => quarters.wrapping_add(1),
        };
        // Gray code
        let phase = quarters & 3;
        phase ^ phase >> 1
    })
}

/// A pin of a port in memory.
struct Pin<'a> {
    port: &'a Cell<u8>,
    mask: u8,
}

impl ErrorType for Pin<'_> {
    type Error = Infallible;
}

impl InputPin for Pin<'_> {
    fn is_high(&mut self) -> Result<bool, Infallible> {
        Ok(self.port.get() & self.mask != 0)
    }

    fn is_low(&mut self) -> Result<bool, Infallible> {
        Ok(self.port.get() & self.mask == 0)
    }
}

/// Passes every decoder to `count`.
#[inline(never)]
pub fn all(count: Count<'_>) {
    let samples = walk();
    count("husillo_x4", SAMPLES, &mut || {
        let mut encoder = Quadrature::new(black_box(Scale::X4), 0);
        for levels in black_box(&samples) {
            black_box(encoder.sample(*levels).unwrap_or(2));
        }
        black_box((encoder.position(), encoder.skipped()));
    });
    count("quadrature_decoder_x4", SAMPLES, &mut || {
        let mut decoder = IncrementalDecoder::<QuadStep, i32>::default();
        for levels in black_box(&samples) {
            black_box(decoder.update(levels & 1 != 0, levels & 2 != 0).is_err());
        }
        black_box(decoder.counter());
    });
    count("husillo_x4_two_pins", SAMPLES, &mut || {
        let port = Cell::new(0);
        let mut pins = [1, 2].map(|mask| Pin { port: &port, mask });
        let mut encoder = Quadrature::new(black_box(Scale::X4), 0);
        for levels in black_box(&samples) {
            black_box(&port).set(*levels);
            let [a, b] = pins
                .each_mut()
                .map(|pin| u8::from(pin.is_high().unwrap_or(false)));
            black_box(encoder.sample(a | b << 1).unwrap_or(2));
        }
        black_box((encoder.position(), encoder.skipped()));
    });
    count("quadrature_encoder_x4", SAMPLES, &mut || {
        let port = Cell::new(0);
        let [a, b] = [1, 2].map(|mask| Pin { port: &port, mask });
        let mut encoder = LinearEncoder::<_, _, QuadStep, i32>::new(a, b);
        for levels in black_box(&samples) {
            black_box(&port).set(*levels);
            black_box(encoder.poll().is_err());
        }
        black_box(encoder.position());
    });
    count("husillo_x1", SAMPLES, &mut || {
        let mut encoder = Quadrature::new(black_box(Scale::X1), 0);
        for levels in black_box(&samples) {
            black_box(encoder.sample(*levels).unwrap_or(2));
        }
        black_box((encoder.position(), encoder.skipped()));
    });
    count("quadrature_decoder_x1", SAMPLES, &mut || {
        let mut decoder = IncrementalDecoder::<FullStep, i32>::default();
        for levels in black_box(&samples) {
            black_box(decoder.update(levels & 1 != 0, levels & 2 != 0).is_err());
        }
        black_box(decoder.counter());
    });
    // As in an interrupt, the decoder is in memory before and after each sample.
    let mut encoder = Quadrature::new(Scale::X4, 0);
    count("husillo_x4_memory", SAMPLES, &mut || {
        for levels in black_box(&samples) {
            black_box(black_box(&mut encoder).sample(*levels).unwrap_or(2));
        }
    });
    let mut decoder = IncrementalDecoder::<QuadStep, i32>::default();
    count("quadrature_decoder_memory", SAMPLES, &mut || {
        for levels in black_box(&samples) {
            let (a, b) = (levels & 1 != 0, levels & 2 != 0);
            black_box(black_box(&mut decoder).update(a, b).is_err());
        }
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    /// All decoders count in the same direction, in X4 and in X1 (to the count in progress), and
    /// all report skipped states.
    #[test]
    fn positions_are_the_same() {
        let mut encoder = Quadrature::new(Scale::X4, 0);
        let mut decoder = IncrementalDecoder::<QuadStep, i32>::default();
        let port = Cell::new(0);
        let [a, b] = [1, 2].map(|mask| Pin { port: &port, mask });
        let mut pins = LinearEncoder::<_, _, QuadStep, i32>::new(a, b);
        let mut sample = |levels: u8| {
            port.set(levels);
            let errors = [
                encoder.sample(levels).is_err(),
                decoder.update(levels & 1 != 0, levels & 2 != 0).is_err(),
                pins.poll().is_err(),
            ];
            let positions = [encoder.position(), decoder.counter(), pins.position()];
            (errors, positions.map(i32::abs))
        };
        // The peers assume that both levels were high before the first sample, so that sample is a
        // skipped state for them.
        assert_eq!(sample(0).0, [false, true, true]);
        for levels in walk() {
            assert_eq!(sample(levels).0, [false; 3]);
        }
        let last = *walk().last().unwrap_or(&0);
        assert_eq!(sample(last), ([false; 3], [128; 3]));
        assert_eq!(sample(last ^ 3).0, [true; 3]);
        let mut encoder = Quadrature::new(Scale::X1, 0);
        let mut decoder = IncrementalDecoder::<FullStep, i32>::default();
        let _ = decoder.update(false, false);
        for levels in walk() {
            assert!(encoder.sample(levels).is_ok());
            assert!(decoder.update(levels & 1 != 0, levels & 2 != 0).is_ok());
        }
        let positions = [encoder.position(), decoder.counter()].map(i32::abs);
        assert!(
            (31..=32).contains(&positions[0]) && (31..=32).contains(&positions[1]),
            "{positions:?}"
        );
    }
}
