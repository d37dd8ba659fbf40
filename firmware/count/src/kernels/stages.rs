//! Take-up of backlash and motor phases.

use core::hint::black_box;

use husillo_backlash::{Backlash, Compensator, Flank};
use husillo_stepper::{CoilDriver, Driver, Mode, Sequencer};

use crate::Count;

const EVENTS: u32 = 1000;

#[inline(never)]
pub fn all(count: Count<'_>) {
    count("sequencer_step", EVENTS, &mut || {
        let Ok(mut motor) = black_box(Sequencer::new(Driver::A3988, Mode::Half)) else {
            return;
        };
        for _ in 0..EVENTS {
            black_box(motor.step(black_box(1)));
        }
    });
    let axis = Backlash::new(1457, Flank::Positive);
    count("compensator_straight_on", EVENTS, &mut || {
        let mut stage = black_box(Compensator::new([axis, axis, axis]));
        for _ in 0..EVENTS {
            black_box(stage.before(black_box(&[1, 1, 0]), black_box([10, 20, 30])));
        }
    });
    count("compensator_reversal", EVENTS, &mut || {
        let mut stage = black_box(Compensator::new([axis, axis, axis]));
        let mut delta = [1_i8, 1, 0];
        for _ in 0..EVENTS {
            delta[0] = -delta[0];
            black_box(stage.before(black_box(&delta), black_box([10, 20, 30])));
        }
    });
}
