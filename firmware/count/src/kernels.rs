//! What is counted.

use core::hint::black_box;

use husillo_backlash::{Backlash, Compensator, Flank};
use husillo_stepper::{CoilDriver, Driver, Mode, Sequencer};

/// Takes a name, a number of turns and what to do that many times.
type Report<'a> = &'a mut dyn FnMut(&str, u32, &mut dyn FnMut(u32));

/// Hands every kernel to `report`.
pub fn all(report: Report<'_>) {
    report("empty_loop", 1000, &mut |turns| {
        for _ in 0..turns {
            black_box(());
        }
    });
    motors(report);
}

fn motors(report: Report<'_>) {
    report("sequencer_step", 1000, &mut |turns| {
        let Ok(mut motor) = black_box(Sequencer::new(Driver::A3988, Mode::Half)) else {
            return;
        };
        for _ in 0..turns {
            black_box(motor.step(black_box(1)));
        }
    });
    report("compensator_straight_on", 1000, &mut |turns| {
        let axis = Backlash::new(1457, Flank::Positive);
        let mut stage = black_box(Compensator::new([axis, axis, axis]));
        for _ in 0..turns {
            black_box(stage.before(black_box(&[1, 1, 0]), black_box([10, 20, 30])));
        }
    });
    report("compensator_reversal", 1000, &mut |turns| {
        let axis = Backlash::new(1457, Flank::Positive);
        let mut stage = black_box(Compensator::new([axis, axis, axis]));
        let mut delta = [1_i8, 1, 0];
        for _ in 0..turns {
            delta[0] = -delta[0];
            black_box(stage.before(black_box(&delta), black_box([10, 20, 30])));
        }
    });
}
